#!/usr/bin/env python3
"""Is the advice right? Advice on robots of other makers, and then the experiment with every candidate on an arm that no study has seen.

    ARMID=target/release/armid target/python/bin/python tests/python/study_of_advice.py ROBOTS RESULTS [--robots N] [--hours H]

ROBOTS is the folder `robots` of example-robot-data. Robot k is chain k of the list below; beyond its end the list begins again with other
draws. Its advice is that of `armid advise`, from its URDF alone. The arm itself is one more draw around the URDF: the same seed gives the same
designs, and draws beyond those of the advice are arms that it has not seen. Each effect of its drives has a level of its own, drawn evenly
between none and twice the realistic one. Every third arm is outside of what the advice assumes: its bodies and friction are spread twice as
wide, its levels reach four, and it has one effect that its drives are not said to have. `armid study` performs every candidate on it once.

RESULTS/advice.json gets an entry for each robot; robots that have one are not performed again. The Python needs pyarrow.
"""
import argparse
import json
import os
import random
import re
import shutil
import subprocess
import time
import tomllib
from pathlib import Path

import pyarrow.parquet

ARMID = os.environ.get("ARMID", "armid")
# Arms that the advice draws; the next one is new.
ADVISED = 6
# Levels of effects, in parts of the realistic ones, inside and outside of what advice assumes.
LEVELS = {False: 2.0, True: 4.0}
# Spreads outside of what advice assumes, twice its own.
WIDE = {"mass_spread": 0.4, "inertia_spread": 0.3, "rotor_spread": 0.6, "friction_spread": 0.6}
# An effect that no drive of the list below is said to have.
SURPRISES = {"direction-friction": 0.2, "position-friction": 0.1, "tool": 0.05, "transmission-error": 0.15, "clock-jitter": 20.0}
# URDF, first and last link, kind of drive: the smallest first, so that a few hours say something.
CHAINS = [
    ("asr_twodof_description/urdf/TwoDofs.urdf", None, None, "direct"),
    ("solo_description/robots/solo12.urdf", "base_link", "FL_FOOT", "direct"),
    ("finger_edu_description/robots/finger_edu.urdf", None, None, "belt"),
    ("a1_description/urdf/a1.urdf", "base", "FR_foot", "planetary"),
    ("go2_description/urdf/go2.urdf", "base", "FL_foot", "planetary"),
    ("hyq_description/robots/hyq_no_sensors.urdf", "base_link", "lf_foot", "planetary"),
    ("anymal_b_simple_description/robots/anymal.urdf", "base", "LF_FOOT", "harmonic"),
    ("laikago_description/urdf/laikago.urdf", "trunk", "FR_foot", "planetary"),
    ("bolt_description/robots/bolt.urdf", "base_link", "FL_FOOT", "belt"),
    ("allegro_hand_description/urdf/allegro_right_hand.urdf", "palm_link", "link_3.0_tip", "servo"),
    ("so_arm_description/urdf/so100.urdf", None, None, "servo"),
    ("hextilt_description/urdf/hextilt_flying_arm_5.urdf", None, None, "servo"),
    ("ur_description/urdf/ur3_robot.urdf", "base_link", "ee_link", "harmonic"),
    ("ur_description/urdf/ur5_robot.urdf", "base_link", "ee_link", "harmonic"),
    ("ur_description/urdf/ur10_robot.urdf", "base_link", "ee_link", "harmonic"),
    ("kinova_description/robots/kinova.urdf", "base", "j2s6s200_end_effector", "harmonic"),
    ("z1_description/urdf/z1.urdf", None, "link06", "planetary"),
    ("talos_data/robots/talos_left_arm.urdf", "arm_left_1_link", None, "harmonic"),
    ("panda_description/urdf/panda.urdf", "panda_link0", "panda_link7", "harmonic"),
    ("xarm_description/urdf/xarm7.urdf", None, "link7", "harmonic"),
]


def armid(*words):
    done = subprocess.run([ARMID, *map(str, words), "--quiet"], capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1):
        raise RuntimeError(done.stderr.strip())
    return done.stdout


def drawn(plan, outside, draw):
    """Effects of the arm: those of its drives, and outside of the advice one more."""
    quarter = next(effects for effects in plan["conditions"] if effects and not any(isinstance(size, str) for size in effects.values()))
    effects = {name: 4.0 * size * draw.uniform(0.0, LEVELS[outside]) for name, size in quarter.items()}
    if outside:
        name = draw.choice([name for name in SURPRISES if name not in effects])
        effects[name] = SURPRISES[name] * draw.uniform(0.5, 2.0)
    return effects


