"""The rows of the table: which figures stand against each other, what was measured before, and what is asked for."""

from dataclasses import dataclass
from typing import Callable


@dataclass(frozen=True)
class Row:
    """`own` and `peer` in `unit`; `before` and `bound` are ratios own/peer, or in the unit where there is no peer."""

    item: str
    unit: str
    own: Callable
    other: str | None = None
    peer: Callable | None = None
    before: str = ""
    bound: float | None = None
    # The ratio is peer/own, and asked to be at least the bound.
    times: bool = False

    def known(self, found):
        """Whether its figures were measured."""
        try:
            return self.answer(found) is not None
        except KeyError:
            return False

    def answer(self, found):
        own, peer = self.own(found), self.peer and self.peer(found)
        ratio = None if peer is None else peer / own if self.times else own / peer
        judged = own if ratio is None else ratio
        met = None if self.bound is None else judged >= self.bound if self.times else judged <= self.bound
        return {"item": self.item, "unit": self.unit, "own": own, "other": self.other, "peer": peer, "ratio": ratio,
                "before": self.before, "bound": self.bound, "met": met}


def of(name):
    return lambda found: found[name]


NATIVE = "Pinocchio's headers, native C++"
CASADI = "CasADi's C"
# One recording of 10 s at 1 kHz: `estimators.py`.
ESTIMATORS = [
    Row("DIDIM of 10 s at 1 kHz", "s", of("didim"), bound=1.0),
    Row("the same", "s", of("didim"), "NumPy, forward dynamics too", of("numpy didim"), bound=0.01),
    Row("the same", "s", of("didim"), "NumPy + Pinocchio's library, ABA", of("pinocchio didim")),
    Row("CLOE of 10 s at 1 kHz", "s", of("cloe"), bound=10.0),
    Row("all nine linear estimators of one recording", "s", of("linear"), "the dearest of them, `mm`", of("dearest"), bound=1.5),
    Row("the same without `mm`", "s", of("linear without mm"), "the dearest of these", of("dearest without mm"), bound=1.5),
]
ROWS = [
    Row("regressor, 60 columns, scalar", "ns", of("regressor"), NATIVE, of("native regressor"), "0.30", 0.25),
    Row("the same", "ns", of("regressor"), "Pinocchio's library, from Python", of("library regressor"), "0.21"),
    Row("the same", "ns", of("regressor"), CASADI, of("casadi regressor"), "2.1"),
    Row("stack of 256 samples, 60 columns, per sample", "ns", of("stack"), NATIVE, of("native regressor"), "0.43"),
    Row("36 base columns in lanes, in parts, per sample", "ns", of("lanes"), NATIVE, of("native regressor"), "none", 0.05),
    Row("the same into one matrix of 250 samples", "ns", of("place"), NATIVE, of("native regressor"), "none", 0.10),
    Row("36 base columns in lanes, in parts, per sample", "ns", of("lanes"), CASADI, of("casadi regressor"), "none"),
    Row("inverse dynamics", "ns", of("rnea"), f"{NATIVE}, RNEA", of("native rnea"), "0.51", 0.20),
    Row("the same", "ns", of("rnea"), f"{CASADI}, RNEA", of("casadi rnea"), "2.8"),
    Row("forward dynamics, articulated bodies", "ns", of("aba"), f"{NATIVE}, ABA", of("native aba"), "0.41", 0.25),
    Row("forward dynamics, mass matrix", "ns", of("composite"), f"{NATIVE}, ABA", of("native aba"), "0.32", 0.25),
    Row("the same", "ns", of("composite"), f"{CASADI}, ABA", of("casadi aba"), "2.2"),
    Row("exported C, regressor of 36 base columns", "ns", of("exported regressor"), NATIVE, of("native regressor"), "none", 0.25),
    Row("the same", "ns", of("exported regressor"), f"{CASADI}, 60 columns", of("casadi regressor"), "none", 1.2),
    Row("exported C, inverse dynamics", "ns", of("exported rnea"), f"{NATIVE}, RNEA", of("native rnea"), "", 0.20),
    Row("the same", "ns", of("exported rnea"), f"{CASADI}, RNEA", of("casadi rnea"), "", 1.2),
    Row("exported C, forward dynamics", "ns", of("exported forward dynamics"), f"{NATIVE}, ABA", of("native aba"), "none", 0.25),
    Row("the same", "ns", of("exported forward dynamics"), f"{CASADI}, ABA", of("casadi aba"), "none", 1.2),
    Row("forward dynamics with servo", "ns", lambda found: found["forward"] + found["servo"], "MuJoCo's Euler step", of("euler"),
        "0.39 to 0.42", 0.30),
    Row("RK4 step in lanes, friction, per run", "ns", of("lane"), "MuJoCo's RK4 step, no friction", of("rk4"), "0.086", 0.05),
    Row("the same, no friction", "ns", of("lane smooth"), "MuJoCo's RK4 step, no friction", of("rk4"), "", 0.05),
    Row("RK4 step in lanes, all joints at rest, per run", "ns", of("lane rest"), "the same in motion", of("lane"), "4 to 6", 1.3),
    Row("an experiment, per step of 1 ms", "µs", of("experiment"), before="2.13"),
    Row("the same, 16 runs together", "µs", of("experiment 16"), before="0.81"),
    Row("10,000 samples to OLS and WLS with intervals", "ms", of("identify"), "NumPy + Pinocchio", of("numpy"), "2.4", 0.10),
    Row("the same", "ms", of("identify"), "NumPy + Pinocchio, normal equations", of("numpy normal"), bound=0.12),
    Row("10⁶ samples without a period to WLS", "s", of("million"), before="45.5", bound=3.0),
    Row("most memory of these", "MB", of("million MB"), before="1200", bound=500.0),
    Row("`reduce --method paper`, 40 joints", "s", of("paper 40"), before="50", bound=2.0),
    Row("its base parameters as texts, 40 joints", "s", of("texts 40"), bound=0.5),
    Row("the same, 80 joints", "s", of("texts 80"), bound=4.0),
    Row("one Monte Carlo run of 01", "ms", of("run"), before="194", bound=50.0),
    Row("the same", "ms", of("run"), "MuJoCo's rollout, NumPy + Pinocchio", of("python run"), bound=0.167),
    Row("excitation, 150 iterations, least of 3 starts", "s", of("design"), "SciPy + Pinocchio",
        of("slsqp"), "66 to 78 times", 150.0, times=True),
    Row("the same, to the peer's value", "s", of("to value"), "SciPy + Pinocchio", of("slsqp to value"), "93 to 149 times", times=True),
    *ESTIMATORS,
]


def number(value):
    if value is None:
        return ""
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"


def markdown(found, rows=ROWS):
    lines = ["| item | armid | peer | | before | after | bound | |", "|---|---|---|---|---|---|---|---|"]
    for row in filter(lambda row: row.known(found), rows):
        a = row.answer(found)
        peer = "" if a["peer"] is None else f"{number(a['peer'])} {a['unit']}"
        after = f"{number(a['own'])} {a['unit']}" if a["ratio"] is None else number(a["ratio"]) + (" times" if row.times else "")
        before = f"{a['before']} {a['unit']}" if a["ratio"] is None and a["before"] else a["before"]
        bound = "" if a["bound"] is None else number(a["bound"]) + (" times" if row.times else f" {a['unit']}" if a["ratio"] is None else "")
        met = {None: "", True: "met", False: "missed"}[a["met"]]
        own = f"{number(a['own'])} {a['unit']}"
        lines.append(f"| {a['item']} | {own} | {a['other'] or ''} | {peer} | {before} | {after} | {bound} | {met} |")
    return "\n".join(lines)
