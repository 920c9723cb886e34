"""One run of `armid run --arm ros2` against `armid controller`, with a fault, judged from the robot controller's own log."""

import contextlib
import ctypes
import fcntl
import json
import math
import os
import pty
import random
import signal
import subprocess
import termios
import threading
import time
from pathlib import Path

from fault_rows import HANDED, ROWS, STREAMED, Row
from robot_log import ROOT, Log, Unfit, lateness_ms, moved

# The waist and the shoulder stay apart, so that their positions can be distinguished. The file's motion is performed at a tenth
# of its speed, for which no earlier run is asked. At full speed the file is as slow as that, and wider.
JOINTS = [
    ("waist", [4.0, -2.0], [1.5, 2.5], 0.45),
    ("shoulder", [2.5, 1.5], [-1.5, 2.0], -0.45),
    ("elbow", [-3.0, 2.5], [2.5, -1.5], 0.3),
    ("wrist_roll", [5.0, 3.0], [-3.5, 2.5], -0.2),
    ("wrist_pitch", [-4.5, 4.0], [3.0, 3.5], 0.3),
    ("tool_roll", [4.0, -4.5], [4.5, -3.0], 0.2),
]
# Part of those speeds that the limits allow at full speed.
WIDE = 0.25
PERIOD_S, SETTLE_S, RAMP_S, LEAD_S = 2.0, 0.2, 0.5, 0.3
RATE_HZ = 500
HORIZON_S = 0.5
# From a request to rest: the watchdog of set-points and braking, and the longest piece, at a tenth of the speed and at all of it.
BRAKING_S = {10: 0.2, 100: 0.5}
LONGEST_S = {10: HORIZON_S, 100: 0.9}
# Slack of a bound for the step in which it ends.
STEP_S = 0.05
# A silence between two states, which come every 2 ms, after which a stream may ask for more current than the drives have, ms.
LATE_MS = 5.0
# How often packets are recorded until there are some.
ATTEMPTS = 5
# One at a time records what is sent again.
RECORDING = threading.Lock()


class Broken(Exception):
    """A run did not end as it must."""


class Late(Broken):
    """A stream tripped by its current because this machine held set-points back: nothing was shown about armid."""


class Found:
    """What a run showed; times in ms from the fault, by the log; the longest silence between two states of a run that completed."""

    def __init__(self, trip="", bound_ms=None, request_ms=None, rest_ms=None, confirmed=False, silence_ms=None):
        self.trip, self.bound_ms, self.request_ms, self.rest_ms = trip, bound_ms, request_ms, rest_ms
        self.confirmed, self.silence_ms = confirmed, silence_ms


def motion_s(options):
    """The approach to the beginning of the ramp takes a second; the experiment follows it by the lead."""
    return 1.0 + LEAD_S + SETTLE_S + options.longer * (RAMP_S + PERIOD_S + RAMP_S)


def series(options):
    """Period of the file and its joints: name, a, b (rad/s), q0."""
    period_s = options.longer * PERIOD_S
    if options.speed == 10:
        return period_s / 10, JOINTS
    return period_s, [(n, [WIDE * x for x in a], [WIDE * x for x in b], q) for n, a, b, q in JOINTS]


def start_pose(options):
    """Close to where the motion begins: q(0) of the Fourier series, q0 − Σ b_l / (ω l); speed and period cancel."""
    period_s, joints = series(options)
    omega = 2 * math.pi / period_s
    return [q0 - sum(b_l / (omega * (l + 1)) for l, b_l in enumerate(b)) for _, _, b, q0 in joints]


