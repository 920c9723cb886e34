"""What an identification gives."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from html import escape
from typing import TYPE_CHECKING, Any, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike

from . import _armid
from ._arrays import Floats, output, rows
from ._errors import ArmidError, warn

if TYPE_CHECKING:
    import pandas
    import polars
    from matplotlib.axes import Axes

    from ._log import Log, Path
    from ._robot import Logs, Robot
    from ._study import Progress


@dataclass(frozen=True)
class Finding:
    """Something that a reader of an estimate should notice: a sentence, what to do about it, and its numbers."""

    text: str
    advice: str
    numbers: dict[str, Any] = field(repr=False, default_factory=dict)

    @classmethod
    def _of(cls, data: dict[str, Any]) -> Finding:
        numbers = {key: value for key, value in data.items() if key not in ("text", "advice")}
        return cls(data["text"], data["advice"], numbers)


class Torque(NamedTuple):
    """Torque of N samples of n joints, measured and predicted."""

    t: Floats
    measured: Floats
    predicted: Floats
    is_held_out: bool


class Drawing(str):
    """An SVG, which notebooks show."""

    __slots__ = ()

    def _repr_svg_(self) -> str:
        return str(self)

    def write(self, path: Path) -> None:
        """Write it to a file."""
        with open(path, "w", encoding="utf-8") as file:
            file.write(self)


class Estimate:
    """Base parameters of a robot with their uncertainty: what the command's E.json holds.

    Two estimates are equal where their files are. An estimate is pickled as its file, without logs that were arrays.

    >>> import armid, numpy as np, pickle, warnings
    >>> warnings.simplefilter("ignore", armid.ArmidWarning)
    >>> robot = armid.Robot.load("planar-2r")
    >>> design = robot.design("d-optimal", starts=1, evaluations=20, baseline=False)
    >>> log = robot.simulate(design, periods=4)
    >>> estimate = robot.identify(log)
    >>> b = len(estimate.names)
    >>> estimate.values.shape == estimate.std.shape == (b,) and estimate.covariance.shape == (b, b)
    True
    >>> estimate.names[0], estimate.units[0], estimate.expressions[0][:5]
    ('m1', 'kg', 'm1 − ')
    >>> bool((estimate.interval(0.99)[:, 0] < estimate.interval()[:, 0]).all())
    True
    >>> estimate.predict(np.zeros(2), np.zeros(2), np.zeros(2)).shape
    (2,)
    >>> t, measured, predicted, is_held_out = estimate.torque()
    >>> measured.shape == predicted.shape == (len(t), 2)
    True
    >>> estimate.plot().startswith("<svg")
    True
    >>> list(estimate.to_pandas().columns)
    ['value', 'std', 'low', 'high', 'unit', 'expression']
    >>> estimate.export("urdf").startswith("<?xml")
    True
    >>> estimate.validate(robot.simulate(design, periods=4, run=1)).passed
    True
    >>> pickle.loads(pickle.dumps(estimate)) == estimate
    True
    """

    def __init__(self, text: str, robot: Robot | None = None) -> None:
        try:
            data = json.loads(text)
            self._base: list[dict[str, Any]] = data["base"]
        except (ValueError, KeyError, TypeError) as error:
            raise ArmidError(f"the text is not an estimate: {error!r}") from None
        self._text = text
        self._data: dict[str, Any] = data
        self._robot = robot
        self._name = "the estimate"
        # The logs of the fit and those that were held out, while they are in memory.
        self._logs: tuple[list[_armid.Log], list[_armid.Log]] = ([], [])

    @classmethod
    def read(cls, path: Path, robot: Robot | None = None) -> Estimate:
        """Read the file of an estimate, E.json.

        Parameters
        ----------
        path : path
            The file.
        robot : Robot, optional
            Its robot, where that is no longer where the file says.
        """
        from ._errors import NotFoundError

        try:
            with open(path, encoding="utf-8") as file:
                estimate = cls(file.read(), robot)
        except FileNotFoundError:
            raise NotFoundError(f"{os.fspath(path)} cannot be read: there is no such file") from None
        estimate._name = os.fspath(path)
        return estimate

    def to_json(self) -> str:
        """The text of its file."""
        return self._text

    def write(self, path: Path) -> None:
        """Write its file, which the command reads."""
        with open(path, "w", encoding="utf-8") as file:
            file.write(self._text)

    @property
    def data(self) -> dict[str, Any]:
        """Everything in its file."""
        return json.loads(self._text)  # type: ignore[no-any-return]

    @property
    def robot(self) -> Robot:
        """Its robot."""
        if self._robot is None:
            from ._robot import Robot

            source = (self._data.get("inputs") or {}).get("robot") or {}
            if not source.get("name"):
                raise ArmidError("the estimate does not say where its robot is, expected robot=")
            self._robot = Robot.load(self._beside(source["name"]), source["base_link"], source["tip_link"])
        return self._robot

    def _beside(self, name: str) -> str:
        """A path that leads nowhere from the current folder is looked for in that of the estimate, as the command does."""
        beside = os.path.join(os.path.dirname(self._name), name)
        return beside if not os.path.exists(name) and os.path.exists(beside) else name

    def _file(self) -> tuple[str, str]:
        return self._name, self._text

    @property
    def estimator(self) -> str:
        """Name of the estimator."""
        return str(self._data["estimator"])

    @property
    def columns(self) -> str:
        """Which parameters were estimated."""
        return str(self._data["columns"])

    @property
    def names(self) -> list[str]:
        """Names of the b base parameters."""
        return [one["name"] for one in self._base]

    @property
    def values(self) -> Floats:
        """Their values, (b,), in `units`."""
        return np.array([one["value"] for one in self._base], dtype=np.float64)

    @property
    def std(self) -> Floats:
        """Their standard deviations, (b,)."""
        return np.array([one["std"] for one in self._base], dtype=np.float64)

    @property
    def units(self) -> list[str]:
        """Their units."""
        return [one["unit"] for one in self._base]

    @property
    def expressions(self) -> list[str]:
        """The combination of parameters that each of them stands for."""
        return [one.get("expression", one["name"]) for one in self._base]

    @property
    def servo(self) -> dict[str, dict[str, Any]]:
        """What was unknown of position servos, by name: ``value``, ``std``, ``ci95``, the guess ``stated``, and ``unit``."""
        return {one["name"]: {key: one[key] for key in ("value", "std", "ci95", "stated", "unit")} for one in self._data.get("servo", [])}

    @property
    def covariance(self) -> Floats:
        """Covariance of the values, (b, b)."""
        b = len(self._base)
        return np.array(self._data["covariance"], dtype=np.float64).reshape(b, b)

    @property
    def degrees_of_freedom(self) -> float:
        """Degrees of freedom behind the intervals; infinite where the noise is known."""
        found = self._data["degrees_of_freedom"]
        return np.inf if found is None else float(found)

    @property
    def standard(self) -> dict[str, float] | None:
        """A full set of parameters with these base parameters, near the nominal ones; None where there are no nominal ones."""
        found = self._data.get("standard")
        return None if found is None else {one["name"]: one["value"] for one in found}

    def interval(self, level: float = 0.95) -> Floats:
        """Intervals of Student's t that contain the parameters with this probability, (b, 2).

        An interval is infinite where the value cannot be real, a negative friction for example.
        """
        half = _armid.student(float(level), self.degrees_of_freedom) * self.std
        bounds = np.stack([self.values - half, self.values + half], axis=1)
        stated = np.array([[np.nan if end is None else end for end in one["ci95"]] for one in self._base])
        if level == 0.95:
            bounds = stated.reshape(-1, 2)
        withheld = np.isnan(stated.reshape(-1, 2)).any(axis=1)
        bounds[withheld] = (-np.inf, np.inf)
        return bounds

    @property
    def findings(self) -> list[Finding]:
        """What a reader should notice of the estimate."""
        return [Finding._of(one) for one in self._data["findings"]]

    @property
    def suspicions(self) -> list[Finding]:
        """Mistakes that the log seems to have been made with."""
        return [Finding._of(one) for one in self._data.get("suspicions") or []]

    def unexplained(self) -> dict[str, float]:
        """Share of the torque that is not explained: of each joint and "total", held out where anything is.

        A joint without torque has no share, nor have joints of unlike units a total.
        """
        rows = self._torque()["all_rows"]
        joints = self._data.get("joints") or [f"joint {number + 1}" for number in range(len(rows["share"]))]
        shares = {**dict(zip(joints, rows["share"])), "total": rows["total"]}
        return {name: share for name, share in shares.items() if share is not None}

    def _torque(self) -> dict[str, Any]:
        found = self._data.get("held_out") or self._data.get("residual")
        if not found:
            raise ArmidError("the estimate does not hold its residual")
        return found  # type: ignore[no-any-return]

    def predict(self, q: ArrayLike, qd: ArrayLike, qdd: ArrayLike, out: Floats | None = None) -> Floats:
        """Torque that the estimate predicts, Y_b β.

        Parameters
        ----------
        q, qd, qdd : array (N, n) or (n,)
            Position, velocity, acceleration: rad, rad/s, rad/s² (m for a prismatic joint).
        out : array (N, n), optional
            Where the result goes.

        Returns
        -------
        array (N, n) or (n,)
            Torque, N·m (N).
        """
        (q, qd, qdd), single = rows(q=q, qd=qd, qdd=qdd)
        torque = output(None if single else out, q.shape)
        _armid.predict(self.robot._robot, self._file(), [q, qd, qdd], torque)
        return torque[0] if single else torque

    def validate(
        self, logs: Logs, limit: float = 0.1, *, start: float | None = None, until: float | None = None
    ) -> Validation:
        """Predict the torque of logs that were not used for the estimate.

        Parameters
        ----------
        logs : Log, path, or a list of them
            A table is read with the mapping of the estimate.
        limit : float
            Largest difference that passes, as a share of the measured RMS of each joint.
        start, until : float, optional
            Part of the log that is used, s.

        Returns
        -------
        Validation
            A warning says where a log is that of the fit.
        """
        text = _armid.validate(self.robot._robot, self._file(), self._read(logs), float(limit), (start, until))
        validation = Validation(text)
        for remark in validation.data["remarks"]:
            warn(remark)
        return validation

    def export(
        self,
        to: str,
        path: Path | None = None,
        *,
        into: Path | None = None,
        logs: Logs | None = None,
        progress: Progress | None = None,
    ) -> str:
        """Write the model for another tool. A model that predicts the log much worse than the estimate is warned of.

        Parameters
        ----------
        to : "urdf", "mjcf", "toml", "json", "isaac", "python", "c" or "rust"
            A model of all parameters, fitted to the log of the estimate, or source code in base parameters.
        path : path, optional
            Where it is written.
        into : path, optional
            A URDF or MJCF of the same arm that gets the numbers.
        logs : Log, path, or a list of them, optional
            The logs of the estimate, where it has none any more: they were arrays, and it was pickled.
        progress : callable, optional
            Is called as ``progress(done, total, what)``.

        Returns
        -------
        str
            The text of the file.
        """
        place = None if path is None else os.fspath(path)
        from_ = None if into is None else os.fspath(into)
        text, _, fault = _armid.export(self.robot._robot, self._file(), self._again(logs), to, from_, place, progress)
        if place is not None:
            with open(place, "w", encoding="utf-8", newline="") as file:
                file.write(text)
        if fault is not None:
            warn(fault)
        return text

    def report(self, folder: Path, logs: Logs | None = None) -> str:
        """Draw a page into a folder: measured and predicted torque, residuals, parameters. Returns its path."""
        return os.fspath(_armid.report(self.robot._robot, self._file(), self._again(logs), os.fspath(folder)))

    def torque(self, logs: Logs | None = None) -> Torque:
        """Measured torque and what the estimate predicts: of what is held out where anything is, else of the fit's first log.

        Both passed the low pass of the estimate's bandwidth.

        Parameters
        ----------
        logs : Log, path, or a list of them, optional
            As in `export`.

        Returns
        -------
        Torque
            A named tuple: t (N,), s; measured and predicted (N, n), N·m (N); is_held_out.
        """
        is_held_out, rate, (measured, predicted) = _armid.torque(self.robot._robot, self._file(), self._again(logs))
        return Torque(np.arange(len(measured)) / rate, measured, predicted, is_held_out)

    def write_mcap(self, path: Path, logs: Logs | None = None) -> None:
        """Write the motion of `torque` as MCAP, with description and poses of the arm for a viewer.

        Topics: ``/robot_description`` and ``/tf`` show the arm; ``/joint_states`` has positions and measured torque,
        ``/predicted_torque`` and ``/residual`` have theirs as effort, N·m (N).

        Parameters
        ----------
        path : path
            The file.
        logs : Log, path, or a list of them, optional
            As in `export`.
        """
        _armid.write_mcap(self.robot._robot, self._file(), self._again(logs), os.fspath(path))

    @overload
    def plot(self, joint: str | None = None, *, ax: None = None, logs: Logs | None = None) -> Drawing: ...

    @overload
    def plot(self, joint: str | None = None, *, ax: Axes, logs: Logs | None = None) -> Axes: ...

    def plot(self, joint: str | None = None, *, ax: Axes | None = None, logs: Logs | None = None) -> Drawing | Axes:
        """Draw measured and predicted torque over time.

        Parameters
        ----------
        joint : str, optional
            The joint that is drawn into `ax`; the first by default.
        ax : axes of matplotlib, optional
            Where they are drawn. Without, the result is an SVG of all joints, which a notebook shows.
        logs : Log, path, or a list of them, optional
            As in `export`.

        Returns
        -------
        Drawing or axes
        """
        if ax is None:
            if joint is not None:
                raise ArmidError("joint is for ax=, expected none: the drawing holds all joints")
            return Drawing(_armid.draw(self.robot._robot, self._file(), self._again(logs)))
        joints = self.robot.joints
        name = joints[0] if joint is None else joint
        if name not in joints:
            raise ArmidError(f'joint is "{name}", expected one of {", ".join(joints)}')
        torque, place = self.torque(logs), joints.index(name)
        ax.plot(torque.t, torque.measured[:, place], label="measured")
        ax.plot(torque.t, torque.predicted[:, place], label="predicted")
        units = self._data.get("units") or [""] * len(joints)
        ax.set(title=name, xlabel="time (s)", ylabel=f"torque ({units[place]})")
        ax.legend()
        return ax

    def _read(self, logs: Logs) -> list[_armid.Log]:
        from ._log import Log

        inputs = self._data.get("inputs") or {}
        several = [logs] if isinstance(logs, (Log, str, os.PathLike)) else list(logs)

        def read(one: Log | Path) -> _armid.Log:
            if isinstance(one, Log):
                return one._log
            is_table = _armid.is_table(os.fspath(one))
            mapping, rate = (inputs.get("mapping"), inputs.get("rate_hz")) if is_table else (None, None)
            return Log.read(one, mapping, rate, self.robot)._log

        return [read(one) for one in several]

    def _again(self, logs: Logs | None) -> tuple[list[_armid.Log], list[_armid.Log]]:
        return self._logs if logs is None else (self._read(logs), [])

    def to_pandas(self) -> pandas.DataFrame:
        """The base parameters as a table of pandas, by their names."""
        import pandas

        return pandas.DataFrame(self._columns(), index=pandas.Index(self.names, name="parameter"))

    def to_polars(self) -> polars.DataFrame:
        """The base parameters as a table of polars, with their names in the column "parameter"."""
        import polars

        return polars.DataFrame({"parameter": self.names, **self._columns()})

    def _columns(self) -> dict[str, Any]:
        low, high = self.interval().T
        return {
            "value": self.values,
            "std": self.std,
            "low": low,
            "high": high,
            "unit": self.units,
            "expression": self.expressions,
        }

    def verdict(self) -> str:
        """What the estimate is worth, in a sentence."""
        shares = self.unexplained()
        total = shares.pop("total", None)
        of = "held-out torque" if self._data.get("held_out") else "torque of the fit (nothing is held out)"
        sentence = f"error of the {of}: " + ("not known" if total is None else f"{100 * total:.2f} %")
        if shares:
            worst = max(shares, key=lambda joint: shares[joint])
            sentence += f", worst at {worst}: {100 * shares[worst]:.2f} %"
        return sentence

    def __repr__(self) -> str:
        try:
            verdict = self.verdict()
        except ArmidError as error:
            verdict = error.message
        return f"<armid.Estimate of {self._data['robot']!r} by {self.estimator}: {len(self._base)} parameters; {verdict}>"

    def _repr_html_(self) -> str:
        parts = [f"<p><b>{escape(str(self._data['robot']))}</b> by {escape(self.estimator)}: {escape(self.verdict())}</p>"]
        noted = self.suspicions + self.findings
        if noted:
            items = "".join(f"<li>{escape(one.text)} → {escape(one.advice)}</li>" for one in noted[:3])
            rest = f"<li>… and {len(noted) - 3} more in <code>findings</code></li>" if len(noted) > 3 else ""
            parts.append(f"<ul>{items}{rest}</ul>")
        head = "".join(f"<th>{name}</th>" for name in ("parameter", "value", "std", "95 % interval", "unit", "stands for"))
        table = []
        for one, (low, high) in zip(self._base, self.interval()):
            cells = (
                one["name"],
                f"{one['value']:.5g}",
                f"{one['std']:.2g}",
                f"{low:.5g} to {high:.5g}",
                one["unit"],
                one.get("expression", ""),
            )
            table.append("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in cells) + "</tr>")
        parts.append(f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(table)}</tbody></table>")
        return "".join(parts)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Estimate) and self._text == other._text

    def __hash__(self) -> int:
        return hash(self._text)

    def __reduce__(self) -> tuple[Any, ...]:
        return Estimate, (self._text,)

    def _warn(self, unfinished: str | None) -> None:
        if unfinished is not None:
            warn(f"{self.estimator}: {unfinished}")
        for one in self.suspicions + self.findings:
            warn(f"{self.estimator}: {one.text}")


class Validation:
    """How well an estimate predicts logs that were not used for it."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._data: dict[str, Any] = json.loads(text)

    @property
    def data(self) -> dict[str, Any]:
        """Everything that the command says of it."""
        return json.loads(self._text)  # type: ignore[no-any-return]

    @property
    def passed(self) -> bool:
        """Whether the difference of every joint is within the limit, on logs that are not those of the fit."""
        return bool(self._data["verdict"] == "passed")

    @property
    def rms(self) -> Floats:
        """Difference of measured and predicted torque, RMS, N·m (N), (n,)."""
        return np.array(self._data["rms"], dtype=np.float64)

    @property
    def shares(self) -> Floats:
        """The same as a share of the measured torque, (n,)."""
        return np.array(self._data["relative_rms"], dtype=np.float64)

    def __repr__(self) -> str:
        shares = ", ".join(f"{100 * share:.3g} %" for share in self.shares)
        return f"<armid.Validation of {self._data['recording']}: {self._data['verdict']}; {shares}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return Validation, (self._text,)


