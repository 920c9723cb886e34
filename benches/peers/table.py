#!/usr/bin/env python3
"""Every comparison of armid with other libraries in one run: one table in Markdown, one JSON file.

    python3 -m venv venv && venv/bin/pip install pin cmeel-eigen casadi scipy mujoco==3.17.0
    scripts/get-mujoco
    venv/bin/python benches/peers/table.py -o benches/peers/table.json

Builds what it times (cargo, g++), lets the sides take turns, and takes the least of the repeats on each side. Processes that take
seconds run before other work of the machine on one core where the system gives real-time priority (--quiet), never longer than a
minute at a time. "Before" is what was measured at commit bf4d035 in the same way; it is not measured again.
"""

import argparse
import contextlib
import json
import os
import re
import subprocess
import tempfile
from pathlib import Path

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ[name] = "1"

import casadi
import estimators
import excitation
import generated
import identification
import numpy as np
import pinocchio as pin
import scipy
from arm import build, columns_of
from machine import REPOSITORY, Program, facts, in_turn, processor_time
from pipeline import Pipeline
from rows import ROWS, markdown

NS = r" +([0-9.]+) ns"
# What each group of rows times.
GROUPS = {
    "evaluations": {"armid": ["dynamics"]},
    "simulation": {"armid-sim": ["mujoco", "step"]},
    "fits": {"armid": ["identification", "reduction"]},
    "study": {"armid-cli": []},
    "design": {"armid-cli": []},
    "estimators": {"armid-cli": []},
}


def built(groups):
    """The benchmarks and the command, by name."""
    found = {}
    for group in groups:
        for package, benches in GROUPS[group].items():
            command = ["bench", "--no-run", *(part for bench in benches for part in ("--bench", bench))]
            command = command if benches else ["build", "--release", "--bin", "armid"]
            ran = subprocess.run(["cargo", *command, "--locked", "-p", package, "--message-format", "json"], cwd=REPOSITORY,
                                 stdout=subprocess.PIPE, text=True, check=True)
            messages = map(json.loads, ran.stdout.splitlines())
            found |= {message["target"]["name"]: message["executable"] for message in messages if message.get("executable")}
    return found


def compiled(programs, folder):
    """Pinocchio's headers, CasADi's source and the source that armid exports, for this processor."""
    prefix = Path(pin.__file__).parents[4] / "include"
    flags = ["-O3", "-march=native", "-std=c++17", "-DNDEBUG"]
    # Joint types of Pinocchio are more than Boost's lists hold by default.
    limits = ["-DBOOST_MPL_LIMIT_LIST_SIZE=30", "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30", "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
              "-DBOOST_FUSION_INVOKE_MAX_ARITY=12"]
    here, native = Path(__file__).parent, Path(folder) / "native"
    generated.write(folder)
    subprocess.run([programs["dynamics"], "--source", Path(folder) / "exported.c"], check=True)
    sources = []
    for name in ("generated", "exported"):
        sources.append(Path(folder) / name)
        subprocess.run(["g++", *flags, f"-I{folder}", here / f"{name}.cpp", "-o", sources[-1]], check=True)
    # Two minutes of compilation, and as many pages of warnings.
    texts = [here / "regressor.cpp", here / "batches.hpp"]
    if not native.exists() or native.stat().st_mtime < max(text.stat().st_mtime for text in texts):
        subprocess.run(["g++", "-w", *flags, *limits, f"-I{prefix}", f"-I{prefix}/eigen3", texts[0], "-o", native], check=True)
    return native, *sources


