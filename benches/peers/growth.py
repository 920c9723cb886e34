#!/usr/bin/env python3
"""How cost grows with joints, samples, harmonics, runs and threads: one page with figures.

    python3 benches/peers/growth.py            writes benches/growth/: README.md, figures, growth.json

Needs no library. The benchmark `growth` measures one core; studies of Table I's trajectory are timed as processes, with one thread
and with two. The words of the page are in `growth_words.md` next to this script.
"""

import argparse
import json
import math
import os
import re
import subprocess
import tempfile
import time
from pathlib import Path

from figure import chart
from machine import REPOSITORY, Program, facts

HERE = Path(__file__).parent
# File, title, axes, power of the thin line; the unit's size in seconds.
FIGURES = {
    "joints": ("One evaluation against joints", "joints", "µs", 1, 1e-6),
    "reduction": ("Base reduction against joints", "joints", "s", 3, 1.0),
    "samples": ("Identification against samples", "samples", "ms", 1, 1e-3),
    "harmonics": ("Design of six joints against harmonics, 100 evaluations", "harmonics of each joint", "s", 1, 1.0),
    "design-joints": ("Design of five harmonics against joints, 100 evaluations", "joints", "s", 2, 1.0),
    "runs": ("A study against runs, one thread", "runs", "s", 1, 1.0),
    "memory": ("Most memory of a study against runs, one thread", "runs", "MB", None, 1.0),
    "threads": ("A study of 128 runs against threads", "threads", "s", None, 1.0),
}


def built():
    found = {}
    for arguments in (["bench", "--no-run", "-p", "armid", "--bench", "growth"], ["build", "--release", "--bin", "armid"]):
        ran = subprocess.run(["cargo", *arguments, "--locked", "--message-format", "json"], cwd=REPOSITORY, stdout=subprocess.PIPE,
                             text=True, check=True)
        messages = map(json.loads, ran.stdout.splitlines())
        found |= {message["target"]["name"]: message["executable"] for message in messages if message.get("executable")}
    return found


def study(armid, folder, runs, jobs):
    """Wall-clock seconds, processor seconds and most memory (MB) of a study of Table I's trajectory."""
    text = (REPOSITORY / "experiments/01-criteria/study.toml").read_text()
    path = Path(folder) / "study.toml"
    path.write_text(text[: text.index("[[design]]")] + re.sub(r"(?m)^runs = .*$", "", text[text.rindex("[[design]]") :]))
    command = [armid, "study", path, "--runs", str(runs), "--jobs", str(jobs), "--quiet", "-o", Path(folder) / f"{runs}-{jobs}"]
    began = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    if status != 0:
        raise SystemExit(f"{command}: status {status}")
    return time.perf_counter() - began, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def measured(turns):
    programs, found = built(), {}
    bench = Program([programs["growth"]], alone=False)
    for _ in range(turns):
        for line in bench.run().splitlines():
            figure, series, size, seconds = line.split("\t")
            points = found.setdefault(figure, {}).setdefault(series, {})
            points[int(size)] = min(float(seconds), points.get(int(size), math.inf))
    with tempfile.TemporaryDirectory() as folder:
        for runs in (8, 32, 128, 512, 2048):
            _, processor, memory = study(programs["armid"], folder, runs, 1)
            found.setdefault("runs", {}).setdefault("processor time", {})[runs] = processor
            found.setdefault("memory", {}).setdefault("resident", {})[runs] = memory
        for jobs in range(1, (os.cpu_count() or 1) + 1):
            wall, processor, _ = study(programs["armid"], folder, 128, jobs)
            found.setdefault("threads", {}).setdefault("by the clock", {})[jobs] = wall
            found["threads"].setdefault("processor time", {})[jobs] = processor
    return found


def power(points):
    """Of the growth from the middle of the sizes to the largest."""
    sizes = sorted(points)
    a, b = sizes[len(sizes) // 2], sizes[-1]
    return math.log(points[b] / points[a]) / math.log(b / a) if b > a else math.nan


def finding(title, unit, slope, lines):
    """The title of a figure: how its fastest line grows, or where it begins and ends."""
    if slope is not None:
        return f"{title}: grows with power {max(power(dict(points)) for points in lines.values()):.1f} at most"
    points = next(iter(lines.values()))
    return f"{title}: {points[0][1]:.3g} to {points[-1][1]:.3g} {unit}"


def page(found, machine):
    out = ["# How cost grows", "", "Cost grows about linearly with samples and runs, and with at most about the third power of the joints.", "",
           "`python3 benches/peers/growth.py` measures everything here and writes this page. Figures are for one core if nothing else is said.",
           "Chains of more or fewer joints are random, with columns of links, rotors and friction. Other figures are for six joints.", "",
           "| machine | |", "|---|---|", *(f"| {key} | {value if not isinstance(value, list) else ', '.join(value)} |" for key, value in machine.items()), ""]
    words = dict(part.split("\n", 1) for part in (HERE / "growth_words.md").read_text().split("\n## ")[1:])
    for name, (title, x, unit, slope, scale) in FIGURES.items():
        out += [f"## {title}", "", f"![{title}]({name}.svg)", ""]
        lines = found[name]
        sizes = sorted({size for points in lines.values() for size in points})
        last = [] if slope is None else ["power"]
        out += [f"| {' | '.join([x, *map(str, sizes), *last])} |", "|---" * (len(sizes) + 1 + len(last)) + "|"]
        for series, points in lines.items():
            cells = [f"{points[size] / scale:.3g}" if size in points else "" for size in sizes]
            last = [] if slope is None else [f"{power(points):.1f}"]
            out.append(f"| {' | '.join([f'{series}, {unit}', *cells, *last])} |")
        out += ["", words[name].strip(), ""]
    return "\n".join(out)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--turns", type=int, default=2, help="repeats of the benchmark")
    parser.add_argument("--again", action="store_true", help="write page and figures from growth.json")
    arguments = parser.parse_args()
    folder = REPOSITORY / "benches" / "growth"
    folder.mkdir(exist_ok=True)
    stored = folder / "growth.json"
    if not arguments.again:
        stored.write_text(json.dumps({"machine": facts(), "figures": measured(arguments.turns)}, indent=1) + "\n")
    read = json.loads(stored.read_text())
    found = {name: {series: {int(size): value for size, value in points.items()} for series, points in lines.items()}
             for name, lines in read["figures"].items()}
    for name, (title, x, unit, slope, scale) in FIGURES.items():
        lines = {series: [(size, value / scale) for size, value in sorted(points.items())] for series, points in found[name].items()}
        (folder / f"{name}.svg").write_text(chart(finding(title, unit, slope, lines), x, unit, lines, slope))
    (folder / "README.md").write_text(page(found, read["machine"]))


if __name__ == "__main__":
    main()
