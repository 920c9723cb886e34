"""Designs of excitation trajectories."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from ._arrays import Floats

if TYPE_CHECKING:
    from ._log import Path
    from ._robot import Robot


class Design:
    """A periodic trajectory that excites the parameters of a robot, with the certificate of its limits.

    >>> import armid
    >>> design = armid.Robot.load("planar-2r").design("d-optimal", starts=1, evaluations=20, baseline=False)
    >>> t, q, qd, qdd = design.sample(100)
    >>> design.period, len(t), q.shape
    (10.0, 1000, (1000, 2))
    """

    def __init__(self, toml: str, data: str, robot: Robot) -> None:
        self._toml = toml
        self._text = data
        self._data: dict[str, Any] = json.loads(data)
        self.robot = robot

    @property
    def data(self) -> dict[str, Any]:
        """Everything that the command says of it."""
        return json.loads(self._text)  # type: ignore[no-any-return]

    @property
    def criterion(self) -> str:
        """Name of the criterion."""
        return str(self._data["criterion"])

    @property
    def value(self) -> float:
        """Value of the criterion."""
        return float(self._data["value"])

    @property
    def is_feasible(self) -> bool:
        """Whether it holds all limits, between samples too."""
        return self._data["violation"] is None

    @property
    def period(self) -> float:
        """Period, s."""
        return float(self._data["trajectory"]["period_s"])

    def to_toml(self) -> str:
        """The text of its file, with the certificate."""
        return self._toml

    def write(self, path: Path) -> None:
        """Write its file, which the command reads."""
        with open(path, "w", encoding="utf-8") as file:
            file.write(self._toml)

    def sample(self, rate: float) -> tuple[Floats, Floats, Floats, Floats]:
        """Set-points of one period.

        Parameters
        ----------
        rate : float
            Samples per second, Hz; a period must hold a whole number of them.

        Returns
        -------
        t : array (N,)
            Time, s.
        q, qd, qdd : array (N, n)
            Position, velocity, acceleration: rad, rad/s, rad/s² (m for a prismatic joint).
        """
        return self.robot.sample(self, rate)

    def to_csv(self, path: Path, rate: float) -> None:
        """Write the set-points of one period as a table with the columns t, q1, …, qd1, …, qdd1, …"""
        t, q, qd, qdd = self.sample(rate)
        names = [f"{name}{joint + 1}" for name in ("q", "qd", "qdd") for joint in range(q.shape[1])]
        table = np.column_stack([t, q, qd, qdd])
        np.savetxt(path, table, fmt="%.17g", delimiter=",", header=",".join(["t", *names]), comments="")

    def __repr__(self) -> str:
        limits = "inside all limits" if self.is_feasible else "outside of a limit"
        return f"<armid.Design for {self._data['robot']!r}: {self.criterion} {self.value:.6g}, {limits}>"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Design) and self._toml == other._toml

    def __hash__(self) -> int:
        return hash(self._toml)

    def __reduce__(self) -> tuple[Any, ...]:
        return Design, (self._toml, self._text, self.robot)
