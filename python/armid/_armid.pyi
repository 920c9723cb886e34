from collections.abc import Callable, Mapping, Sequence
from typing import Any, final

from ._arrays import Floats

__all__ = [
    "Log",
    "Robot",
    "__version__",
    "design",
    "draw",
    "export",
    "forward_dynamics",
    "gram",
    "identify",
    "inverse_dynamics",
    "is_table",
    "mass_matrix",
    "payload",
    "predict",
    "reduce",
    "regressor",
    "report",
    "sample",
    "simulate",
    "student",
    "study",
    "torque",
    "validate",
    "write_mcap",
]

__version__: str

_Progress = Callable[[int, int, str], object] | None

@final
class Robot:
    @staticmethod
    def load(name: str, base_link: str | None = None, tip_link: str | None = None) -> Robot: ...
    @property
    def name(self) -> str: ...
    @property
    def joints(self) -> list[str]: ...
    @property
    def remarks(self) -> list[str]: ...
    @property
    def source(self) -> tuple[str | None, str | None, str | None]: ...
    def parameters(self, columns: str) -> list[tuple[str, str]]: ...
    def nominal(self, columns: str) -> Floats: ...

@final
class Log:
    @staticmethod
    def read(paths: Sequence[str], mapping: str | None, rate_hz: float | None, robot: Robot | None) -> Log: ...
    @staticmethod
    def from_table(name: str, text: str, mapping: str | None, rate_hz: float | None) -> Log: ...
    @staticmethod
    def from_arrays(
        name: str,
        q: Floats,
        efforts: Floats,
        effort_name: str | None,
        t: Floats | None,
        rate_hz: float | None,
        qd: Floats | None,
        link_q: Floats | None,
        joints: Sequence[str] | None,
        servo: tuple[Sequence[float], Sequence[float], float, Sequence[str]] | None,
    ) -> Log: ...
    @property
    def robot(self) -> Robot | None: ...
    @property
    def name(self) -> str: ...
    @property
    def joints(self) -> list[str] | None: ...
    @property
    def rate_hz(self) -> float: ...
    @property
    def effort_name(self) -> str | None: ...
    @property
    def remarks(self) -> list[str]: ...
    @property
    def t(self) -> Floats: ...
    @property
    def q(self) -> Floats: ...
    @property
    def effort(self) -> Floats: ...

def regressor(robot: Robot, samples: Sequence[Floats], columns: str, out: Floats) -> None: ...
def gram(
    robot: Robot, samples: Sequence[Floats], weights: Floats | None, columns: str, information: Floats, moment: Floats
) -> None: ...
def inverse_dynamics(robot: Robot, samples: Sequence[Floats], columns: str, given: Floats | None, out: Floats) -> None: ...
def forward_dynamics(robot: Robot, samples: Sequence[Floats], columns: str, given: Floats | None, out: Floats) -> None: ...
def mass_matrix(robot: Robot, q: Floats, columns: str, given: Floats | None, out: Floats) -> None: ...
def reduce(
    robot: Robot, columns: str, trajectory: str | None, method: str | None, seed: int
) -> tuple[str, Floats]: ...
def identify(
    robot: Robot,
    logs: Sequence[Log],
    others: Sequence[Log],
    reading: Mapping[str, Any],
    wanted: Mapping[str, Any],
    progress: _Progress,
) -> list[tuple[str, str | None]]: ...
def is_table(path: str) -> bool: ...
def predict(robot: Robot, file: tuple[str, str], samples: Sequence[Floats], out: Floats) -> None: ...
def validate(
    robot: Robot,
    file: tuple[str, str],
    logs: Sequence[Log],
    limit: float,
    part_s: tuple[float | None, float | None],
) -> str: ...
def export(
    robot: Robot,
    file: tuple[str, str],
    logs: tuple[list[Log], list[Log]],
    to: str,
    into: str | None,
    path: str | None,
    progress: _Progress,
) -> tuple[str, str, str | None]: ...
def report(robot: Robot, file: tuple[str, str], logs: tuple[list[Log], list[Log]], folder: str) -> str: ...
def torque(
    robot: Robot, file: tuple[str, str], logs: tuple[list[Log], list[Log]]
) -> tuple[bool, float, Sequence[Floats]]: ...
def draw(robot: Robot, file: tuple[str, str], logs: tuple[list[Log], list[Log]]) -> str: ...
def write_mcap(
    robot: Robot, file: tuple[str, str], logs: tuple[list[Log], list[Log]], path: str
) -> None: ...
def payload(
    robot: Robot, without: tuple[str, str] | list[Log], with_: tuple[str, str] | list[Log], progress: _Progress
) -> str: ...
def student(level: float, degrees_of_freedom: float) -> float: ...
def design(robot: Robot, asked: Mapping[str, Any], progress: _Progress) -> tuple[str, str]: ...
def sample(
    robot: Robot, motion: Mapping[str, str | None], rate_hz: float
) -> tuple[Floats, Sequence[Floats]]: ...
def simulate(
    robot: Robot, motion: Mapping[str, str | None], experiment: Mapping[str, Any], progress: _Progress
) -> tuple[Log, str | None]: ...
def study(
    plan: str,
    output: str,
    resume: bool,
    threads: int,
    until: str | None,
    estimators: Sequence[tuple[str, Callable[..., Any]]],
    criteria: Sequence[tuple[str, Callable[..., Any]]],
    progress: _Progress,
) -> tuple[str, str | None]: ...
