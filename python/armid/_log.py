"""Logs of positions and efforts."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _armid
from ._arrays import Floats, real, rows, vector
from ._errors import ArmidError

if TYPE_CHECKING:
    from ._robot import Robot

Path = Union[str, "os.PathLike[str]"]


def _gains(values: ArrayLike, name: str, dof: int) -> list[float]:
    """One value for each joint, of one for all or one for each."""
    array = real(values, name)
    if array.shape not in ((), (dof,)):
        raise ArmidError(f"{name} has the shape {array.shape}, expected one number or {dof}, one for each joint")
    return [float(value) for value in np.broadcast_to(array, (dof,))]


class Log:
    """Positions and efforts of the joints of a robot at a constant rate.

    `Log.read` reads a file, `Log.from_arrays` and `Log.from_dataframe` take what is in memory, `Robot.simulate` makes one.

    >>> import armid
    >>> robot = armid.Robot.load("planar-2r")
    >>> log = robot.simulate(robot.design("d-optimal", starts=1, evaluations=20, seed=1), periods=4)
    >>> log.q.shape[1], log.rate
    (2, 1000.0)
    """

    __slots__ = ("_log",)

    def __init__(self, log: _armid.Log) -> None:
        self._log = log

    @classmethod
    def read(
        cls, path: Path | Sequence[Path], map: str | None = None, rate: float | None = None, robot: Robot | None = None
    ) -> Log:
        """Read a log: MCAP, ROS 2 bag, table of any shape, or a TOML file with a [log] table.

        Parameters
        ----------
        path : path or sequence of paths
            The file. Several tables are read side by side where `map` names them as ``file:heading``.
        map : str, optional
            What the columns are and their units: ``"t=time_ms ms, q=pos_[1-6] deg, tau=torque_[1-6]"``.
        rate : float, optional
            Rows per second, Hz, of a table without a column of times.
        robot : Robot, optional
            Whose joints are looked for in joint states.

        Raises
        ------
        NotFoundError
            Where there is no such file.
        ArmidError
            Where it is no log, or not as `map` says.
        """
        paths = [path] if isinstance(path, (str, os.PathLike)) else list(path)
        return cls(_armid.Log.read([os.fspath(one) for one in paths], map, rate, None if robot is None else robot._robot))

    @classmethod
    def from_dataframe(cls, df: Any, map: str | None = None, rate: float | None = None, name: str = "dataframe") -> Log:
        """Make a log of a table of pandas or polars, or of a dictionary of columns.

        Parameters
        ----------
        df : table
            Columns of numbers with names, N rows.
        map, rate : optional
            As those of `Log.read`.
        name : str
            What messages call the log.

        Raises
        ------
        ArmidError
            Where a column holds no numbers, or the columns are not as `map` says.
        """
        names = getattr(df, "columns", None)
        columns = {str(key): vector(df[key], str(key)) for key in (df if names is None else names)}
        lengths = {len(column) for column in columns.values()}
        if len(lengths) != 1:
            raise ArmidError(f"{name} has {len(columns)} columns of {sorted(lengths)} rows, expected columns of one length")
        text = io.StringIO()
        heading = io.StringIO()
        csv.writer(heading, lineterminator="").writerow(columns)
        np.savetxt(text, np.column_stack(list(columns.values())), delimiter=",", header=heading.getvalue(), comments="", fmt="%.17g")
        return cls(_armid.Log.from_table(name, text.getvalue(), map, None if rate is None else float(rate)))

    @classmethod
    def from_arrays(
        cls,
        q: ArrayLike,
        tau: ArrayLike | None = None,
        *,
        current: ArrayLike | None = None,
        q_cmd: ArrayLike | None = None,
        kp: ArrayLike | None = None,
        kd: ArrayLike | None = None,
        delay: float = 0.0,
        unknown: Sequence[str] = (),
        t: ArrayLike | None = None,
        rate: float | None = None,
        qd: ArrayLike | None = None,
        q_link: ArrayLike | None = None,
        joints: Sequence[str] | None = None,
        name: str = "arrays",
    ) -> Log:
        """Make a log of arrays. Gaps, uneven times and rows with NaN are treated as in a file.

        Parameters
        ----------
        q : array (N, n)
            Joint positions, rad (m for a prismatic joint).
        tau, current, q_cmd : array (N, n)
            Joint torques, N·m (N), motor currents, A, or commanded positions, rad (m): exactly one of them.
        kp, kd : float or array (n,)
            Gains of the servos that follow `q_cmd`, N·m/rad (N/m) and N·m·s/rad (N·s/m). They are needed with it, and make torques of it:
            ``kp (q_cmd(t - delay) - q) - kd qd``. A servo at its limit has another torque: make its rows NaN.
        delay : float
            Time after which a command acts, s. A servo that holds each command until the next acts half a row late on average.
        unknown : sequence of names, optional
            Which of these numbers are guesses: ``"delay"``, or ``"kp1"`` or ``"kd1"`` of a joint from one on; and ``"zero1"``, the error of an
            encoder's zero. ``robot.identify(log, "cloe")`` estimates them (`Estimate.servo`), or says why the motion does not show one.
        t : array (N,)
            Time of each row, s; or `rate`.
        rate : float
            Rows per second, Hz.
        qd : array (N, n), optional
            Measured velocities, rad/s (m/s).
        q_link : array (N, n), optional
            Positions behind the transmissions, rad (m).
        joints : sequence of n names, optional
            Joints of the columns; those of the robot in its order by default.
        name : str
            What messages call the log.

        Raises
        ------
        ArmidError
            Where the arrays do not belong together, times do not increase, or fewer than two rows are complete.
        """
        found = {key: value for key, value in {"tau": tau, "current": current, "q_cmd": q_cmd}.items() if value is not None}
        if len(found) != 1:
            raise ArmidError(f"found {' and '.join(found) or 'no efforts'}, expected exactly one of tau=, current= and q_cmd=")
        ((key, efforts),) = found.items()
        if key != "q_cmd" and (kp is not None or kd is not None or delay != 0.0 or unknown):
            raise ArmidError(f"found {key}= with gains of a servo, expected q_cmd= with kp=, kd= and delay=")
        if key == "q_cmd" and (kp is None or kd is None):
            raise ArmidError("found q_cmd= without gains, expected kp= and kd= of its servo, kd=0 where it has no damping")
        given = {"q": q, key: efforts}
        given.update({key: value for key, value in {"qd": qd, "q_link": q_link}.items() if value is not None})
        arrays, single = rows(**given)
        if single:
            raise ArmidError(f"q has the shape {arrays[0].shape[1:]}, expected (N, n)")
        named = dict(zip(given, arrays))
        of_servo = None
        if kp is not None and kd is not None:
            dof = arrays[0].shape[1]
            of_servo = (_gains(kp, "kp", dof), _gains(kd, "kd", dof), float(delay), list(unknown))
        return cls(
            _armid.Log.from_arrays(
                name,
                arrays[0],
                arrays[1],
                "current" if key == "current" else "torque",
                None if t is None else vector(t, "t"),
                None if rate is None else float(rate),
                named.get("qd"),
                named.get("q_link"),
                None if joints is None else list(joints),
                of_servo,
            )
        )

    @property
    def name(self) -> str:
        """What messages call it: its file."""
        return self._log.name

    @property
    def joints(self) -> list[str] | None:
        """Names of the joints, where the log has them."""
        return self._log.joints

    @property
    def rate(self) -> float:
        """Samples per second, Hz."""
        return self._log.rate_hz

    @property
    def t(self) -> Floats:
        """Time of each sample, s, (N,)."""
        return self._log.t

    @property
    def q(self) -> Floats:
        """Positions, rad (m), (N, n)."""
        return self._log.q

    @property
    def effort(self) -> Floats:
        """Torques, N·m (N), or motor currents, A, (N, n)."""
        return self._log.effort

    @property
    def effort_kind(self) -> str | None:
        """"torque" or "current"; None where the log does not say it."""
        return self._log.effort_name

    @property
    def remarks(self) -> list[str]:
        """What was found in the log, a sentence each: gaps, uneven times, faulty channels."""
        return self._log.remarks

    @property
    def robot(self) -> Robot | None:
        """The robot that the log contains or names; None where it does neither."""
        from ._robot import Robot

        found = self._log.robot
        return None if found is None else Robot(found)

    def __repr__(self) -> str:
        samples, dof = self.q.shape
        return f"<armid.Log {self.name!r}: {samples} samples of {dof} joints at {self.rate:g} Hz>"
