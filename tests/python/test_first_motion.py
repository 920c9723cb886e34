"""A first motion as a lab does it, against `armid controller`: what a terminal shows is what `hardware/FIRST_MOTION.md` shows.

Numbers differ from run to run, and so may the joint whose torque is predicted worst; the page is compared without them. `WRITE=1`
writes the page anew.
"""

import os
import pty
import re
import shlex
import shutil
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
PAGE = ROOT / "hardware/FIRST_MOTION.md"
ARMID = Path(os.environ["ARMID"]).resolve()
EXPERIMENT = """robot = "crs-a460"
trajectory = "T.toml"
rate_hz = 500
settle_s = 0.2
ramp_s = 0.5
discarded_periods = 1
periods = 4

[guard]
stale_ms = {stale_ms}

[ros2]
domain = {domain}
lead_s = 0.3
"""
# Above each command, what it does; how many lines of its answer are shown.
STEPS = [
    (
        "Design a motion within the limits. A period of 2 s keeps this page short; 10 s are usual.",
        "armid design crs-a460 --criterion i-optimal --period 2 --harmonics 3 --ramp 0.5 --starts 1 --evaluations 60 "
        "--no-baseline --quiet -o T.toml",
        0,
    ),
    (
        "Perform it at 10 %, at 50 % and at full speed. The table says how much of each limit of the guard was used.",
        "armid run experiment.toml --arm ros2 --first-run -o R.mcap",
        None,
    ),
    (
        "Perform it once more, as a log that the estimate does not see. `--earlier` names the run that allows full speed.",
        "armid run experiment.toml --arm ros2 --earlier R.mcap -o V.mcap",
        2,
    ),
    ("Identify the arm. Shown is the beginning of the answer.", "armid identify R.mcap -o E.json", 5),
    ("Predict the torques of the second run.", "armid validate E.json V.mcap", 10),
]
HEAD = """# A first motion

This page shows a first motion over ROS 2, from the design to a model that predicts torques. The robot is a simulated one,
`armid controller`; with a real arm the commands are the same. A test performs them and compares the answers, without their
numbers. Read [Before the first motion](README.md#before-the-first-motion) first, and keep a hand on the emergency stop.

The experiment is this file, `experiment.toml`. `armid init arm.urdf` writes one for your own arm.

```toml
{experiment}```

Start the robot controller in a terminal of its own. A real arm has its own.

```console
$ armid controller crs-a460 --experiment experiment.toml --rate 500
```
"""
TAIL = """
If a run trips, armid says which check, what it asked for, and whether the arm was seen at rest. Look at the arm, then repeat the
command with `--resume`.
"""


def works(command):
    return shutil.which(command[0]) and subprocess.run(command, capture_output=True, check=False).returncode == 0


# With real-time priority, where the machine gives it, states seldom come late.
FIFO = ["chrt", "--fifo", "10"]
REAL_TIME = FIFO if works([*FIFO, "true"]) else []


class FirstMotion(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)
        # A machine that is shared may stand still for more than the 50 ms of the page, whatever the priority: then states are
        # late, and so is the next piece of the motion.
        domain = 160 + os.getpid() % 60
        text = EXPERIMENT.format(domain=domain, stale_ms=50)
        if not os.environ.get("WRITE"):
            text = EXPERIMENT.format(domain=domain, stale_ms=1000) + "horizon_s = 3.0\n"
        (self.folder / "experiment.toml").write_text(text, encoding="utf-8")

    def start_controller(self):
        command = "controller crs-a460 --experiment experiment.toml --rate 500 --quiet".split()
        controller = subprocess.Popen([*REAL_TIME, ARMID, *command], cwd=self.folder, stdout=subprocess.DEVNULL)
        self.addCleanup(controller.wait)
        self.addCleanup(controller.kill)
        # Its drives are on once it serves.
        time.sleep(1.0)

    def type_and_read(self, command):
        """What a terminal shows of one command; the operator types the robot's name where it is asked for."""
        master, slave = pty.openpty()
        arguments = shlex.split(command)[1:]
        process = subprocess.Popen(
            [*REAL_TIME, ARMID, *arguments], cwd=self.folder, stdin=slave, stdout=subprocess.PIPE, stderr=slave, text=True
        )
        os.close(slave)
        said = b""
        if arguments[0] == "run":
            while b"to go on: " not in said:
                said += os.read(master, 4096)
            os.write(master, b"crs-a460\n")
        answer, _ = process.communicate(timeout=300)
        os.close(master)
        question = said.decode().replace("\r", "")
        question = question[question.find("This moves") :] + "crs-a460\n" if said else ""
        self.assertEqual(process.returncode, 0, f"{command}\n{question}{answer}")
        return question, answer

    def test_the_page_shows_what_a_terminal_shows(self):
        page = HEAD.format(experiment=EXPERIMENT.format(domain=0, stale_ms=50))
        for number, (what, command, shown) in enumerate(STEPS):
            if number == 1:
                self.start_controller()
            question, answer = self.type_and_read(command)
            # Where the machine that runs this test did not keep time, one line more says which states are missing.
            lines = re.sub(r"\n  \d+ messages: .*\n", "", answer).splitlines()
            shown = len(lines) if shown is None else shown
            rest = ["…"] if 0 < shown < len(lines) else []
            text = "\n".join([f"$ {command}", *question.splitlines(), *lines[:shown], *rest])
            page += f"\n{what}\n\n```console\n{text}\n```\n"
        page += TAIL
        if os.environ.get("WRITE"):
            PAGE.write_text(page, encoding="utf-8")
        without_numbers = lambda text: re.sub(r" +", " ", re.sub(r"[-+]?\d[\d.e+-]*|(?<=worst at )\w+", "#", text)).splitlines()  # noqa: E731
        self.assertEqual(without_numbers(page), without_numbers(PAGE.read_text(encoding="utf-8")))


if __name__ == "__main__":
    unittest.main()
