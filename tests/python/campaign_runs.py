"""How often the intervals of `armid campaign` cover the true parameters where it ends, and how long the arm moves until then.

    ARMID=target/release/armid python tests/python/campaign_runs.py [--arms crs-a460 puma-560 staubli-tx40] [--campaigns 67] [--shard 1/4]
        [--effect load-friction=0.05] [--adds-terms] [--torque-filter same-as-positions] [--rounds 8] [--evaluations 60] -o DIR

Each arm has four targets: predicted torque, the Coulomb friction and the viscous friction of joint 2, and a first moment. Their limits are a
share of what one D-optimal motion reaches in two rounds of a pilot; with --effect they are half of what errors of the model leave there. Arms
have the noise of their currents, and neither counts nor effects unless --effect states one, so that noise is what is left. Every campaign is performed with redesign, target by target, and once with one motion repeated, which is looked at target by target. Finished
campaigns are kept in DIR, and a shard performs every Nth one. Without any left, the table is printed: *time* is the geometric mean of seconds
with redesign over those with repetition. A campaign that ends without the target counts with the time of all rounds, for redesign and
repetition alike; repetition goes on until the last round. *covered* is the share of intervals at the end that hold the true value, with its
95 % interval.
"""

import argparse
import json
import math
import os
import subprocess
import tempfile
import tomllib
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent.parent
ARMID = Path(os.environ["ARMID"]).resolve()
INERTIA = {"crs-a460": "mcx2", "puma-560": "mcx2", "staubli-tx40": "mcx2", "planar-2r": "mcx2"}
SHARE = 0.75
DRIVE = {
    "Ia": "rotor_kg_m2", "Fv": "viscous_nm_s_rad", "Fc": "coulomb_nm", "Fo": "offset_nm", "Fvm": "motor_viscous_nm_s_rad",
    "Fcm": "motor_coulomb_nm",
}
TEN = ["m", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Ixz", "Iyy", "Iyz", "Izz"]


def armid(*words, codes=(0, 1)):
    run = subprocess.run([ARMID, *map(str, words), "--json", "--quiet"], capture_output=True, text=True)
    if run.returncode not in codes:
        raise RuntimeError(f"armid {' '.join(map(str, words))}\n{run.stderr}")
    return json.loads(run.stdout)


def truth(arm):
    """True base parameters by name: those of every link about the origin of its frame, and of every drive, combined as `reduce` says."""
    told = tomllib.loads((ROOT / "models" / arm / "truth.toml").read_text(encoding="utf-8"))
    values = {}
    for number, link in enumerate(told["link"], 1):
        mass = link["mass_kg"]
        about = link.get("inertia_kg_m2") or link["inertia_about_com_kg_m2"]
        origin = np.array([[about[min(a, b) + max(a, b)] for b in "xyz"] for a in "xyz"])
        moment = np.array(link["first_moment_kg_m"] if "first_moment_kg_m" in link else [mass * x for x in link["com_m"]])
        if "com_m" in link:
            origin += (moment @ moment * np.eye(3) - np.outer(moment, moment)) / mass
        ten = [mass, *moment, *(origin[a, b] for a, b in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)])]
        values.update({f"{name}{number}": value for name, value in zip(TEN, ten, strict=True)})
    for number, drive in enumerate(told["drive"], 1):
        values.update({f"{name}{number}": drive.get(key, 0.0) for name, key in DRIVE.items()})
    base = armid("reduce", arm, "--columns", "rigid+rotor+friction")["base"]
    return {of["name"]: sum(term["coefficient"] * values[term["parameter"]] for term in of["terms"]) for of in base}


def campaign(arguments, arm, seed, until, repeats):
    """The answer of one campaign."""
    with tempfile.TemporaryDirectory() as scratch:
        plan = Path(scratch) / "plan.toml"
        effects = "".join(f"[effects]\n{name} = {float(size)}\n" for name, size in [arguments.effect.split("=")]) if arguments.effect else ""
        plan.write_text(f'robot = "{arm}"\narm = "{arguments.engine}"\nrate_hz = 500.0\nperiods = 4\n[sensing]\nencoders = false\nconverters = false\n{effects}', encoding="utf-8")
        words = [word for target in until for word in ("--until", target)]
        words += [] if arguments.adds_terms else ["--columns", "rigid+rotor+friction"]
        words += ["--torque-filter", arguments.torque_filter] if arguments.torque_filter else []
        words += ["--seed", seed, "--rounds", arguments.rounds, "--starts", 1, "--evaluations", arguments.evaluations]
        return armid("campaign", plan, *words, *(["--repeat"] if repeats else []), "-o", Path(scratch) / "campaign")


