"""A recording of armid through Foxglove's reader, and one of Foxglove's writer through armid."""

import csv
import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np
import pinocchio
from mcap.reader import make_reader
from mcap.writer import CompressionType
from mcap_ros2.decoder import DecoderFactory
from mcap_ros2.writer import Writer
from rosbags.rosbag2 import Reader, StoragePlugin
from rosbags.rosbag2 import Writer as BagWriter
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

ARMID = Path(os.environ["ARMID"]).resolve()
EXPERIMENT = 'robot = "crs-a460"\ntrajectory = "table-one"\nperiods = 2\nseed = 3\n\n[sensing]\nvoltage = true\n'


def armid(*arguments):
    return subprocess.run([ARMID, *arguments], check=True, capture_output=True, text=True).stdout


class Recording(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.scratch.name)
        experiment = cls.folder / "experiment.toml"
        experiment.write_text(EXPERIMENT, encoding="utf-8")
        cls.mcap, cls.csv = cls.folder / "R.mcap", cls.folder / "R.csv"
        armid("run", str(experiment), "-o", str(cls.mcap))
        armid("run", str(experiment), "-o", str(cls.csv))
        with cls.csv.open(encoding="utf-8") as file:
            cls.rows = [[float(field) for field in row] for row in list(csv.reader(file))[1:]]

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def test_every_joint_state_is_that_of_the_csv(self):
        with self.mcap.open("rb") as file:
            reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
            messages = list(reader.iter_decoded_messages(topics=["/joint_states"]))
        self.assertEqual(len(messages), len(self.rows))
        self.assertEqual(messages[0].schema.name, "sensor_msgs/msg/JointState")
        self.assertEqual((messages[0].schema.encoding, messages[0].channel.message_encoding), ("ros2msg", "cdr"))
        for k, (_, _, message, state) in enumerate(messages):
            t, q, effort = self.rows[k][0], self.rows[k][1:7], self.rows[k][7:13]
            self.assertEqual(list(state.name)[:2], ["waist", "shoulder"])
            self.assertEqual(list(state.position), q)
            self.assertEqual(list(state.velocity), [])
            self.assertEqual(list(state.effort), effort)
            nanoseconds = state.header.stamp.sec * 10**9 + state.header.stamp.nanosec
            self.assertEqual(nanoseconds, round(t * 1e9))
            self.assertEqual((message.log_time, message.sequence), (nanoseconds, k))

    def test_rosbags_reads_the_same_states_and_voltages(self):
        store = get_typestore(Stores.EMPTY)
        states, voltages = [], []
        with Reader(self.mcap) as bag:
            for connection in bag.connections:
                store.register(get_types_from_msg(connection.msgdef.data, connection.msgtype))
            for connection, _, raw in bag.messages():
                message = store.deserialize_cdr(raw, connection.msgtype)
                if connection.topic == "/joint_states":
                    states.append(list(message.position) + list(message.effort))
                elif connection.topic == "/motor_voltage":
                    voltages.append(list(message.data))
        self.assertEqual(states, [row[1:13] for row in self.rows])
        self.assertEqual(voltages, [row[13:19] for row in self.rows])

    def test_a_bag_that_rosbags_writes_in_sqlite_is_the_recording(self):
        store = get_typestore(Stores.ROS2_HUMBLE)
        stamp, header, state = (store.types[name] for name in (
            "builtin_interfaces/msg/Time", "std_msgs/msg/Header", "sensor_msgs/msg/JointState"))
        names = [joint["name"] for joint in json.loads(armid("robot", "crs-a460", "--json"))["joints"]]
        bag = self.folder / "bag"
        with BagWriter(bag, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
            connection = writer.add_connection("/joint_states", state.__msgtype__, typestore=store)
            for row in self.rows:
                ns = round(row[0] * 1e9)
                message = state(header(stamp(ns // 10**9, ns % 10**9), ""), names, np.array(row[1:7]), np.array([]),
                                np.array(row[7:13]))
                writer.write(connection, ns, store.serialize_cdr(message, state.__msgtype__))
        self.assertEqual([path.suffix for path in bag.iterdir() if path.suffix == ".db3"], [".db3"])
        estimates = []
        for log in (self.csv, bag):
            done = subprocess.run([ARMID, "identify", str(log), "--robot", "crs-a460", "--period", "10", "--from", "13",
                                   "--json"], capture_output=True, text=True)
            self.assertIn(done.returncode, (0, 1), done.stderr)
            estimates.append(json.loads(done.stdout)["base"])
        for expected, found in zip(*estimates):
            self.assertAlmostEqual(found["value"], expected["value"], delta=1e-6 * expected["std"])

    def test_the_command_is_on_a_second_channel(self):
        with self.mcap.open("rb") as file:
            reader = make_reader(file, decoder_factories=[DecoderFactory()])
            commands = list(reader.iter_decoded_messages(topics=["/joint_commands"]))
        self.assertEqual(len(commands), -(-len(self.rows) // 10))
        for k, (_, _, _, command) in enumerate(commands):
            # The servo follows within 2 degrees.
            for commanded, measured in zip(command.position, self.rows[10 * k][1:7], strict=True):
                self.assertLess(abs(commanded - measured), 0.035)

    def test_viewers_get_the_arm_and_the_poses_of_its_links(self):
        """The poses against those that Pinocchio finds by the URDF in the recording."""
        with self.mcap.open("rb") as file:
            reader = make_reader(file, decoder_factories=[DecoderFactory()])
            found = [message.decoded_message for message in
                     reader.iter_decoded_messages(topics=["/robot_description", "/tf"])]
        description, poses = found[0].data, found[1:]
        self.assertEqual(len(poses), -(-len(self.rows) // 20))
        self.assertIn("<cylinder", description)
        model = pinocchio.buildModelFromXML(description)
        data = model.createData()
        for k in range(0, len(poses), 37):
            pinocchio.framesForwardKinematics(model, data, np.array(self.rows[20 * k][1:7]))
            place = pinocchio.SE3.Identity()
            for transform, parent in zip(poses[k].transforms, ["base", *(f"link{i}" for i in range(1, 6))], strict=True):
                self.assertEqual(transform.header.frame_id, parent)
                at, turned = transform.transform.translation, transform.transform.rotation
                quaternion = pinocchio.Quaternion(np.array([turned.x, turned.y, turned.z, turned.w]))
                place = place * pinocchio.SE3(quaternion, np.array([at.x, at.y, at.z]))
                expected = data.oMf[model.getFrameId(transform.child_frame_id)]
                self.assertTrue(place.isApprox(expected, 1e-9), f"{k}: {transform.child_frame_id}")

    def test_metadata_says_what_was_recorded(self):
        with self.mcap.open("rb") as file:
            records = {record.name: record.metadata for record in make_reader(file).iter_metadata()}
        found = records["armid"]
        self.assertEqual(found["robot"], "crs-a460")
        self.assertIn("[joint.limits]", found["robot_file"])
        self.assertEqual(found["experiment"], EXPERIMENT)
        self.assertEqual((found["rate_hz"], found["effort"], found["effort_unit"]), ("1000", "current", "A"))
        phases = json.loads(found["phases"])
        names = [phase["phase"] for phase in phases]
        self.assertEqual(names, ["settle", "ramp-in", "discard", "record", "ramp-out"])
        self.assertEqual(phases[3]["samples"], {"start": 13000, "end": 33000})
        self.assertEqual(json.loads(found["provenance"])["seed"], 3)
        self.assertTrue(found["trajectory"].startswith("period_s = 10.0\nharmonics = 5\n"))
        self.assertEqual(records["armid/ending"]["ending"], "completed")

    def test_a_recording_of_another_writer_is_identified(self):
        """Joints in another order, a gripper, a stamp that begins elsewhere, no metadata: as a ROS 2 bag has it."""
        with self.mcap.open("rb") as file:
            definition = next(iter(make_reader(file).get_summary().schemas.values())).data.decode()
        names = ["waist", "shoulder", "elbow", "wrist_roll", "wrist_pitch", "tool_roll"]
        orders = [[3, 0, 5, 1, 4, 2], [0, 1, 2, 3, 4, 5]]
        log = ["--robot", "crs-a460", "--period", "10", "--skip", "13", "--json"]
        through_csv = json.loads(armid("identify", str(self.csv), *log))
        for compression in CompressionType:
            with self.subTest(compression=compression):
                other = self.write_other(definition, names, orders, compression)
                through_mcap = json.loads(armid("identify", str(other), *log))
                self.assertEqual(through_mcap["base"], through_csv["base"])

    def write_other(self, definition, names, orders, compression):
        other = self.folder / f"other-{compression.name}.mcap"
        with other.open("wb") as file:
            writer = Writer(file, compression=compression)
            schema = writer.register_msgdef("sensor_msgs/msg/JointState", definition)
            for k, row in enumerate(self.rows):
                stamp = 1_700_000_000_000_000_000 + k * 1_000_000
                order = orders[k % 2]
                writer.write_message(
                    topic="/joint_states",
                    schema=schema,
                    message={
                        "header": {
                            "stamp": {"sec": stamp // 10**9, "nanosec": stamp % 10**9},
                            "frame_id": "base",
                        },
                        "name": ["gripper"] + [names[i] for i in order],
                        "position": [0.01] + [row[1 + i] for i in order],
                        "velocity": [0.0] * 7,
                        "effort": [0.5] + [row[7 + i] for i in order],
                    },
                    log_time=stamp,
                    publish_time=stamp,
                    sequence=k,
                )
            writer.finish()
        return other


if __name__ == "__main__":
    unittest.main()
