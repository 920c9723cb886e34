"""armid identifies the dynamic parameters of robot arms from logs of their motion.

>>> import armid
>>> robot = armid.Robot.load("planar-2r")
>>> design = robot.design("d-optimal", starts=1, evaluations=20)
>>> log = robot.simulate(design, periods=4)
>>> estimate = robot.identify(log)
>>> estimate.values.shape == estimate.std.shape
True

Units are SI. Arrays have one row for each sample. Results that need a second look raise an `ArmidWarning`.
"""

from ._armid import __version__
from ._design import Design
from ._errors import ArmidError, ArmidWarning, NotFoundError
from ._estimate import Drawing, Estimate, Finding, Payload, Torque, Validation
from ._log import Log
from ._robot import Base, Robot
from ._study import StudyResult, study

__all__ = [
    "ArmidError",
    "ArmidWarning",
    "Base",
    "Design",
    "Drawing",
    "Estimate",
    "Finding",
    "Log",
    "NotFoundError",
    "Payload",
    "Robot",
    "StudyResult",
    "Torque",
    "Validation",
    "__version__",
    "study",
]