def experiment(folder, name, domain, options, mode, served, first=False):
    """A plan of the motion; with `first`, of one that takes its time at all of its speed, which a first run comes to."""
    period_s, joints = series(options)
    slower = options.longer * PERIOD_S / period_s if first else 1.0
    rates = lambda values: [value / slower for value in values]  # noqa: E731
    rows = [f'[[joint]]\nname = "{n}"\na = {rates(a)}\nb = {rates(b)}\nq0 = {q}\n' for n, a, b, q in joints]
    (folder / "T.toml").write_text(f"period_s = {slower * period_s}\nharmonics = 2\n" + "".join(rows), encoding="utf-8")
    text = f"""robot = "crs-a460"
trajectory = "T.toml"
rate_hz = {RATE_HZ}
settle_s = {SETTLE_S}
ramp_s = {options.longer * RAMP_S}
discarded_periods = 0
periods = 1

[guard]
stale_ms = {options.stale_ms}

[ros2]
domain = {domain}
mode = "{mode}"
lead_s = {LEAD_S}
horizon_s = {HORIZON_S}
patience_s = 20.0
{"" if served else 'robot_request = ""'}
"""
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def outcome(done):
    """How a run ended, in a few words."""
    try:
        said = json.loads(done.stdout)
        return f"exit {done.returncode}, {said['ending']} {said['detail']}"
    except ValueError:
        return f"exit {done.returncode}, {done.stderr.strip()}"


def silence_ms(said):
    """Longest time without a state, by armid's clock; of a first run, of its steps."""
    parts = said.get("steps", [said])
    return 1e3 * max(part["stamps"]["longest_silence_s"] for part in parts)


def interrupt_thread(pid):
    """Interrupts a wait of the middleware's event loop, as a debugger would: RustDDS ends its loop then."""
    seize, interrupt, detach, anything = 0x4206, 0x4207, 17, 0x40000000
    libc = ctypes.CDLL(None, use_errno=True)
    libc.ptrace.argtypes = [ctypes.c_long, ctypes.c_long, ctypes.c_void_p, ctypes.c_void_p]
    for task in Path(f"/proc/{pid}/task").iterdir():
        if not (task / "comm").read_text(encoding="utf-8").startswith("RustDDS Partici"):
            continue
        thread = int(task.name)
        if libc.ptrace(seize, thread, None, None) or libc.ptrace(interrupt, thread, None, None):
            raise Broken(f"thread {thread} cannot be interrupted: {os.strerror(ctypes.get_errno())}")
        os.waitpid(thread, anything)
        libc.ptrace(detach, thread, None, None)
        return
    raise Broken("no thread of the middleware")


def await_space(process, options):
    """Waits until a process has a network of its own, and switches its loopback on."""
    own = os.readlink("/proc/self/ns/net")
    for _ in range(200):
        with contextlib.suppress(OSError):
            if os.readlink(f"/proc/{process.pid}/ns/net") != own:
                break
        time.sleep(0.01)
    subprocess.run([*options.enter, f"--target={process.pid}", "ip", "link", "set", "lo", "up"], check=True)


def recorded_packets(run):
    """A file of what a client says to a robot: recorded once, in a network where the two are alone."""
    path = run.folder / "packets.json"
    with RECORDING:
        if hasattr(run.options, "packets"):
            path.write_text(run.options.packets, encoding="utf-8")
            return path
        space = subprocess.Popen([*run.options.space, "sleep", "600"])
        processes = [space]
        try:
            await_space(space, run.options)
            inside = [*run.options.others, *run.options.enter, f"--target={space.pid}"]
            armid, tools = [*inside, run.options.armid], [*inside, run.options.python]
            start = lambda command: processes.append(  # noqa: E731
                subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
            )
            start([*armid, "controller", "crs-a460", "--experiment", run.ours, "--quiet"])
            start([*tools, ROOT / "tests/python/replay.py", "record", str(run.domain), path])
            recorder = processes[-1]
            recorder.stdout.readline()
            hears = [*armid, "run", run.ours, "--arm", "ros2", "--yes-the-estop-works", "--speed", "10%", "-o", path.with_suffix(".mcap")]
            for row in ("foreign-state", "foreign-goal"):
                # A run hears of a state, and ends by it: now and then by its announcement, before the client knows of the run.
                for _ in range(ATTEMPTS):
                    if row == "foreign-state":
                        start(hears)
                    start([*tools, ROOT / "tests/python/foreign.py", row, str(run.domain)])
                    if processes[-1].stdout.readline():
                        break
                else:
                    raise Broken(f"{row}: nothing was said that could be sent again")
                time.sleep(1.0)
                # It says no farewell, so that nothing that is sent again takes back what it has said.
                processes[-1].kill()
            recorder.terminate()
            if recorder.wait(timeout=10) != 0:
                raise Broken("nothing was recorded to be sent again")
        finally:
            for process in reversed(processes):
                process.kill()
                process.wait()
        run.options.packets = path.read_text(encoding="utf-8")
    return path


