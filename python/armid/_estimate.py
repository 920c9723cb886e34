"""What an identification gives."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from . import _armid
from ._arrays import Floats, output, rows
from ._errors import ArmidError, warn

if TYPE_CHECKING:
    import pandas

    from ._log import Path
    from ._robot import Robot


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


class Estimate:
    """Base parameters of a robot with their uncertainty: what the command's E.json holds.

    Two estimates are equal where their files are. An estimate is pickled as its file.
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
                return cls(file.read(), robot)
        except FileNotFoundError:
            raise NotFoundError(f"{os.fspath(path)} cannot be read: there is no such file") from None

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
            self._robot = Robot.load(source["name"], source["base_link"], source["tip_link"])
        return self._robot

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
        _armid.predict(self.robot._robot, self._text, [q, qd, qdd], torque)
        return torque[0] if single else torque

    def to_pandas(self) -> pandas.DataFrame:
        """The base parameters as a table of pandas, by their names."""
        import pandas

        low, high = self.interval().T
        columns = {
            "value": self.values,
            "std": self.std,
            "low": low,
            "high": high,
            "unit": self.units,
            "expression": self.expressions,
        }
        return pandas.DataFrame(columns, index=pandas.Index(self.names, name="parameter"))

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
