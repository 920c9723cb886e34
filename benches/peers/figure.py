"""Line charts on logarithmic axes as SVG: axes with units, a grid of decades, a legend."""

import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
from figure_frame import framed  # noqa: E402

WIDTH, HEIGHT = 560, 360
LEFT, RIGHT, TOP, BOTTOM = 70, 190, 20, 50
# Colours that are told apart without red and green (Okabe and Ito), and dashes for who sees no colour.
STYLES = [("#0072b2", ""), ("#d55e00", "6 3"), ("#009e73", "2 3"), ("#cc79a7", "8 3 2 3"), ("#56b4e9", "1 2"), ("#e69f00", "10 4")]


def ticks(low, high):
    """Decades, and where they are few 2 and 5 of each."""
    first, last = math.floor(math.log10(low)), math.ceil(math.log10(high))
    steps = (1,) if last - first > 3 else (1, 2, 5)
    return [s * 10.0**e for e in range(first, last + 1) for s in steps if low * 0.999 <= s * 10.0**e <= high * 1.001]


def label(value):
    if 1e-3 < value < 1e4:
        return f"{value:g}"
    exponent = math.floor(math.log10(value) + 1e-9)
    digits = str(exponent).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    factor = round(value / 10.0**exponent)
    return f"10{digits}" if factor == 1 else f"{factor}·10{digits}"


def chart(title, x_label, y_label, series, slope=None):
    """`series`: name → points (x, y). `slope`: a thin line of growth by this power, from the first point of the first series."""
    points = [point for line in series.values() for point in line]
    xs, ys = [x for x, _ in points], [y for _, y in points]
    x0, x1, y0, y1 = min(xs), max(xs), min(ys) / 1.3, max(ys) * 1.3
    across = lambda x: LEFT + (WIDTH - LEFT - RIGHT) * math.log(x / x0) / math.log(x1 / x0)
    up = lambda y: HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * math.log(y / y0) / math.log(y1 / y0)
    out = []
    for x in ticks(x0, x1):
        out.append(f'<path d="M{across(x):.1f} {TOP}V{HEIGHT - BOTTOM}" stroke="#ddd"/>'
                   f'<text x="{across(x):.1f}" y="{HEIGHT - BOTTOM + 16}" text-anchor="middle">{label(x)}</text>')
    for y in ticks(y0, y1):
        out.append(f'<path d="M{LEFT} {up(y):.1f}H{WIDTH - RIGHT}" stroke="#ddd"/>'
                   f'<text x="{LEFT - 6}" y="{up(y) + 4:.1f}" text-anchor="end">{label(y)}</text>')
    out.append(f'<path d="M{LEFT} {TOP}V{HEIGHT - BOTTOM}H{WIDTH - RIGHT}" fill="none" stroke="black"/>')
    out.append(f'<text x="{(LEFT + WIDTH - RIGHT) / 2}" y="{HEIGHT - 12}" text-anchor="middle">{x_label}</text>')
    out.append(f'<text transform="translate(16 {(TOP + HEIGHT - BOTTOM) / 2}) rotate(-90)" text-anchor="middle">{y_label}</text>')
    for number, (name, line) in enumerate(series.items()):
        colour, dash = STYLES[number % len(STYLES)]
        path = "M" + "L".join(f"{across(x):.1f} {up(y):.1f}" for x, y in line)
        out.append(f'<path d="{path}" fill="none" stroke="{colour}" stroke-width="2" stroke-dasharray="{dash}"/>')
        out += [f'<circle cx="{across(x):.1f}" cy="{up(y):.1f}" r="2.5" fill="{colour}"/>' for x, y in line]
        y = TOP + 12 + 18 * number
        out.append(f'<path d="M{WIDTH - RIGHT + 12} {y}h24" stroke="{colour}" stroke-width="2" stroke-dasharray="{dash}"/>'
                   f'<text x="{WIDTH - RIGHT + 42}" y="{y + 4}">{name}</text>')
    if slope is not None:
        (x, y) = next(iter(series.values()))[0]
        end = min(x1, x * (y1 / y) ** (1 / slope))
        out.append(f'<path d="M{across(x):.1f} {up(y):.1f}L{across(end):.1f} {up(y * (end / x) ** slope):.1f}" stroke="#777"/>')
        y = TOP + 12 + 18 * len(series)
        out.append(f'<path d="M{WIDTH - RIGHT + 12} {y}h24" stroke="#777"/><text x="{WIDTH - RIGHT + 42}" y="{y + 4}">'
                   f'{"linear" if slope == 1 else f"power {slope}"}</text>')
    return framed(WIDTH, HEIGHT, title, out)
