"""The log of a robot controller, `armid controller --log`: one row for each servo step, by the robot's own clock."""

import csv
import math
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
ROBOT = tomllib.loads((ROOT / "models/crs-a460/robot.toml").read_text(encoding="utf-8"))
# A command that moves less in a step rests; the log has six decimals.
STILL = 3e-6


class Unfit(Exception):
    """Something was commanded that never may be."""


class Log:
    """Read while it is written; its rows are whole up to the last."""

    def __init__(self, path):
        self.path = path
        self.read_to, self.last, self.began_s = 0, b"", None

    def poll(self):
        """Takes what has been written since the last look."""
        if not self.path.exists():
            return
        with self.path.open("rb") as file:
            file.seek(self.read_to)
            text = file.read()
        whole = text[: text.rfind(b"\n") + 1]
        self.read_to += len(whole)
        for line in whole.splitlines():
            if line[:1].isdigit():
                self.last = line
                if self.began_s is None and b"motion begins" in line:
                    self.began_s = float(line.split(b",")[0])

    def now(self):
        """The time of its last row, s."""
        self.poll()
        return float(self.last.split(b",")[0]) if self.last else 0.0

    def began(self):
        """When the first motion began, s; None before it is known."""
        self.poll()
        return self.began_s

    def rows(self):
        with self.path.open(encoding="utf-8", newline="") as file:
            head, *rows = list(csv.reader(file))
        while rows and len(rows[-1]) != len(head):
            rows.pop()
        return [dict(zip(head, row)) for row in rows]


def moved(rows):
    """Times at which a command moved. Every command is within its joint's limits of position and speed."""
    last, times = None, []
    if len(rows) < 2:
        return times
    dt = float(rows[1]["t"]) - float(rows[0]["t"])
    bounds = []
    for joint in ROBOT["joint"]:
        low, high = (math.radians(limit) for limit in joint["limits"]["position_deg"])
        bounds.append((joint["name"], low - 1e-5, high + 1e-5, math.radians(joint["limits"]["velocity_deg_s"]) * dt + STILL))
    for row in rows:
        t, command = float(row["t"]), [row[f"command{j}"] for j in range(1, 7)]
        if "" in command:
            if row["doing"] not in ("off", "frozen"):
                raise Unfit(f"no command at t = {t} s while {row['doing']}")
            last = None
            continue
        q = [float(x) for x in command]
        for (name, low, high, step), now, before in zip(bounds, q, last or q):
            if not low <= now <= high:
                raise Unfit(f"{name} commanded to {now} rad at t = {t} s")
            if abs(now - before) > step:
                raise Unfit(f"{name} commanded at {abs(now - before) / dt} rad/s at t = {t} s")
        if any(abs(now - before) > STILL for now, before in zip(q, last or q)):
            times.append(t)
        last = q
    return times


def lateness_ms(event):
    """How late the latest state is that a row of the log shows."""
    late = [part.split(" sent ")[1].split(" ms")[0] for part in event.split("; ") if part.endswith(" ms late")]
    return max(map(float, late), default=0.0)
