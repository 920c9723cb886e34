"""What the tests on the URDFs of others share: where the files are, and the command."""

import os
import subprocess
import sys
from pathlib import Path

ARMID = Path(os.environ["ARMID"]).resolve()
SHARE = "cmeel.prefix/share/example-robot-data/robots"
ROBOTS = next(path for path in (Path(entry) / SHARE for entry in sys.path) if path.is_dir())


def armid(*arguments):
    return subprocess.run([ARMID, *map(str, arguments)], capture_output=True, text=True)