def stored(path, make):
    """What a file holds, or what is made and stored in it, whole or not at all."""
    if not path.is_file():
        made = make()
        path.parent.mkdir(parents=True, exist_ok=True)
        path.with_suffix(".part").write_text(json.dumps(made), encoding="utf-8")
        path.with_suffix(".part").rename(path)
    return json.loads(path.read_text(encoding="utf-8"))


def targets(arguments, arm):
    """The four targets of an arm, by a pilot."""
    names = ["torque", "Fc2", "Fv2", INERTIA[arm]]

    def pilot():
        small = [f"{name} <= 1e-9{' %' if name == 'torque' else ''}" for name in names]
        answer = campaign(arguments, arm, 0, small, True)
        last = answer["rounds"][1]["widths"]
        widths = [0.5 * of["by_model_error"] if arguments.effect else SHARE * of["half_width"] for of in last]
        return [f"{name} <= {100 * width:.3g} %" if name == "torque" else f"{name} <= {width:.3g}" for name, width in zip(names, widths, strict=True)]

    return stored(arguments.output / arm / "targets.json", pilot)


def end(answer, index, limit, most):
    """When one of the targets of a campaign is reached, s: the time of all rounds where it is not; and whether it is."""
    rounds = answer["rounds"]
    for round_ in rounds:
        if round_["widths"][index]["half_width"] <= limit:
            return round_["total_s"], True
    return rounds[-1]["total_s"] + (most - len(rounds)) * rounds[-1]["seconds"], False


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--arms", nargs="+", default=["crs-a460", "puma-560", "staubli-tx40"], choices=INERTIA)
    parser.add_argument("--campaigns", type=int, default=67)
    parser.add_argument("--shard", default="1/1")
    parser.add_argument("--effect")
    parser.add_argument("--adds-terms", action="store_true", help="terms that the logs show may join the model")
    parser.add_argument("--engine", default="analytic", help="what simulates the arm, as `arm` of an experiment names it")
    parser.add_argument("--torque-filter")
    parser.add_argument("--rounds", type=int, default=8)
    parser.add_argument("--evaluations", type=int, default=60)
    parser.add_argument("-o", "--output", type=Path, required=True)
    arguments = parser.parse_args()
    part, parts = map(int, arguments.shard.split("/"))
    print("| arm | target | campaigns | rounds | time | covered | reached | out of reach | reached by repetition |\n|---|---|---|---|---|---|---|---|---|")
    ratios, hits, count = [], 0, 0
    for arm in arguments.arms:
        until, true = targets(arguments, arm), truth(arm)
        seeds = [seed for seed in range(1, arguments.campaigns + 1) if seed % parts == part % parts]
        rows = [[] for _ in until]
        for seed in seeds:
            repeated = stored(arguments.output / arm / f"{seed}-repeat.json", lambda: campaign(arguments, arm, seed, until, True))
            for index, target in enumerate(until):
                own = stored(arguments.output / arm / f"{seed}-{index}.json", lambda: campaign(arguments, arm, seed, [target], False))
                name, bound = target.split(" <= ")
                limit = float(bound.removesuffix(" %")) / (100.0 if bound.endswith("%") else 1.0)
                width = own["rounds"][-1]["widths"][0]
                covered = None if name == "torque" else abs(width["value"] - true[name]) <= width["half_width"]
                (seconds, _), (other, reached) = (end(of, place, limit, arguments.rounds) for of, place in ((own, 0), (repeated, index)))
                rows[index].append((len(own["rounds"]), math.log(seconds / other), covered, own["outcome"], reached))
        for target, row in zip(until, rows, strict=True):
            logs = [log for _, log, *_ in row]
            seen = [covered for _, _, covered, *_ in row if covered is not None]
            outcomes, repeats = [outcome for *_, outcome, _ in row], sum(reached for *_, reached in row)
            ratios, hits, count = [*ratios, np.mean(logs)], hits + sum(seen), count + len(seen)
            time = f"{math.exp(np.mean(logs)):.2f}"
            share = f"{np.mean(seen):.3f}" if seen else "–"
            rounds = np.median([rounds for rounds, *_ in row])
            print(f"| {arm} | `{target}` | {len(row)} | {rounds:.0f} | {time} | {share} | {outcomes.count('reached')} | {outcomes.count('model-error')} | {repeats} |", flush=True)
    if ratios and count:
        p, z = hits / count, 1.96
        middle, half = (p + z * z / 2 / count) / (1 + z * z / count), z * math.sqrt(p * (1 - p) / count + z * z / 4 / count**2) / (1 + z * z / count)
        print(f"\ntime {math.exp(np.mean(ratios)):.3f}, covered {p:.3f} [{middle - half:.3f}, {middle + half:.3f}] of {count} intervals")


if __name__ == "__main__":
    main()
