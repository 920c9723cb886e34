"""A full short experiment on a robot whose controller shares no code with armid, over the real wire."""

import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

from robot_peer import RATE_HZ, Peer

ARMID = Path(os.environ["ARMID"]).resolve()
SPEED = "10%"
SETTLE_S, RAMP_S, PERIODS = 0.5, 1.0, 4
# Ten times slower it lasts 4 s a period; every joint moves, none alike.
PERIOD_S = 4.0
TRAJECTORY = """period_s = 0.4
harmonics = 3
"""
# Joint, a and b in rad/s at full speed, q0 in rad. Full speed is beyond the arm; a tenth of it is what is performed.
JOINTS = [
    ("waist", [7.2, -4.0, 3.2], [2.4, 4.8, -1.6], 0.1),
    ("shoulder", [4.0, 3.2, -3.2], [-3.2, 2.4, 2.4], -0.2),
    ("elbow", [-5.6, 4.0, 2.4], [4.0, -2.4, 3.2], 0.3),
    ("wrist_roll", [8.0, 4.8, -6.4], [-5.6, 4.0, 4.8], -0.3),
    ("wrist_pitch", [-7.2, 6.4, 4.0], [4.8, 5.6, -4.8], 0.5),
    ("tool_roll", [6.4, -7.2, 7.2], [7.2, -4.8, 4.0], 0.2),
]
EXPERIMENT = f"""robot = "crs-a460"
trajectory = "T.toml"
rate_hz = {RATE_HZ}
settle_s = {SETTLE_S}
ramp_s = {RAMP_S}
discarded_periods = 0
periods = {PERIODS}
seed = 5

# A machine that builds and tests at the same time stands still now and then; nothing is measured by the clock here.
[guard]
stale_ms = 1000

[ros2]
mode = "topic"
robot_state = ""
robot_request = ""
patience_s = 20.0
lead_s = 1.0
"""


def armid(*arguments):
    done = subprocess.run([ARMID, *arguments, "--json"], capture_output=True, text=True, timeout=120)
    if done.returncode != 0:
        raise AssertionError(f"armid {' '.join(arguments)}: exit {done.returncode}\n{done.stdout}{done.stderr}")
    return json.loads(done.stdout)


def left_out(missing, skipped, samples):
    """Whether the missing samples are the skipped cycles within some window of as many cycles as there are samples."""
    if not missing:
        return True
    windows = [range(cycle - missing[0], cycle - missing[0] + samples) for cycle in skipped]
    return any([cycle - window.start for cycle in skipped if cycle in window] == missing for window in windows)


class Experiment(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)
        self.domain = 60 + os.getpid() % 40
        joints = [f'[[joint]]\nname = "{n}"\na = {a}\nb = {b}\nq0 = {q}\n' for n, a, b, q in JOINTS]
        (self.folder / "T.toml").write_text(TRAJECTORY + "".join(joints), encoding="utf-8")
        text = EXPERIMENT.replace("[ros2]", f"[ros2]\ndomain = {self.domain}")
        self.experiment = self.folder / "experiment.toml"
        self.experiment.write_text(text, encoding="utf-8")

    def test_no_sample_is_lost_and_the_estimate_is_that_of_the_simulated_arm(self):
        real, simulated = self.folder / "real.mcap", self.folder / "simulated.mcap"
        run = [str(self.experiment), "--speed", SPEED]
        peer = Peer(self.domain, [0.0] * 6)
        try:
            # Again, twice at most, where no period is whole since the machine held the controller back.
            for _ in range(3):
                peer.received, peer.skipped = [], []
                real.unlink(missing_ok=True)
                done = armid("run", *run, "--arm", "ros2", "--yes-the-estop-works", "-o", str(real))
                self.is_whole(done, peer)
                first, period = round(RATE_HZ * (SETTLE_S + RAMP_S)), round(RATE_HZ * PERIOD_S)
                if len({(sample - first) // period for sample in done["stamps"]["missing"]} & set(range(PERIODS))) < PERIODS:
                    break
        finally:
            peer.close()
        # settle + ramp + 4 periods + ramp, ten times slower but for what is not the motion.
        armid("run", *run, "--arm", "analytic", "-o", str(simulated))
        rows = {}
        for name, path in (("real", real), ("simulated", simulated)):
            rows[name] = armid("identify", str(path))
        self.compare(rows["real"], rows["simulated"])

    def is_whole(self, done, peer):
        """Every state that was sent between the first and the last one arrived, and every sample is one of them. A controller
        that the machine held back for 20 ms left cycles out: these are missing, and no others."""
        self.assertEqual(done["ending"], "completed")
        stamps = done["stamps"]
        for what in ("duplicates", "reordered", "clock_jumps"):
            self.assertEqual(stamps[what], 0, stamps)
        self.assertEqual(done["samples"], round(RATE_HZ * (SETTLE_S + RAMP_S + PERIODS * PERIOD_S + RAMP_S)))
        self.assertTrue(left_out(stamps["missing"], peer.skipped, done["samples"]), (stamps, peer.skipped))
        self.assertTrue(len(stamps["missing"]) <= stamps["lost"] <= len(peer.skipped), (stamps, peer.skipped))
        # An approach of a second and 19 s of the experiment, in pieces of half a second at most, each with its points.
        self.assertGreater(len(peer.received), 2 * 20)
        self.assertLess(max(peer.received), 30)

    def compare(self, real, simulated):
        """Both estimate the same arm: differences are noise. 58 parameters; four deviations are exceeded by one in
        270 such tests if all is normal, and the noise of both runs has a fixed seed."""
        sum_of_squares, worst = 0.0, (0.0, "")
        pairs = list(zip(real["base"], simulated["base"], strict=True))
        for one, other in pairs:
            self.assertEqual(one["name"], other["name"])
            std = (one["std"] ** 2 + other["std"] ** 2) ** 0.5
            off = abs(one["value"] - other["value"]) / std
            sum_of_squares += off**2
            worst = max(worst, (off, one["name"]))
        self.assertLess(worst[0], 5.0, worst)
        self.assertLess(sum_of_squares / len(pairs), 2.0)


if __name__ == "__main__":
    unittest.main()