class Payload:
    """What the last link carries, from two estimates."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._data: dict[str, Any] = json.loads(text)

    @property
    def data(self) -> dict[str, Any]:
        """Everything that the command's file holds."""
        return json.loads(self._text)  # type: ignore[no-any-return]

    @property
    def mass(self) -> float:
        """Mass of the physically consistent body, kg."""
        return float(self._data["body"]["mass_kg"])

    @property
    def centre(self) -> Floats:
        """Its centre of mass in the frame of the last link, m, (3,)."""
        return np.array(self._data["body"]["com_m"], dtype=np.float64)

    @property
    def inertia(self) -> Floats:
        """Its inertia about the origin of that frame, kg·m², (3, 3)."""
        xx, xy, xz, yy, yz, zz = self._data["body"]["inertia_kg_m2"]
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], dtype=np.float64)

    @property
    def parameters(self) -> dict[str, dict[str, Any]]:
        """Each of its ten parameters: `shown` has value, std and 95 % interval; None where the motion does not show it."""
        return {one["name"]: one for one in self._data["parameters"]}

    def __repr__(self) -> str:
        x, y, z = self.centre
        return f"<armid.Payload of {self.mass:.4g} kg at ({x:.4g}, {y:.4g}, {z:.4g}) m>"

    def __reduce__(self) -> tuple[Any, ...]:
        return Payload, (self._text,)