def evaluations(programs, native, code, exported_code, quiet, turns):
    """One evaluation of regressor and dynamics, ns."""
    programs = [programs["dynamics"], native, code, exported_code]
    armid, peer, casadi_code, exported = (Program([program], quiet) for program in programs)
    library = library_regressor()
    found = {"library regressor": float("inf")}

    def from_python():
        found["library regressor"] = min(found["library regressor"], library())

    in_turn(turns, armid, peer, casadi_code, exported, from_python)
    for name, line in {"regressor": "regressor, rigid", "stack": "stack, rigid, per sample",
                       "lanes": "stack in parts, base of rigid, per sample",
                       "place": "stack in one place, base of rigid, per sample", "rnea": "inverse dynamics, links alone",
                       "aba": "forward dynamics, articulated bodies, links alone",
                       "composite": "forward dynamics, mass matrix, links alone"}.items():
        found[name] = armid.least(f"(?m)^{line}{NS}")
    for name in ("regressor", "RNEA", "ABA"):
        found[f"native {name.lower()}"] = peer.least(f"Pinocchio, {name}{NS}")
        found[f"casadi {name.lower()}"] = casadi_code.least(f"CasADi, {name}{NS}")
    for name in ("regressor", "RNEA", "forward dynamics"):
        found[f"exported {name.lower()}"] = exported.least(f"exported, {name}{NS}")
    return found


def library_regressor():
    """Pinocchio's compiled library, called from Python, ns."""
    model, data, _ = build()
    states = np.random.default_rng(1).uniform(-3, 3, (256, 3, 6))

    def once():
        seconds, _ = processor_time(lambda: [pin.computeJointTorqueRegressor(model, data, *s) for s in states])
        return 1e9 * seconds / len(states)

    return lambda: min(once() for _ in range(50))


def simulation(programs, quiet, turns):
    """Steps of 1 ms beside MuJoCo's, which the same program takes in turn, ns; an experiment, µs a step."""
    mujoco, step = Program([programs["mujoco"]], quiet), Program([programs["step"]], quiet)
    in_turn(turns, mujoco, step)
    found = {name: mujoco.least(f"(?m)^{line}{NS}") for name, line in {
        "euler": "MuJoCo's Euler step, no friction", "rk4": "MuJoCo's RK4 step, no friction", "forward": "analytic forward dynamics",
        "servo": "servo: controller, sensors, phases", "lane": "analytic plant, 8 runs in lanes",
        "lane smooth": "analytic plant, 8 runs in lanes, no friction", "lane rest": "analytic plant, 8 runs in lanes, at rest",
        "own rk4": "analytic plant's RK4 step, no friction"}.items()}
    found["experiment"] = step.least(r"period 10 s: .*?([0-9.]+) µs per servo step")
    found["experiment 16"] = step.least(r"period 10 s, 16 runs together: .*?([0-9.]+) µs per servo step")
    return found


def fits(programs, quiet, turns, folder):
    """10,000 samples to estimates with intervals, ms; a record without a period, s and MB; a reduction of 40 joints, s."""
    model, data, change = build()
    states = identification.draw(model, data, change)
    path = Path(folder) / "states.f64"
    np.hstack(states).astype("<f8").tofile(path)
    own, peer, normal, answers = Program([programs["identification"], "--states", path], quiet), [], [], {}

    def of_peer():
        columns = columns_of(change, json.loads(own.texts[0])["names"])
        seconds, _, found = identification.identify(model, data, columns, *states)
        peer.append(seconds)
        normal.append(identification.identify(model, data, columns, *states, fit=identification.by_normal_equations)[0])
        answers.update(found)

    in_turn(turns, own, of_peer)
    identification.agree(json.loads(own.texts[-1]), answers)
    long, reduction = Program([programs["identification"], "--aperiodic"], quiet), Program([programs["reduction"]], quiet)
    in_turn(1, long, reduction)
    return {"identify": 1e3 * min(json.loads(text)["seconds"] for text in own.texts), "numpy": 1e3 * min(peer), "numpy normal": 1e3 * min(normal),
            "million": long.least(r"1000000 samples without a period, WLS: ([0-9.]+) s"),
            "million MB": long.least(r"1000000 samples .* most memory so far (\d+) kB") / 1024,
            "paper 40": reduction.least(r"(?m)^ +40 +([0-9.]+)"),
            **{f"texts {joints}": reduction.least(rf"(?m)^ +{joints} +(?:[0-9.]+ +){{3}}([0-9.]+)") for joints in (40, 80)}}


