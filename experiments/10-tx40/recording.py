"""The recording of the TX40, whole or in parts, and `armid identify` on it."""
import json
import os
import pathlib
import resource
import subprocess

RATE_HZ = 5000
# The arm moves up to here, s, and then stands for most of what is left.
MOVES_UNTIL = 7.2
FILES = ("pos_read_data.csv", "curr_data.csv")
LOG = """
[log]
files = ["{0}/pos_read_data.csv", "{0}/curr_data.csv"]
robot = "staubli-tx40"
rate_hz = 5000
q = "pos_read_data:#[1-6] motor gear=32/32/45/-48/45/32"
tau = "curr_data:#[1-6] motor gear=32/32/45/-48/45/32"
"""
OPTIONS = ["--cutoff-hz", "50", "--onset-speed", "stated"]


def whole(folder, work):
    """The log of the whole recording."""
    log = pathlib.Path(work) / "log.toml"
    log.write_text(LOG.format(folder))
    return log


def part(folder, work, begin, end):
    """A log of its own of the time from `begin` to `end`, s."""
    place = pathlib.Path(work) / f"{begin:g}-{end:g}"
    place.mkdir(exist_ok=True)
    for name in FILES:
        head, *rows = (folder / name).read_text().splitlines()
        (place / name).write_text("\n".join([head, *rows[round(RATE_HZ * begin):round(RATE_HZ * end)]]) + "\n")
    log = place / "log.toml"
    log.write_text(LOG.format(place))
    return log


def processor_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def identified(*arguments):
    """The answer, or None, and seconds of processor time, or why there is no answer."""
    begin = processor_seconds()
    armid = str(pathlib.Path(os.environ["ARMID"]).resolve())
    done = subprocess.run([armid, "identify", *map(str, arguments), "--json", *OPTIONS], capture_output=True, text=True)
    if done.returncode not in (0, 1):
        return None, " ".join(done.stderr.split()) if done.stderr.strip() else f"exit {done.returncode}"
    return json.loads(done.stdout), processor_seconds() - begin


def total(estimate, of, rows="used_rows"):
    return "–" if estimate is None else f"{100 * estimate[of][rows]['total']:.2f} %"
