"""A robot: its equations of motion, and everything that is done with it."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypedDict, Union, overload

import numpy as np
from numpy.typing import ArrayLike

from . import _armid
from ._arrays import Floats, output, real, rows, vector
from ._design import Design
from ._errors import ArmidError, warn
from ._estimate import Estimate, Payload
from ._log import Log, Path
from ._criterion import Criterion, checked
from ._study import Own, Progress

if TYPE_CHECKING:
    from typing_extensions import Unpack

ALL = "rigid+rotor+friction"

Logs = Union[Log, Path, Sequence[Union[Log, Path]]]
Parameters = Union[ArrayLike, Mapping[str, float], None]


class Settings(TypedDict, total=False):
    """The keywords of `Robot.identify`, for checkers of types."""

    columns: str
    select: bool | str
    period: float | str | None
    start: float | None
    until: float | None
    held_out: float | str | Logs | None
    measured_velocity: bool
    effort: str | None
    derivatives: str | None
    cutoff_hz: float | None
    reversal_fraction: float | None
    torque_filter: str | None
    samples: int | None
    bandwidth_hz: float | None
    onset_speed: str | None
    stribeck_speed: bool
    initial: Mapping[str, float] | None
    progress: Progress | None


@dataclass(frozen=True)
class Base:
    """The combinations of parameters that torque reveals.

    Attributes
    ----------
    K : array (b, p)
        Base parameters are K φ.
    names : list of b names
    expressions : list of b texts
        The combination that each stands for.
    parameters : list of p names
        The parameters φ.
    categories : list of p texts
        What torque reveals of each.
    """

    K: Floats
    names: list[str]
    expressions: list[str]
    parameters: list[str]
    categories: list[str]

    @property
    def rank(self) -> int:
        """Number of base parameters b."""
        return len(self.names)


class Robot:
    """A serial robot arm of n joints.

    >>> import armid, numpy as np
    >>> robot = armid.Robot.load("planar-2r")
    >>> robot.joints
    ['shoulder', 'elbow']
    >>> robot.inverse_dynamics(np.zeros(2), np.zeros(2), np.zeros(2)).shape
    (2,)
    """

    __slots__ = ("_robot",)

    def __init__(self, robot: _armid.Robot) -> None:
        self._robot = robot

    @classmethod
    def load(cls, name: Path, base_link: str | None = None, tip_link: str | None = None) -> Robot:
        """Load a robot: a bundled name, a robot.toml or the folder that holds it, a URDF or an MJCF.

        Parameters
        ----------
        name : str or path
            What it is called.
        base_link, tip_link : str, optional
            Links at which the chain begins and ends, in a tree.

        Raises
        ------
        NotFoundError
            Where there is no such robot.
        ArmidError
            Where its file cannot be used; the message has file, line and column.
        """
        return cls(_armid.Robot.load(os.fspath(name), base_link, tip_link))

    @property
    def name(self) -> str:
        """Its name."""
        return self._robot.name

    @property
    def joints(self) -> list[str]:
        """Names of its n joints, from the base outwards."""
        return self._robot.joints

    @property
    def dof(self) -> int:
        """Number of joints n."""
        return len(self._robot.joints)

    @property
    def remarks(self) -> list[str]:
        """What was read of its file otherwise than it is written, and what was not read."""
        return self._robot.remarks

    def parameters(self, columns: str = ALL) -> list[str]:
        """Names of the p parameters φ of these columns.

        Parameters
        ----------
        columns : str
            ``"rigid"``, or ``"rigid"`` and torque terms joined by ``+``.
        """
        return [name for name, _ in self._robot.parameters(columns)]

    def units(self, columns: str = ALL) -> list[str]:
        """Units of the p parameters of these columns."""
        return [unit for _, unit in self._robot.parameters(columns)]

    def nominal(self, columns: str = ALL) -> Floats:
        """What is known of the parameters without an experiment, (p,): inertias of the URDF, say."""
        return self._robot.nominal(columns)

    def _vector(self, parameters: Parameters, columns: str) -> Floats | None:
        if parameters is None:
            return None
        if isinstance(parameters, Mapping):
            names = self.parameters(columns)
            for kind, found in (("has no", set(names) - set(parameters)), ("has an unknown", set(parameters) - set(names))):
                if found:
                    first = min(found)
                    raise ArmidError(f"parameters {kind} {first}, expected those of {columns}: {', '.join(names)}")
            parameters = [parameters[name] for name in names]
        return vector(parameters, "parameters")

    def regressor(
        self, q: ArrayLike, qd: ArrayLike, qdd: ArrayLike, columns: str = ALL, out: Floats | None = None
    ) -> Floats:
        """Y(q, q̇, q̈), by which torque is linear in the parameters: τ = Y φ.

        Parameters
        ----------
        q, qd, qdd : array (N, n) or (n,)
            Position, velocity, acceleration: rad, rad/s, rad/s² (m for a prismatic joint).
        columns : str
            Which parameters; `parameters` names them.
        out : array (N, n, p), optional
            Where the result goes.

        Returns
        -------
        array (N, n, p) or (n, p)
            N·m (N) per unit of the parameter.

        Raises
        ------
        ArmidError
            Where an array is not of n joints, or a value is not finite.

        >>> import armid, numpy as np
        >>> robot, zero = armid.Robot.load("planar-2r"), np.zeros((5, 2))
        >>> robot.regressor(zero, zero, zero, "rigid").shape
        (5, 2, 20)
        """
        samples, single = rows(q=q, qd=qd, qdd=qdd)
        shape = (len(samples[0]), self.dof, len(self._robot.parameters(columns)))
        result = output(_room(out, single), shape)
        _armid.regressor(self._robot, samples, columns, result)
        return result[0] if single else result

    def gram(
        self,
        q: ArrayLike,
        qd: ArrayLike,
        qdd: ArrayLike,
        tau: ArrayLike,
        weights: ArrayLike | None = None,
        columns: str = ALL,
    ) -> tuple[Floats, Floats]:
        """The normal equations Σ Yᵀ D Y and Σ Yᵀ D τ of all samples. The regressor as a whole is never held.

        Parameters
        ----------
        q, qd, qdd, tau : array (N, n)
            As in `regressor`; torque in N·m (N).
        weights : array (n,), optional
            The diagonal of D, 1/σ² of each joint; 1 by default.

        Returns
        -------
        array (p, p), array (p,)

        >>> import armid, numpy as np
        >>> robot, ones = armid.Robot.load("planar-2r"), np.ones((5, 2))
        >>> information, moment = robot.gram(ones, ones, ones, ones)
        >>> y = robot.regressor(ones, ones, ones)
        >>> np.allclose(information, np.einsum("kia,kib->ab", y, y)) and np.allclose(moment, y.sum(axis=(0, 1)))
        True
        """
        samples, _ = rows(q=q, qd=qd, qdd=qdd, tau=tau)
        p = len(self._robot.parameters(columns))
        information, moment = np.empty((p, p)), np.empty(p)
        given = None if weights is None else vector(weights, "weights")
        _armid.gram(self._robot, samples, given, columns, information, moment)
        return information, moment

    def inverse_dynamics(
        self,
        q: ArrayLike,
        qd: ArrayLike,
        qdd: ArrayLike,
        parameters: Parameters = None,
        columns: str = ALL,
        out: Floats | None = None,
    ) -> Floats:
        """Torque of a motion: τ = H q̈ + c + g + τ_terms, by the recursion of Newton and Euler.

        Parameters
        ----------
        q, qd, qdd : array (N, n) or (n,)
            As in `regressor`.
        parameters : array (p,) or mapping of names, optional
            Those of `columns`; the nominal ones of the robot by default, with all its terms.
        out : array (N, n), optional
            Where the result goes.

        Returns
        -------
        array (N, n) or (n,)
            Torque, N·m (N).

        >>> import armid, numpy as np
        >>> robot, one = armid.Robot.load("planar-2r"), np.ones(2)
        >>> np.allclose(robot.inverse_dynamics(one, one, one), robot.regressor(one, one, one) @ robot.nominal())
        True
        """
        samples, single = rows(q=q, qd=qd, qdd=qdd)
        result = output(_room(out, single), samples[0].shape)
        _armid.inverse_dynamics(self._robot, samples, columns, self._vector(parameters, columns), result)
        return result[0] if single else result

    def forward_dynamics(
        self,
        q: ArrayLike,
        qd: ArrayLike,
        tau: ArrayLike,
        parameters: Parameters = None,
        columns: str = ALL,
        out: Floats | None = None,
    ) -> Floats:
        """Acceleration that a torque gives: q̈ = H⁻¹ (τ − c − g − τ_terms).

        Parameters are as in `inverse_dynamics`. Not a number where the mass matrix of the parameters has no inverse.

        Returns
        -------
        array (N, n) or (n,)
            Acceleration, rad/s² (m/s²).

        >>> import armid, numpy as np
        >>> robot, one = armid.Robot.load("planar-2r"), np.ones(2)
        >>> np.allclose(robot.forward_dynamics(one, one, robot.inverse_dynamics(one, one, one)), one)
        True
        """
        samples, single = rows(q=q, qd=qd, tau=tau)
        result = output(_room(out, single), samples[0].shape)
        _armid.forward_dynamics(self._robot, samples, columns, self._vector(parameters, columns), result)
        return result[0] if single else result

    def mass_matrix(
        self, q: ArrayLike, parameters: Parameters = None, columns: str = ALL, out: Floats | None = None
    ) -> Floats:
        """H(q), links and rotors. Parameters are as in `inverse_dynamics`.

        Returns
        -------
        array (N, n, n) or (n, n)
            kg·m² (kg, kg·m).

        >>> import armid, numpy as np
        >>> matrix = armid.Robot.load("planar-2r").mass_matrix(np.zeros(2))
        >>> np.array_equal(matrix, matrix.T)
        True
        """
        (q,), single = rows(q=q)
        result = output(_room(out, single), (*q.shape, self.dof))
        _armid.mass_matrix(self._robot, q, columns, self._vector(parameters, columns), result)
        return result[0] if single else result

    def reduce(self, columns: str = ALL, on: Path | None = None, method: str | None = None, seed: int = 1) -> Base:
        """Find the combinations of parameters that torque reveals.

        Parameters
        ----------
        columns : str
            Which parameters.
        on : name or path, optional
            A trajectory: what this motion reveals, in place of all motions.
        method : str, optional
            "structural" by default, which is exact; others are numerical.
        seed : int
            Of the methods that draw states.

        Returns
        -------
        Base

        >>> import armid
        >>> base = armid.Robot.load("planar-2r").reduce("rigid")
        >>> base.K.shape == (base.rank, len(base.parameters))
        True
        """
        text, k = _armid.reduce(self._robot, columns, None if on is None else os.fspath(on), method, seed)
        data = json.loads(text)
        base, all_ = data["base"], data["parameters"]
        return Base(
            K=k,
            names=[one["name"] for one in base],
            expressions=[one["expression"] for one in base],
            parameters=[one["name"] for one in all_],
            categories=[one["category"] for one in all_],
        )

    @overload
    def identify(  # type: ignore[overload-overlap]
        self, logs: Logs, estimator: str | Own = "wls", **settings: Unpack[Settings]
    ) -> Estimate: ...

    @overload
    def identify(
        self, logs: Logs, estimator: Sequence[str | Own] | Mapping[str, str | Own], **settings: Unpack[Settings]
    ) -> dict[str, Estimate]: ...

    def identify(
        self,
        logs: Logs,
        estimator: str | Own | Sequence[str | Own] | Mapping[str, str | Own] = "wls",
        *,
        columns: str = ALL,
        select: bool | str = False,
        period: float | str | None = "auto",
        start: float | None = None,
        until: float | None = None,
        held_out: float | str | Logs | None = "auto",
        measured_velocity: bool = False,
        effort: str | None = None,
        derivatives: str | None = None,
        cutoff_hz: float | None = None,
        reversal_fraction: float | None = None,
        samples: int | None = None,
        torque_filter: str | None = None,
        bandwidth_hz: float | None = None,
        onset_speed: str | None = None,
        stribeck_speed: bool = False,
        initial: Mapping[str, float] | None = None,
        progress: Progress | None = None,
    ) -> Estimate | dict[str, Estimate]:
        """Estimate the base parameters from logs. Findings and suspicions are warned of.

        Parameters
        ----------
        logs : Log, path, or a list of them
            Several go into one fit.
        estimator : str, callable, or several of them
            A name, as ``armid identify --list`` shows them; or ``f(W, y)``, which returns β, or β and its covariance. W (m, b)
            and y (m,) are the equations W β = y of all joints, N·m. Where it returns β alone, the covariance is that of
            ``"ols"``. A list, or a mapping from names of your own, gives a dict.
        columns : str
            Which parameters are estimated.
        select : bool or str
            Estimate with the torque terms that the log supports, among all or among these columns.
        period : float, "auto" or None
            Period of the motion, s; found in the log, or none.
        start, until : float, optional
            Part of the log that is used, s.
        held_out : float, None, "auto", or logs
            Share that is only predicted; by default a fifth of a log that something else than armid recorded.
        measured_velocity : bool
            Take velocities as measured.
        effort : "torque" or "current", optional
            Kind of efforts, where the log does not state it.
        derivatives : "fourier" or "differences", optional
            How velocity and acceleration are found.
        cutoff_hz, reversal_fraction, samples, bandwidth_hz : optional
            As the options of the command of the same names.
        torque_filter : "none" or "same-as-positions", optional
            Low pass on both sides of the equations.
        onset_speed : "found" or "stated", optional
            Whether the speed in which Coulomb friction sets in is found in the log.
        stribeck_speed : bool
            Estimate the speed at which friction falls, for columns with Stribeck friction.
        initial : mapping of names, optional
            Parameters that estimators which simulate the arm begin with.
        progress : callable, optional
            Is called as ``progress(done, total, what)``; an exception of it, as Ctrl-C, ends the work.

        Returns
        -------
        Estimate, or dict of names and estimates

        Raises
        ------
        ArmidError
            Where a log cannot be used, or its motion does not show the parameters.

        >>> import armid, numpy as np, warnings
        >>> warnings.simplefilter("ignore", armid.ArmidWarning)
        >>> robot = armid.Robot.load("planar-2r")
        >>> log = robot.simulate(robot.design("d-optimal", starts=1, evaluations=20, baseline=False), periods=4)
        >>> def least_squares(W, y):
        ...     return np.linalg.lstsq(W, y)[0]
        >>> found = robot.identify(log, ["ols", least_squares])
        >>> np.allclose(found["least_squares"].values, found["ols"].values)
        True
        """
        if isinstance(period, str) and period != "auto":
            raise ArmidError(f'period is "{period}", expected seconds, "auto" or None')
        if onset_speed not in (None, "found", "stated"):
            raise ArmidError(f'onset_speed is "{onset_speed}", expected "found" or "stated"')
        reading = {
            "period_s": None if period is None or isinstance(period, str) else float(period),
            "finds_period": period is not None,
            "from_s": start,
            "until_s": until,
            "held_out": None,
            "measured_velocity": measured_velocity,
            "effort": effort,
            "bandwidth_hz": bandwidth_hz,
            "derivatives": derivatives,
            "cutoff_hz": cutoff_hz,
            "reversal_fraction": reversal_fraction,
            "samples_per_period": samples,
            "torque_filter": torque_filter,
        }
        others: list[_armid.Log] = []
        if held_out is None:
            reading["held_out"] = 0.0
        elif isinstance(held_out, (int, float)):
            reading["held_out"] = float(held_out)
        elif not (isinstance(held_out, str) and held_out == "auto"):
            reading["held_out"] = 0.0
            others = self._logs(held_out)
        asked, is_one = _estimators(estimator)
        wanted = {
            "columns": columns,
            "estimators": [one if isinstance(one, str) else (name, one) for name, one in asked.items()],
            "select": "all" if select is True else (select or None),
            "onset_speed": None if onset_speed is None else onset_speed == "found",
            "stribeck_speed": stribeck_speed,
            "initial": None if initial is None else json.dumps({name: float(value) for name, value in initial.items()}),
        }
        used = self._logs(logs)
        found = _armid.identify(self._robot, used, others, reading, wanted, progress)
        estimates = {}
        for name, (text, unfinished) in zip(asked, found):
            estimates[name] = Estimate(text, self)
            estimates[name]._logs = (used, others)
            estimates[name]._warn(unfinished)
        return next(iter(estimates.values())) if is_one else estimates

    def _logs(self, logs: Logs) -> list[_armid.Log]:
        several = [logs] if isinstance(logs, (Log, str, os.PathLike)) else list(logs)
        return [(one if isinstance(one, Log) else Log.read(one, robot=self))._log for one in several]

    def design(
        self,
        criterion: str | Criterion | None = None,
        *,
        payload: tuple[float, Sequence[float]] | None = None,
        columns: str = ALL,
        period: float = 10.0,
        family: str = "fourier",
        harmonics: int | Sequence[int] = 5,
        frozen: Mapping[str, float] | None = None,
        starts: int = 8,
        evaluations: int | None = None,
        iterations: int | None = None,
        seed: int = 1,
        start_at: Sequence[Path] = (),
        margin_deg: float = 5.0,
        confidence: float | None = 0.95,
        ramp: float | None = 2.0,
        clearance: float | None = 0.0,
        keep_above: float | None = None,
        max_acceleration: float | None = None,
        weighted: bool = False,
        prior: Sequence[Estimate | Path] = (),
        effects: Mapping[str, float | str] | None = None,
        predict: Sequence[Path] = (),
        periods: int = 10,
        baseline: bool = True,
        progress: Progress | None = None,
    ) -> Design:
        """Design a trajectory that excites the parameters best within the limits of the robot.

        Parameters
        ----------
        criterion : str or callable
            "d-optimal", "i-optimal", "a-optimal", "condition", …; or ``f(M)``, which returns the number that is minimised, and
            the array S (b, b) with d value = tr(S dM). M (b, b) is the information per equation, symmetric and positive
            definite. S is held against differences of the value once.
        payload : (mass, centre), optional
            In place of a criterion: made for a load on the last link of at most this mass, kg, with this centre, m (3).
        columns : str
            Which parameters are to be estimated.
        period : float
            Period, s.
        family : str
            Family of trajectories.
        harmonics : int, or one for each joint
            Harmonics.
        frozen : mapping of joints to positions, optional
            Joints that are held still, rad (m).
        starts, evaluations, iterations : int
            Searches, and evaluations and steps of each.
        seed : int
            Of the first guesses. Equal seeds give equal designs.
        start_at : names or paths
            Trajectories at which further searches begin.
        margin_deg : float
            Distance from the limits of position, deg.
        confidence : float or None
            Probability with which torque and current keep their limits; None does not hold them.
        ramp : float or None
            Length of the ramps in which the limits hold as well, s.
        clearance : float or None
            Distance between shapes and from obstacles, m; None holds none.
        keep_above : float, optional
            Height of the base frame above which everything stays, m.
        max_acceleration : float, optional
            Largest acceleration of every joint, rad/s².
        weighted : bool
            Weight equations by the noise of each joint.
        prior : estimates or their paths
            Earlier experiments, to which the design adds.
        effects : mapping, optional
            What "measured-torque" and "model-error" expect of the arm: a magnitude, or "realistic", "severe", …
        predict : names or paths
            Motions on which torque will be predicted, for "i-optimal", "measured-torque" and "model-error": trajectories, or one of
            "slow" and "point-to-point"; by default random ones.
        periods : int
            Recorded periods that "measured-torque" and "model-error" expect.
        baseline : bool
            Whether the best of random trajectories is found for comparison.
        progress : callable, optional
            Is called as ``progress(done, total, what)``.

        Returns
        -------
        Design
            The best inside all limits; where there is none, the nearest to them, and a warning.

        Raises
        ------
        ArmidError
            Where the settings do not fit the robot. What a criterion raises reaches the caller.

        >>> import armid, numpy as np
        >>> def d_optimal(M):
        ...     return -np.linalg.slogdet(M)[1], -np.linalg.inv(M)
        >>> design = armid.Robot.load("planar-2r").design(d_optimal, starts=1, evaluations=20, baseline=False)
        >>> design.criterion, design.is_feasible
        ('d_optimal', True)
        """
        paths: list[str] = []
        asked = {
            "criterion": _criterion(criterion),
            "payload": None if payload is None else (float(payload[0]), [float(x) for x in payload[1]]),
            "columns": columns,
            "period_s": period,
            "family": family,
            "harmonics": [harmonics] if isinstance(harmonics, int) else list(harmonics),
            "frozen": [(name, float(place)) for name, place in (frozen or {}).items()],
            "seed": seed,
            "starts": starts,
            "from": [os.fspath(one) for one in start_at],
            "evaluations": evaluations,
            "iterations": iterations,
            "margin_deg": margin_deg,
            "confidence": confidence,
            "ramp_s": ramp,
            "clearance_m": clearance,
            "keep_above_m": keep_above,
            "max_acceleration": max_acceleration,
            "weighted": weighted,
            "prior": paths,
            "effects": json.dumps(dict(effects or {})),
            "predict": [os.fspath(one) for one in predict],
            "periods": periods,
            "baseline": baseline,
        }
        with tempfile.TemporaryDirectory() as folder:
            for number, one in enumerate(prior):
                path = os.path.join(folder, f"{number}.json") if isinstance(one, Estimate) else os.fspath(one)
                if isinstance(one, Estimate):
                    one.write(path)
                paths.append(path)
            toml, data = _armid.design(self._robot, asked, progress)
        found = Design(toml, data, self)
        if not found.is_feasible:
            violation = found.data["violation"]
            where, excess = violation["where"], violation["excess"]
            warn(f"no design keeps all limits: the nearest exceeds that of {violation['limit']} at {where} by {excess:.3g}")
        return found

    def sample(self, trajectory: Design | Path, rate: float) -> tuple[Floats, Floats, Floats, Floats]:
        """Set-points of one period of a trajectory.

        Parameters
        ----------
        trajectory : Design, name or path
            The motion.
        rate : float
            Samples per second, Hz; a period must hold a whole number of them.

        Returns
        -------
        t : array (N,)
            Time, s.
        q, qd, qdd : array (N, n)
            Position, velocity, acceleration: rad, rad/s, rad/s² (m for a prismatic joint).
        """
        t, (q, qd, qdd) = _armid.sample(self._robot, _motion(trajectory), float(rate))
        return t, q, qd, qdd

    def simulate(
        self,
        trajectory: Design | Path,
        *,
        engine: str = "analytic",
        effects: Mapping[str, float | str] | None = None,
        periods: int = 10,
        discarded_periods: int = 1,
        rate: float = 1000.0,
        settle: float = 1.0,
        ramp: float = 2.0,
        noise: bool = True,
        seed: int = 0,
        run: int = 0,
        progress: Progress | None = None,
    ) -> Log:
        """Perform an experiment on a simulated arm under its servo.

        Parameters
        ----------
        trajectory : Design, name or path
            The motion.
        engine : "analytic", "rapier" or "mujoco"
            What turns torque into motion.
        effects : mapping, optional
            What the arm has beyond the model: a magnitude, or "realistic", "severe", …
        periods, discarded_periods : int
            Periods that are recorded, and performed before them.
        rate : float
            Samples per second, Hz.
        settle, ramp : float
            Time at rest before the motion, and length of each ramp, s.
        noise : bool
            Whether encoders count and currents are noisy.
        seed, run : int
            Of the noise; each run has its own.

        Returns
        -------
        Log
        """
        experiment = {
            "engine": engine,
            "effects": json.dumps(dict(effects or {})),
            "seed": seed,
            "run": run,
            "rate_hz": rate,
            "settle_s": settle,
            "ramp_s": ramp,
            "discarded_periods": discarded_periods,
            "periods": periods,
            "noise": noise,
        }
        log, ending = _armid.simulate(self._robot, _motion(trajectory), experiment, progress)
        if ending is not None:
            warn(ending)
        return Log(log)

    def payload(self, without: Estimate | Logs, with_: Estimate | Logs, progress: Progress | None = None) -> Payload:
        """Find what the last link carries, from the arm without it and with it: logs, or estimates of the same columns.

        Compare logs of the same motion, recorded on one day. Logs beside an estimate are processed as its own were; both sides have the
        speeds of friction of one.
        """

        def side(one: Estimate | Logs, name: str) -> tuple[str, str] | list[_armid.Log]:
            return (name, one._text) if isinstance(one, Estimate) else self._logs(one)

        text = _armid.payload(self._robot, side(without, "the estimate without"), side(with_, "that with"), progress)
        payload = Payload(text)
        if payload.data["negative_mass"] is not None:
            warn("the mass is below zero: more than a load changed between the logs, or they are exchanged")
        elif payload.data["chi_squared"] > payload.data["chi_squared_limit"]:
            warn(f"the arm changed by more than a load explains: intervals are {payload.data['widened_by']:.2g} times as wide")
        return payload

    def __repr__(self) -> str:
        return f"<armid.Robot {self.name!r} of {self.dof} joints>"

    def __reduce__(self) -> tuple[Any, ...]:
        name, base_link, tip_link = self._robot.source
        if name is None:
            raise ArmidError(f'robot "{self.name}" came with a recording, expected one of a file to pickle')
        return Robot.load, (name, base_link, tip_link)


def _motion(trajectory: Design | Path) -> dict[str, str | None]:
    if isinstance(trajectory, Design):
        return {"name": "the design", "text": trajectory.to_toml()}
    return {"name": os.fspath(trajectory), "text": None}


def _criterion(criterion: str | Criterion | None) -> str | tuple[str, Criterion] | None:
    if criterion is None or isinstance(criterion, str):
        return criterion
    if not callable(criterion):
        raise ArmidError(f"criterion is {type(criterion).__name__}, expected a name or a callable")
    name = getattr(criterion, "__name__", type(criterion).__name__)
    return name, checked(name, criterion)


def _room(out: Floats | None, single: bool) -> Floats | None:
    if single and out is not None:
        raise ArmidError("out is for arrays of samples, found a single sample")
    return out


def _estimators(estimator: Any) -> tuple[dict[str, str | Own], bool]:
    """What was asked for, by its name, and whether it is a single one. Names of the list come before callables."""

    def name(one: Any) -> str:
        return one if isinstance(one, str) else getattr(one, "__name__", type(one).__name__)

    is_one = isinstance(estimator, str) or callable(estimator)
    if isinstance(estimator, Mapping):
        pairs = [(str(key), one) for key, one in estimator.items()]
    else:
        pairs = [(name(one), one) for one in ([estimator] if is_one else estimator)]
    if not pairs:
        raise ArmidError("no estimator is named, expected at least one")
    asked: dict[str, str | Own] = {}
    for key, one in sorted(pairs, key=lambda pair: not isinstance(pair[1], str)):
        if not (isinstance(one, str) or callable(one)):
            raise ArmidError(f"estimator is {type(one).__name__}, expected a name or a callable")
        if key in asked:
            raise ArmidError(f"two estimators are called {key}, expected a mapping with a name for each")
        asked[key] = one
    return asked, is_one