def study_run(programs, quiet, turns, folder):
    """One Monte Carlo run of 01: what more runs of Table I's trajectory cost, ms of processor time; and the Python program's, which must identify
    its arm."""
    text = (REPOSITORY / "experiments/01-criteria/study.toml").read_text()
    # Table I's family alone, with as many runs as are asked for.
    family = re.sub(r"(?m)^runs = .*$", "", text[text.rindex("[[design]]") :])
    (Path(folder) / "study.toml").write_text(text[: text.index("[[design]]")] + family)
    few, many = 8, 72

    def of(runs):
        return Program([programs["armid"], "study", Path(folder) / "study.toml", "--runs", runs, "--jobs", 1, "--quiet", "-o",
                        Path(folder) / f"study-{runs}"], quiet)

    small, large = of(few), of(many)
    reduced = subprocess.run([programs["armid"], "reduce", "crs-a460", "--columns", "rigid", "--json"], check=True, capture_output=True,
                             text=True)
    peer, seconds = Pipeline([entry["name"] for entry in json.loads(reduced.stdout)["base"]]), []

    def of_peer():
        for seed in range(5):
            took, estimates = processor_time(lambda: peer.run(seed))
            seconds.append(took)
            for _, _, error in estimates:
                assert np.all(error < 0.02 * np.sqrt((peer.exact**2).mean(axis=0))), f"the peer predicts to {error} N·m only"

    in_turn(turns, small, large, of_peer)
    return {"run": 1e3 * (min(large.seconds) - min(small.seconds)) / (many - few), "python run": 1e3 * min(seconds)}


def designs(programs, folder):
    """Designs of 150 iterations, s, from the start where the ratio is least."""
    runs = excitation.compare(programs["armid"], [1, 2, 3], 150, folder)
    slow = min(runs, key=lambda run: run["ratio_iterations"])
    late = min((run for run in runs if run["ratio_same_value"]), key=lambda run: run["ratio_same_value"])
    return {"design": slow["armid"]["seconds"], "slsqp": slow["peer"]["seconds"],
            "to value": late["armid_seconds_to_peer_value"], "slsqp to value": late["peer"]["seconds"]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--turns", type=int, default=5, help="repeats of every side")
    parser.add_argument("--quiet", action="store_true", help="before other work of the machine, where the system gives that")
    parser.add_argument("--only", nargs="+", choices=GROUPS, default=list(GROUPS), help="these groups of rows")
    parser.add_argument("--folder", help="keep what the C++ compiler makes in this folder, and use it again")
    parser.add_argument("-o", "--output", default=str(Path(__file__).parent / "table.json"))
    arguments = parser.parse_args()
    programs = built(arguments.only)
    machine, found = facts(), {}
    quiet, turns, only = arguments.quiet, arguments.turns, arguments.only
    with tempfile.TemporaryDirectory() if arguments.folder is None else contextlib.nullcontext(arguments.folder) as folder:
        Path(folder).mkdir(exist_ok=True)
        if "evaluations" in only:
            found |= evaluations(programs, *compiled(programs, folder), quiet, turns)
        if "simulation" in only:
            found |= simulation(programs, quiet, turns)
        if "fits" in only:
            found |= fits(programs, quiet, turns, folder)
        if "study" in only:
            found |= study_run(programs, quiet, min(turns, 3), folder)
        if "design" in only:
            found |= designs(programs, folder)
        if "estimators" in only:
            found |= estimators.measure(programs["armid"], quiet, min(turns, 3), folder)
    versions = {"pinocchio": pin.__version__, "casadi": casadi.__version__, "numpy": np.__version__, "scipy": scipy.__version__,
                "mujoco": "3.17.0"}
    table = markdown(found)
    answer = {"machine": machine, "versions": versions, "turns": arguments.turns, "quiet": arguments.quiet,
              "figures": found, "rows": [row.answer(found) for row in ROWS if row.known(found)]}
    Path(arguments.output).write_text(json.dumps(answer, indent=1) + "\n")
    print("; ".join(f"{key} {value}" for key, value in (machine | versions).items()), end="\n\n")
    print(table)


if __name__ == "__main__":
    main()