class Run:
    """One controller and one armid, with what is to happen between them."""

    def __init__(self, name, mode, at_s, number, options, folder):
        self.name, self.mode, self.at_s, self.number, self.options, self.folder = name, mode, at_s, number, options, folder
        self.row = ROWS[name] if name else Row()
        # A network of its own needs no domain of its own.
        self.domain = options.domain + (0 if options.space else number % options.domains)
        self.log = Log(folder / "log.csv")
        self.controller, self.second = None, None
        self.recording = folder / "R.mcap"
        self.struck_s = None
        self.space = None
        # A speed of its own, and the recording of the step below.
        self.speed, self.earlier = None, options.earlier
        self.helpers = []

    def inside(self, others=False):
        """In front of a command: its priority, below that of the two under test for others', and its network."""
        prefix = self.options.others if others else self.options.prefix
        return [*prefix, *self.options.enter, f"--target={self.space.pid}"] if self.space else prefix

    def open(self):
        if self.options.space:
            self.space = subprocess.Popen([*self.options.space, "sleep", "600"])
            await_space(self.space, self.options)
        self.theirs = experiment(self.folder, "theirs.toml", self.domain, self.options, self.mode, self.name != "no-listener")
        first = self.name == "first-run"
        self.ours = experiment(self.folder, "ours.toml", self.domain, self.options, self.mode, True, first)
        self.packets = recorded_packets(self) if self.name.startswith("replay") else None
        more = ["--refusals", str(1 + self.number % 10)] if self.name == "refused-goals" else self.row.controller
        self.controller = None if self.name == "search" else self.start(self.log, start_pose(self.options), more)
        if self.name == "disk-full":
            disk = self.folder / "disk"
            disk.mkdir()
            subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", disk], check=True)
            self.recording = disk / "R.mcap"

    def start(self, log, pose, more=(), others=False):
        """Starts a robot controller."""
        command = [*self.inside(others), self.options.armid, "controller", "crs-a460", "--experiment", self.theirs]
        command += ["--rate", str(RATE_HZ), "--log", log.path, "--json", "--seed", str(self.number)]
        command += ["--duration", "90", "--pose=" + ",".join(str(q) for q in pose), *more]
        if self.row.fault:
            size = f":{random.Random(self.number).uniform(*self.row.size):.4f}" if self.row.size else ""
            command += ["--fault", f"{self.row.fault}{size}@motion+{self.at_s:.4f}"]
        return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def close(self):
        for process in [*self.helpers, *filter(None, [self.controller])]:
            if "controller" in process.args and process.poll() is None:
                process.send_signal(signal.SIGINT)
            elif "sleep" in process.args or "send" in process.args:
                process.kill()
            try:
                process.communicate(timeout=20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        if self.space:
            self.space.kill()
            self.space.wait()
        if self.name == "disk-full":
            subprocess.run(["umount", self.folder / "disk"], check=False)

    def command(self, recording):
        command = [*self.inside(), self.options.armid, "run", self.ours, "--arm", "ros2", "--yes-the-estop-works"]
        speed = ["--first-run"] if self.name == "first-run" else ["--speed", f"{self.speed or self.options.speed}%"]
        earlier = ["--earlier", self.earlier] if self.earlier and self.name != "first-run" else []
        return [*command, *speed, *earlier, "--json", "-o", recording]

    def perform_before(self):
        """The run before: it ends at the moment, as the row says."""
        process = subprocess.Popen(
            self.command(self.folder / "before.mcap"), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
        )
        try:
            if self.row.before != "completed":
                self.wait_for_moment(process)
            if self.row.before == "tripped":
                process.send_signal(signal.SIGSTOP)
                time.sleep(0.2)
                process.send_signal(signal.SIGCONT)
            elif self.row.before != "completed":
                process.send_signal(signal.SIGKILL if self.row.before == "killed" else signal.SIGINT)
            said, _ = process.communicate(timeout=60)
        finally:
            process.kill()
        status = {"completed": 0, "tripped": 1, "interrupted": 130, "killed": -signal.SIGKILL}[self.row.before]
        if process.returncode != status:
            self.excuse(said.decode())
            raise Broken(f"the run before: exit {process.returncode}, expected {status}: {said.decode()[-600:]}")
        # What was killed may have handed a piece over.
        time.sleep(LONGEST_S[self.options.speed])

    def perform(self):
        if self.row.before:
            self.perform_before()
        command = self.command(self.recording)
        if self.name == "panic":
            # States count from the lead before the approach.
            command += ["--panic-after", str(round((LEAD_S + self.at_s) * RATE_HZ))]
        by_controller = self.row.fault and not self.row.interrupted_s
        alone = ("disk-full", "panic", "no-replacement", "refused-goals", "first-run")
        outside = self.name and not by_controller and not self.row.before and self.name not in alone
        master, slave = pty.openpty() if self.name in ("terminal", "suspend") else (None, None)
        output, errors = (self.folder / "said.json").open("w+"), (self.folder / "errors.txt").open("w+")
        # Its own session, so that signals of a terminal are its own; the answer goes into a file, as no terminal outlives it.
        setup = None
        if slave is not None:
            def setup():
                os.setsid()
                fcntl.ioctl(slave, termios.TIOCSCTTY, 0)
        process = subprocess.Popen(
            command, stdin=slave or subprocess.DEVNULL, stdout=output, stderr=slave or errors, text=True, preexec_fn=setup
        )
        if slave is not None:
            os.close(slave)
        try:
            if outside:
                self.happen(process, master)
            process.wait(timeout=60)
        except subprocess.TimeoutExpired as late:
            raise Broken("armid did not end within 60 s") from late
        finally:
            if process.poll() is None:
                process.kill()
                process.wait()
            if master is not None and self.name != "terminal":
                os.close(master)
        self.ended_s = self.log.now()
        self.second_ended_s = self.second.now() if self.second else None
        # Long enough to see what is commanded afterwards.
        time.sleep(1.0)
        output.seek(0)
        errors.seek(0)
        return subprocess.CompletedProcess(command, process.returncode, output.read(), errors.read())

    def happen(self, process, master):
        """Waits for the moment, and lets it happen."""
        if self.name == "search":
            self.interrupt_search(process)
            return
        chance = random.Random(self.number + 0.5)
        if not self.wait_for_moment(process, chance.uniform(0.0, self.row.interrupted_s)):
            return
        self.struck_s = self.log.now()
        send = lambda s: os.kill(process.pid, s)  # noqa: E731
        if self.row.interrupted_s:
            with contextlib.suppress(ProcessLookupError):
                send(signal.SIGINT)
        elif self.name == "stop-continue":
            send(signal.SIGSTOP)
            time.sleep(0.2)
            send(signal.SIGCONT)
        elif self.name == "interrupt":
            send(chance.choice([signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT]))
        elif self.name == "two-signals":
            every = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT]
            first, second = chance.choices(every, k=2)
            send(first)
            time.sleep(chance.choice([0.0, 5e-4, 0.02, 0.2]))
            with contextlib.suppress(ProcessLookupError):
                send(second)
        elif self.name == "hangup":
            send(signal.SIGHUP)
            send(signal.SIGHUP)
        elif self.name == "terminal":
            os.close(master)
        elif self.name == "suspend":
            os.write(master, b"\x1a")
        elif self.name == "thread":
            interrupt_thread(process.pid)
        elif self.name == "kill":
            send(signal.SIGKILL)
        elif self.name.startswith("net-"):
            place = [*self.options.enter, f"--target={self.space.pid}"]
            link = lambda way: subprocess.run([*place, "ip", "link", "set", "lo", way], check=True)  # noqa: E731
            link("down")
            time.sleep(float(self.name[4:]))
            link("up")
        elif self.name.startswith("replay"):
            self.replay()
        elif self.name == "second-controller":
            self.second = Log(self.folder / "second.csv")
            self.helpers.append(self.start(self.second, [0.0] * len(JOINTS), others=True))
        else:
            tool = ROOT / "tests/python/foreign.py"
            command = [*self.inside(others=True), self.options.python, tool, self.name, str(self.domain)]
            foreign = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            self.helpers.append(foreign)
            if not foreign.stdout.readline():
                raise Broken(f"the foreign program did nothing: {foreign.stderr.read()[-300:]}")
            self.struck_s = self.log.now()

    def wait_for_moment(self, process, later_s=0.0):
        """Whether the moment came before a fault of the controller had ended armid."""
        deadline, began = time.monotonic() + 40, None
        while began is None or self.log.now() < began + self.at_s + later_s:
            if process.poll() is not None and self.row.fault:
                return False
            if process.poll() is not None or time.monotonic() > deadline:
                said = [self.folder / name for name in ("said.json", "errors.txt")]
                said = [path.read_text(encoding="utf-8") if path.exists() else "" for path in said]
                done = subprocess.CompletedProcess(process.args, process.poll(), *said)
                raise Broken(f"before anything happened: {outcome(done)}")
            began = self.log.began()
            time.sleep(0.003)
        return True

    def interrupt_search(self, process):
        """The robot appears in the second before the signal, or just after it."""
        chance = random.Random(self.number)
        time.sleep(1.0)
        early = chance.uniform(-0.2, 1.0)
        if early >= 0.0:
            self.controller = self.start(self.log, start_pose(self.options))
            time.sleep(early)
        process.send_signal(chance.choice([signal.SIGINT, signal.SIGTERM, signal.SIGHUP]))
        asked = time.monotonic()
        if early < 0.0:
            time.sleep(-early)
            self.controller = self.start(self.log, start_pose(self.options))
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(timeout=20)
        self.search_s = time.monotonic() - asked

    def replay(self):
        """Sends again what another client has said to this robot, or to one like it, from here or from another machine."""
        host, target = "127.0.0.1", self.space.pid
        if self.name == "replay":
            other = subprocess.Popen([*self.options.space, "sleep", "600"])
            self.helpers.append(other)
            await_space(other, self.options)
            host, target = "10.99.0.1", other.pid
            ends = [f"armid-{self.space.pid}", f"armid-{other.pid}"]
            subprocess.run(["ip", "link", "add", ends[0], "type", "veth", "peer", "name", ends[1]], check=True)
            for end, place, address in zip(ends, (self.space.pid, target), (host, "10.99.0.2")):
                subprocess.run(["ip", "link", "set", end, "netns", str(place)], check=True)
                there = [*self.options.enter, f"--target={place}", "ip"]
                subprocess.run([*there, "address", "add", f"{address}/24", "dev", end], check=True)
                subprocess.run([*there, "link", "set", end, "up"], check=True)
        tool = [self.options.python, ROOT / "tests/python/replay.py", "send", str(self.domain), self.packets, host]
        sender = subprocess.Popen(
            [*self.options.others, *self.options.enter, f"--target={target}", *tool], stdout=subprocess.PIPE, text=True
        )
        self.helpers.append(sender)
        if not sender.stdout.readline():
            raise Broken("nothing was sent again")
        self.struck_s = self.log.now()

    def excuse(self, text):
        """Raises `Late` where a stream that must complete tripped by its current, at rest, and states came late."""
        with contextlib.suppress(ValueError):
            said, _ = json.JSONDecoder().raw_decode(text[text.index("{"):])
            trip, late_ms = said["trip"], silence_ms(said)
            if self.mode == STREAMED and trip and trip["name"] == "current-clamp" and late_ms > LATE_MS:
                if trip["rest"]["outcome"] != "confirmed":
                    raise Broken(f"expected rest to be confirmed: {said['detail']}")
                raise Late(f"no state for {late_ms:.1f} ms: {trip['reason']}")

    def judge(self, done):
        """What the run showed, or how it is broken."""
        rows = self.log.rows()
        times = moved(rows)
        if not self.name or self.row.unharmed:
            if done.returncode != 0:
                self.excuse(done.stdout)
                raise Broken(f"expected the run to complete: {outcome(done)}")
            return Found("completed", silence_ms=silence_ms(json.loads(done.stdout)))
        if self.name in ("search", "refused-goals") and times:
            raise Broken(f"commanded to move at t = {times[0]} s, expected nothing to move")
        if self.name == "search":
            taken = [row["event"] for row in rows if "motion taken" in row["event"]]
            if done.returncode != 130 or self.search_s > 1.0 or taken or "nothing has moved" not in done.stderr:
                raise Broken(f"{outcome(done)} {self.search_s:.1f} s after the signal, {taken}, expected exit 130 within 1 s")
            return Found("interrupted", confirmed=True)
        if self.name == "kill":
            self.by_itself(times)
            return Found("–", rest_ms=self.rest_ms(times))
        events = [(float(row["t"]), row["event"]) for row in rows if row["event"]]
        self.find_fault(events)
        if not done.stdout:
            if self.name != "disk-full" or done.returncode not in (1, 2, 3):
                raise Broken(f"no answer, {outcome(done)}")
            self.at_rest_from(times, self.ended_s)
            return Found("disk", rest_ms=self.rest_ms(times), confirmed=True)
        said = json.loads(done.stdout)
        if self.name.startswith("net-") and 1e3 * float(self.name[4:]) < self.options.stale_ms and said["ending"] == "completed":
            # As long as the guard allows a silence to be.
            return Found("completed")
        rest = said["rest"]
        confirmed = rest is not None and rest["outcome"] == "confirmed"
        name = said["trip"]["name"] if said["trip"] else "interrupted"
        expected = [trip or "interrupted" for trip in self.row.trips or ("",)]
        if rest is None or name not in expected:
            raise Broken(f"{outcome(done)}, expected {' or '.join(expected)}")
        status = 3 if not confirmed else 1 if said["trip"] else 130
        if done.returncode != status:
            raise Broken(f"{outcome(done)}, expected exit {status}")
        if not confirmed and not self.row.unseen and not self.row.nobody:
            raise Broken(f"{outcome(done)}, expected rest to be confirmed")
        if not confirmed and "NOT CONFIRMED" not in done.stderr:
            raise Broken("NOT CONFIRMED was not said on standard error")
        if self.name != "disk-full":
            self.check_recording(said)
        if self.name == "no-listener" and said["trip"]["action"] == "disable":
            raise Broken("disable was asked for, and nothing subscribes to it")
        bound_ms = said["trip"]["bound_ms"] if said["trip"] else None
        found = Found(name, bound_ms, self.request_ms(events, said), self.rest_ms(times), confirmed)
        if confirmed:
            self.at_rest_from(times, self.ended_s)
        elif not self.row.nobody:
            self.by_itself(times)
        if self.second and self.second_ended_s is not None:
            late = [t for t in moved(self.second.rows()) if t > self.second_ended_s + 0.01]
            if late:
                raise Broken(f"the second robot moves {late[0] - self.second_ended_s:.3f} s after armid ended")
        self.check_bounds(found)
        return found

    def find_fault(self, events):
        """When the fault struck, by the robot's own clock."""
        if self.row.fault:
            self.struck_s = next((t for t, e in events if f"fault {self.row.fault}" in e), None)
            if self.struck_s is None:
                raise Broken("the fault did not strike")
        if self.name == "panic":
            # A stream begins with a set-point at rest, in the lead.
            self.struck_s = self.log.began() + self.at_s + (LEAD_S if self.mode == STREAMED else 0.0)

    def by_itself(self, times):
        """Nothing could confirm it: the arm rests within the horizon of its last piece, or when its watchdog says so."""
        bound_s = LONGEST_S[self.options.speed] + STEP_S + self.row.found_s
        last = max((t for t in times if t >= self.struck_s), default=self.struck_s)
        if last > self.struck_s + bound_s:
            raise Broken(f"still moving {last - self.struck_s:.2f} s after, expected {bound_s} s at most")

    def at_rest_from(self, times, ended_s):
        late = [t for t in times if t > ended_s + 0.01]
        if late:
            raise Broken(f"commanded to move {late[0] - ended_s:.3f} s after armid said that the arm rests")

    def check_bounds(self, found):
        """The request within the bound that the trip states; rest a braking time after it, or within the horizon."""
        slack_ms = self.options.slack_ms
        # A clamp adds up what is above it over eight windows of 20 ms.
        adds_up = 140 if self.name == "oscillation" else 0
        bound_ms = (found.bound_ms or 10.0) + adds_up + slack_ms
        if self.row.bounded and found.request_ms is not None and found.request_ms > bound_ms:
            raise Broken(f"asked {found.request_ms:.0f} ms after the fault, expected {bound_ms:.0f} ms at most")
        within_ms = 1e3 * self.row.within_s + slack_ms
        if self.row.within_s and found.request_ms is not None and found.request_ms > within_ms:
            raise Broken(f"asked {found.request_ms:.0f} ms after the fault, expected {within_ms:.0f} ms at most")
        # A motion whose result is lost goes on to its end, and that is no fault of it.
        if found.rest_ms is None or self.name == "lost-result":
            return
        after_s = (BRAKING_S if self.mode == STREAMED else LONGEST_S)[self.options.speed]
        if self.name == "late-answer":
            # It takes the next piece in silence.
            after_s += HORIZON_S
        if self.row.interrupted_s:
            # Until it is interrupted it goes on, and what is late by then comes late.
            after_s += self.row.interrupted_s + self.row.size[1] + HORIZON_S
        rest_ms = max(bound_ms, within_ms) + 1e3 * (after_s + STEP_S + self.row.found_s)
        if found.rest_ms > rest_ms:
            raise Broken(f"at rest {found.rest_ms:.0f} ms after the fault, expected {rest_ms:.0f} ms at most")

    def rest_ms(self, times):
        if self.struck_s is None:
            return None
        return 1e3 * (max((t for t in times if t >= self.struck_s), default=self.struck_s) - self.struck_s)

    def check_recording(self, said):
        part = Path(said["recording"])
        data = part.read_bytes()
        if part != self.recording.with_name(self.recording.name + ".part") or not data.endswith(b"\x89MCAP0\r\n"):
            raise Broken("the recording is not whole")
        texts = ["armid/ending", said["ending"]]
        texts += [said["trip"]["name"], said["trip"]["reason"]] if said["trip"] else []
        if said["rest"]["outcome"] != "confirmed":
            texts.append("not-confirmed")
        for text in texts:
            if text.encode() not in data:
                raise Broken(f'the recording does not say "{text}"')

    def request_ms(self, events, said):
        """From the fault to the request that reached the robot controller; None where it could not be received."""
        if self.row.nobody:
            return float(said["trip"]["reason"].split(" ms, expected")[0].split()[-1])
        acted = next(
            (t for t, e in events if self.struck_s is not None and t >= self.struck_s
             and any(w in e for w in ("cancelled", "cancel received", "disabled", "disable received"))), None
        )
        if self.name == "lost-result" or self.mode != HANDED or acted is None:
            return None
        since = self.struck_s
        if self.name == "late-answer":
            since = next((t for t, e in events if since <= t < acted and "motion taken" in e), since)
        if self.name == "drop":
            since = max([t for t, e in events if since <= t < acted and "state sent" in e], default=since)
        if self.name == "jitter":
            stale = self.options.stale_ms
            since = next((t for t, e in events if since <= t <= acted and lateness_ms(e) > stale), acted)
        return 1e3 * (acted - since)


__all__ = ["Broken", "Found", "Late", "Run", "Unfit", "motion_s"]
