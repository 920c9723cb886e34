#!/usr/bin/env python3
"""Draws docs/concepts/base-parameters.svg from `armid reduce crs-a460 --json`, on standard output. ARMID names the command."""

import json
import os
import subprocess

KINDS = ["m", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Ixz", "Iyy", "Iyz", "Izz"]
MARKS = {
    "identifiable": ('<rect x="-8" y="-8" width="16" height="16" fill="#0072b2"/>', "found alone"),
    "representative": ('<circle r="9" fill="#cc79a7"/>', "gives its name to a sum"),
    "combination": ('<circle r="8" fill="none" stroke="#d55e00" stroke-width="2.5"/>', "is part of sums"),
    "unidentifiable": ('<path d="M-6-6L6 6M6-6L-6 6" stroke="#777" stroke-width="2"/>', "never needs torque"),
}


def main():
    command = [os.environ.get("ARMID", "armid"), "reduce", "crs-a460", "--json"]
    found = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    category = {one["name"]: one["category"] for one in found["parameters"]}
    out = [
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 640 400" font-family="sans-serif" font-size="14" role="img">',
        "<title>Torque shows sums: the ten parameters of each link of the CRS A460</title>",
        '<rect width="640" height="400" fill="white"/>',
        f'<text x="20" y="28" font-size="17" font-weight="bold">Of {len(category)} parameters of links, torque shows {found["rank"]} sums</text>',
    ]
    for k, (mark, words) in enumerate(MARKS.values()):
        x, y = 32 + 300 * (k % 2), 56 + 26 * (k // 2)
        out.append(f'<g transform="translate({x} {y})">{mark}</g><text x="{x + 18}" y="{y + 5}">{words}</text>')
    for column, kind in enumerate(KINDS):
        out.append(f'<text x="{115 + 54 * column}" y="126" text-anchor="middle">{kind}</text>')
    for link in range(1, 7):
        y = 116 + 42 * link
        out.append(f'<text x="20" y="{y + 5}">link {link}</text>')
        for column, kind in enumerate(KINDS):
            out.append(f'<g transform="translate({115 + 54 * column} {y})">{MARKS[category[f"{kind}{link}"]][0]}</g>')
    print("\n".join([*out, "</svg>"]))


if __name__ == "__main__":
    main()
