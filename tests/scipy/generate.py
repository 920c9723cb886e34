"""Figures of SciPy that tests compare with: f_tails.csv and f_test.csv.

Arguments: the folder of the repository.
"""

import sys
from pathlib import Path

import numpy as np
from scipy import stats


def tails(path):
    with open(path, "w") as out:
        out.write("f,first,second,tail\n")
        for first in [1, 2, 3, 6, 12]:
            for second in [1, 4, 23.5, 140, 2500, 600000]:
                for f in [0.03, 0.7, 1.9, 6.5, 31.0]:
                    tail = stats.f.sf(f, first, second)
                    if tail > 1e-280:
                        out.write(f"{f},{first},{second},{float(tail)!r}\n")


def f_test(path):
    """Two columns left out of a regression on drawn numbers: sums of squares, F, its tail and the change of AIC and BIC."""
    state = 20261123
    rows = []
    for _ in range(60):
        row = []
        for _ in range(6):
            state = (state * 6364136223846793005 + 1442695040888963407) % 2**64
            row.append((state >> 11) / 2**53 - 0.5)
        rows.append(row)
    table = np.array(rows)
    w = table[:, :5]
    y = w @ np.array([1.0, -2.0, 0.5, 0.4, -0.3]) + 0.5 * table[:, 5]
    with open(path, "w") as out:
        out.write("left_out,f,p_value,aic,bic\n")
        for gone in [[3], [4], [3, 4], [0, 1]]:
            kept = [c for c in range(5) if c not in gone]
            full = np.sum((y - w @ np.linalg.lstsq(w, y, rcond=None)[0]) ** 2)
            less = np.sum((y - w[:, kept] @ np.linalg.lstsq(w[:, kept], y, rcond=None)[0]) ** 2)
            r, n, p = len(gone), 60, 5
            f = (less - full) / r / (full / (n - p))
            gain = n * np.log(less / full)
            names = "+".join(str(c) for c in gone)
            tail = stats.f.sf(f, r, n - p)
            out.write(f"{names},{f:.15e},{tail:.15e},{2 * r - gain:.15e},{r * np.log(n) - gain:.15e}\n")


def main():
    root = Path(sys.argv[1])
    tails(root / "mechanics/src/statistics/f_tails.csv")
    f_test(root / "estimation/src/estimation/selection/f_test.csv")


main()
