"""What every comparison needs: facts of the machine, programs that are timed, sides that take turns."""

import os
import platform
import re
import resource
import subprocess
import time
from pathlib import Path

# One thread on each side.
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "RAYON_NUM_THREADS": "1"}
REPOSITORY = Path(__file__).resolve().parents[2]


def facts():
    """Processor, system and versions, as far as Linux states them."""
    def line(path, key):
        try:
            found = re.search(rf"^{key}\s*:\s*(.+)$", Path(path).read_text(), re.MULTILINE)
        except OSError:
            return None
        return found and found[1]

    def answer(*command):
        try:
            return subprocess.run(command, capture_output=True, text=True, check=True, cwd=REPOSITORY).stdout.strip()
        except (OSError, subprocess.CalledProcessError):
            return None

    flags = (line("/proc/cpuinfo", "flags") or "").split()
    return {
        "processor": line("/proc/cpuinfo", "model name") or platform.processor(),
        "lanes": "AVX-512" if "avx512f" in flags else "AVX2" if "avx2" in flags else platform.machine(),
        "cores": os.cpu_count(),
        "memory": line("/proc/meminfo", "MemTotal"),
        "system": f"{platform.system()} {platform.release()}",
        "python": platform.python_version(),
        "rustc": answer("rustc", "--version"),
        "compiler": (answer("g++", "--version") or "").splitlines()[:1],
        "commit": answer("git", "rev-parse", "--short", "HEAD"),
        "load": os.getloadavg()[0],
    }


def quiet(command, wanted):
    """The command before other work of the machine, on one core, where the machine gives that."""
    if wanted and subprocess.run(["chrt", "--fifo", "10", "true"], capture_output=True).returncode == 0:
        return ["chrt", "--fifo", "10", "taskset", "-c", "0", *command]
    return list(command)


class Program:
    """A program and what it said and took, run by run."""

    def __init__(self, command, alone=False, environment=None):
        self.command, self.environment = quiet([str(part) for part in command], alone), dict(os.environ, **ONE_THREAD, **(environment or {}))
        self.texts, self.seconds = [], []

    def run(self):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        ran = subprocess.run(self.command, capture_output=True, text=True, env=self.environment, cwd=REPOSITORY)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if ran.returncode != 0:
            raise SystemExit(f"{' '.join(self.command)}: status {ran.returncode}\n{ran.stderr[-2000:]}")
        self.texts.append(ran.stdout)
        self.seconds.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
        return ran.stdout

    def least(self, pattern):
        """The least number that the pattern finds in any run's text."""
        found = [float(number) for text in self.texts for number in re.findall(pattern, text)]
        if not found:
            raise SystemExit(f"{' '.join(self.command)}: found no line \"{pattern}\"")
        return min(found)


def in_turn(turns, *sides):
    """Every side once, then every side again: a busy moment of the machine meets them all."""
    for _ in range(turns):
        for side in sides:
            side.run() if isinstance(side, Program) else side()


def processor_time(run):
    began = time.process_time()
    value = run()
    return time.process_time() - began, value
