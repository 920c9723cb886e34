"""The faults of `scripts/faults`: the faults, the modes in which they occur, and the trips that may follow."""

from dataclasses import dataclass

HANDED, STREAMED, TOPIC = "trajectory", "stream", "topic"
BOTH = (HANDED, STREAMED)
# What another client on the network can cause, whichever sign armid notices first.
# States of two robots at once look like anything.
OTHERS = ("interference", "robot-stopped", "link", "stale-state", "position-jump", "following-error", "overspeed", "soft-limit")
# A motion whose pieces come late leaves its path, unless armid is interrupted before.
LATE = (
    "", "following-error", "position-jump", "robot-stopped", "unexpected-stop", "no-acceptance", "link", "overspeed", "soft-limit",
    "current-clamp",
)
LATE_GOALS = {"size": (0.05, 0.49), "interrupted_s": 0.6, "before_s": 0.9}
# A clock that has lost time looks like states that are late.
SLOW = ("robot-stopped", "stale-state")


@dataclass(frozen=True)
class Row:
    """One fault. Without trips the run is interrupted, exit status 130."""

    trips: tuple = ()
    # Ways in which motions go out.
    modes: tuple = BOTH
    # What `armid controller` is told to do, and whether the trip's bound holds from there to the request.
    fault: str = ""
    bounded: bool = False
    # Nothing is left to report that the arm is at rest: the robot controller has ended.
    nobody: bool = False
    # Everybody on the network has to be found first, s.
    found_s: float = 0.0
    # Moments end so long before the motion does, s: later there is nothing left for the fault to act on.
    before_s: float = 0.1
    # Rest may be NOT CONFIRMED: nothing can report it, or the network is gone for longer than armid insists.
    unseen: bool = False
    # Further arguments of the controller.
    controller: tuple = ()
    # The run ends as if nothing had happened.
    unharmed: bool = False
    # How a run before it, with the same controller, ends at the moment.
    before: str = ""
    # Smallest and largest size of the controller's fault.
    size: tuple = ()
    # From the fault to the request at most, s of the robot's clock, where that is not the trip's bound.
    within_s: float = 0.0
    # armid is interrupted at a random moment so long after the fault, s.
    interrupted_s: float = 0.0


def controller(name, *trips, modes=BOTH, bounded=True, **more):
    return Row(trips=trips, modes=modes, fault=name, bounded=bounded, **more)


ROWS = {
    "freeze": controller("freeze", "stale-state", nobody=True),
    "drop": controller("drop", "stale-state"),
    "jitter": controller("jitter", "stale-state"),
    "jump": controller("jump", "position-jump", "following-error", "robot-stopped"),
    "overcurrent": controller("overcurrent", "current-clamp"),
    "oscillation": controller("oscillation", "current-clamp"),
    "estop": controller("estop", "robot-stopped"),
    "die": controller("die", "stale-state", nobody=True),
    "order": controller("order", "position-jump", "following-error"),
    "nan": controller("nan", "not-finite"),
    "clock": controller("clock", "robot-stopped"),
    "strange-state": controller("strange-state", "robot-stopped"),
    # A clock that is stepped, or runs at another rate. 20 ms of gain show within a state; a loss is one once it has lasted. Moments
    # end where enough time is left, and a robot that stands still for some ms under load loses part of its gain.
    "clock-ahead": controller("clock", "robot-stopped", size=(0.05, 0.45)),
    "clock-back": controller("clock", *SLOW, bounded=False, size=(-0.45, -0.05), within_s=0.8, before_s=0.9),
    "rate-0.9": controller("rate", *SLOW, bounded=False, size=(0.9, 0.9), within_s=0.9, before_s=1.0),
    "rate-1.05": controller("rate", "robot-stopped", "current-clamp", bounded=False, size=(1.05, 1.05), within_s=0.9, before_s=1.0),
    "rate-1.3": controller("rate", "robot-stopped", "current-clamp", bounded=False, size=(1.3, 1.3), within_s=0.25, before_s=0.4),
    "rate-2": controller("rate", "robot-stopped", "current-clamp", bounded=False, size=(2.0, 2.0), within_s=0.1, before_s=0.3),
    # Only an action answers, and has results.
    "late-answer": controller("late-answer", "no-acceptance", modes=(HANDED,), before_s=1.0),
    "lost-result": controller("lost-result", "no-result", modes=(HANDED,), bounded=False),
    # A controller that takes no trajectory without points, and one that takes no second trajectory at all.
    "refusing-topic": controller("strange-state", "robot-stopped", modes=(TOPIC,)),
    "no-replacement": Row(("following-error", "unexpected-stop"), (TOPIC,), controller=("--replacement", "refused")),
    # A position that is not a number asks for `disable`: nothing subscribes to it.
    "no-listener": controller("nan", "not-finite", bounded=False, unseen=True),
    # The first goals are refused, one to ten of them; then they would be taken.
    "refused-goals": Row(("robot-stopped",), (HANDED,)),
    # One controller for several runs, whichever way the one before has ended. A stream that ends while the arm moves switches the
    # drives off, so that no second one follows.
    "after-completed": Row(unharmed=True, before="completed"),
    "after-tripped": Row(modes=(HANDED,), unharmed=True, before="tripped"),
    "after-interrupted": Row(unharmed=True, before="interrupted"),
    "after-killed": Row(modes=(HANDED,), unharmed=True, before="killed"),
    "first-run": Row(unharmed=True),
    # The end is asked for while the robot is looked for, which is found at about that moment.
    "search": Row(),
    # A goal that was sent before the cancel is carried out after it.
    "late-execution": controller("late-execution", *LATE, modes=(HANDED,), bounded=False, **LATE_GOALS),
    "lost-goal": controller("lost-goal", *LATE, modes=(HANDED,), bounded=False, **{**LATE_GOALS, "interrupted_s": 0.2}),
    # What happens to armid.
    "stop-continue": Row(("stale-state", "link", "command-age")),
    "interrupt": Row(),
    "two-signals": Row(),
    "hangup": Row(),
    "terminal": Row(),
    "suspend": Row(),
    "thread": Row(("stale-state", "link")),
    "panic": Row(("panic",), bounded=True),
    "kill": Row(),
    "disk-full": Row(),
    # What happens to the network: the seconds for which it is gone.
    "net-0.1": Row(("stale-state", "link")),
    "net-0.3": Row(("stale-state", "link")),
    "net-1": Row(("stale-state", "link")),
    "net-5": Row(("stale-state", "link"), unseen=True),
    # Packets of a client that has been there, sent again: from another machine, where they must do nothing, and from this one.
    "replay": Row(unharmed=True),
    "replay-inside": Row(OTHERS, (HANDED,), found_s=2.0, before_s=2.5, unseen=True),
    # Another client.
    "foreign-cancel": Row(OTHERS, (HANDED,), found_s=1.0, before_s=1.5),
    "foreign-goal": Row(OTHERS, (HANDED,), found_s=1.0, before_s=1.5),
    "foreign-state": Row(OTHERS, found_s=1.0, before_s=1.5),
    # States of two robots show neither of them at rest.
    "second-robot": Row(OTHERS, found_s=1.0, before_s=1.5, unseen=True),
    "second-controller": Row(OTHERS, found_s=2.0, before_s=2.5, unseen=True),
}