def changed(text, effects, outside):
    """The plan of one experiment with every candidate: one condition, and the runs of the advice with one more."""
    text, count = text.split("\n[[conditions]]")[0], ADVISED + 1
    text = re.sub(r"condition_names = \[.*?\]", 'condition_names = ["arm"]', text, flags=re.S)
    text = re.sub(rf"(?m)^(runs|count) = {ADVISED}$", rf"\1 = {count}", text)
    if outside:
        text = re.sub(r"(?m)^(\w+_spread) = .*$", lambda found: f"{found[1]} = {WIDE[found[1]]}", text)
    return f"{text}\n[[conditions]]\n" + "".join(f"{name} = {size!r}\n" for name, size in effects.items())


def chosen(summary):
    """The place of the better start of each family."""
    starts = {}
    for place, design in enumerate(summary["designs"]):
        value = design["history"][-1]["value"]
        name = summary["plan"]["design"][design["family"]]["name"]
        starts[name] = min(starts.get(name, (value, place)), (value, place))
    return {name: place for name, (_, place) in starts.items()}


def performed(robots, folder, number):
    """Advice on robot `number`, and the error of each candidate on the new arm."""
    urdf, base, tip, drive = CHAINS[number % len(CHAINS)]
    draw, outside = random.Random(number), number % 3 == 2
    ends = [*(["--base-link", base] if base else []), *(["--tip-link", tip] if tip else [])]
    advice = folder / "advice"
    begin = time.time()
    said = json.loads(armid("advise", robots / urdf, *ends, "--drive", drive, "--arms", ADVISED, "--seed", 1 + number, "-o", advice, "--json"))
    seconds = time.time() - begin
    text = (advice / "study.toml").read_text()
    effects = drawn(tomllib.loads(text), outside, draw)
    (advice / "arm.toml").write_text(changed(text, effects, outside))
    armid("study", advice / "arm.toml", "-o", folder / "arm")
    summary, before = (json.loads((of / "summary.json").read_text()) for of in (folder / "arm", advice))
    if [one["trajectory"] for one in summary["designs"]] != [one["trajectory"] for one in before["designs"]]:
        raise RuntimeError("the arm was to perform other motions than those of the advice")
    starts = set(chosen(summary).values())
    rows = pyarrow.parquet.read_table(folder / "arm/runs.parquet").to_pylist()
    errors = {(row["family"], row["estimator"]): row["measured_rmse_nm"] for row in rows if row["run"] == ADVISED and row["design"] in starts}
    candidates = [{"name": [one["design"], one["estimator"]], "error": errors.get((one["design"], one["estimator"])),
                   "expected": one["expected"], "low": one["error"]["low"], "high": one["error"]["high"]} for one in said["candidates"]]
    return {"urdf": Path(urdf).stem, "drive": drive, "outside": outside, "effects": effects, "seconds": round(seconds, 1), "candidates": candidates}


def summed_up(entries):
    """How often intervals hold, and how near the advice is to the best candidate in hindsight."""
    found = []
    for entry in entries:
        candidates = [one for one in entry["candidates"] if one["error"] is not None]
        advised, best = entry["candidates"][0], min(one["error"] for one in candidates)
        # Advice that gives no estimate is wrong.
        error = float("inf") if advised["error"] is None else advised["error"]
        holds = [one["low"] <= one["error"] <= one["high"] for one in candidates]
        found.append({"urdf": entry["urdf"], "outside": entry["outside"], "holds": advised["low"] <= error <= advised["high"],
                      "over_expected": error / advised["expected"], "of_all": sum(holds) / len(holds),
                      "over_best": error / best, "worst": max(one["error"] for one in candidates) / best})
    def share(of, test):
        return [sum(map(test, of)), len(of)]
    groups = {"all": found, "inside": [one for one in found if not one["outside"]], "outside": [one for one in found if one["outside"]]}
    counts = {name: {"holds": share(of, lambda one: one["holds"]), "near_best": share(of, lambda one: one["over_best"] <= 1.1)} for name, of in groups.items()}
    return {"counts": counts, "robots": found}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("robots", type=Path)
    parser.add_argument("results", type=Path)
    parser.add_argument("--robots", type=int, default=20, dest="count")
    parser.add_argument("--hours", type=float, default=24.0, help="no robot is begun later")
    asked = parser.parse_args()
    asked.results.mkdir(parents=True, exist_ok=True)
    path, begin = asked.results / "advice.json", time.time()
    kept = json.loads(path.read_text()) if path.exists() else {"entries": {}, "failed": {}}
    for number in range(asked.count):
        if str(number) in kept["entries"] or time.time() - begin > 3600.0 * asked.hours:
            continue
        folder = asked.results / f"robot-{number}"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        try:
            kept["entries"][str(number)] = performed(asked.robots.resolve(), folder, number)
            kept["failed"].pop(str(number), None)
        except RuntimeError as fault:
            kept["failed"][str(number)] = [CHAINS[number % len(CHAINS)][0], str(fault)]
        kept.update(summed_up(kept["entries"].values()))
        path.write_text(json.dumps(kept, indent=1))
        print(number, json.dumps(kept["counts"]["all"]), kept["failed"].get(str(number), ""), flush=True)


if __name__ == "__main__":
    main()
