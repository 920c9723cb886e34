#!/usr/bin/env python3
"""What estimators of one recording cost: CRS A460 along Table I, one period of 10 s at 1 kHz, 58 parameters.

    venv/bin/python benches/peers/estimators.py target/release/armid

Processor time of the whole command on one thread, from reading the log to the answer as JSON, the least of the turns. "Linear" are the
estimators whose equations are linear in the parameters and which neither simulate nor hold them to a set, filters and networks left
out: ols, wls, irls-huber, irls-tukey, irls-cauchy, mm, tls, ridge, essential. The peer of DIDIM is `closed_loop.py`; with forward dynamics
in NumPy its time is that of one evaluation times as many as that program makes, and nothing else.
"""

import argparse
import json
import os
import subprocess
import tempfile
from pathlib import Path

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ[name] = "1"

from closed_loop import Didim
from machine import Program, facts, in_turn

LINEAR = ["ols", "wls", "irls-huber", "irls-tukey", "irls-cauchy", "mm", "tls", "ridge", "essential"]
EXPERIMENT = 'robot = "crs-a460"\ntrajectory = "table-one"\nperiods = 1\nseed = 3\n'


def measure(armid, quiet, turns, folder):
    """Seconds by what is estimated."""
    experiment, log = Path(folder) / "one-period.toml", Path(folder) / "one-period.mcap"
    experiment.write_text(EXPERIMENT)
    subprocess.run([armid, "run", experiment, "-o", log, "--quiet"], check=True, stdout=subprocess.DEVNULL)
    without = [name for name in LINEAR if name != "mm"]
    asked = {name: name for name in ["didim", "cloe", *LINEAR]} | {"linear": ",".join(LINEAR), "linear without mm": ",".join(without)}
    own = {name: Program([armid, "identify", log, "--estimator", words, "--json", "--quiet"], quiet) for name, words in asked.items()}
    reduced = subprocess.run([armid, "reduce", "crs-a460", "--columns", "rigid", "--json"], check=True, capture_output=True, text=True)
    peer, found, evaluation = Didim([entry["name"] for entry in json.loads(reduced.stdout)["base"]]), [], []

    def of_peer():
        found.append(peer.run())
        evaluation.append(peer.numpy_evaluation())

    in_turn(turns, *own.values(), of_peer)
    seconds = {name: min(program.seconds) for name, program in own.items()}
    return seconds | {"dearest": max(seconds[name] for name in LINEAR), "dearest without mm": max(seconds[name] for name in without),
                      "pinocchio didim": min(run[2] for run in found), "numpy didim": min(evaluation) * found[0][1]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("armid", help="the command, built with --release")
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--quiet", action="store_true", help="before other work of the machine, where the system gives that")
    arguments = parser.parse_args()
    from rows import ESTIMATORS, markdown

    with tempfile.TemporaryDirectory() as folder:
        found = measure(str(Path(arguments.armid).resolve()), arguments.quiet, arguments.turns, folder)
    print(json.dumps({"machine": facts(), "seconds": found}, indent=1), end="\n\n")
    print(markdown(found, ESTIMATORS))


if __name__ == "__main__":
    main()
