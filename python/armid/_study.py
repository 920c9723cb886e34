"""Monte Carlo studies of designs and estimators."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any

from . import _armid
from ._arrays import Floats
from ._criterion import Criterion, checked
from ._errors import ArmidError, warn

if TYPE_CHECKING:
    import pyarrow

    from ._log import Path

Progress = Callable[[int, int, str], object]
Own = Callable[[Floats, Floats], Any]


class StudyResult:
    """A study that was performed, in its folder."""

    def __init__(self, folder: Path, text: str) -> None:
        self.folder = FilePath(os.fspath(folder))
        self._text = text

    @property
    def data(self) -> dict[str, Any]:
        """What it found: the key says whether it was on one robot ("whole") or on several ("on-robots")."""
        return json.loads(self._text)  # type: ignore[no-any-return]

    def rows(self, table: str = "runs") -> pyarrow.Table:
        """A table of the study by Arrow. It has the stream of Arrow's C interface, so that ``polars.DataFrame`` takes it as it is.

        Parameters
        ----------
        table : str
            "runs", a row for each run and estimator, or "parameters", a row for each base parameter of each of these.

        Returns
        -------
        pyarrow.Table
            Needs pyarrow.

        Raises
        ------
        ArmidError
            Where the study has no such table.
        """
        import pyarrow.parquet

        path = self.folder / f"{table}.parquet"
        if not path.is_file():
            found = ", ".join(sorted(file.stem for file in self.folder.glob("*.parquet"))) or "none"
            raise ArmidError(f'table is "{table}", expected one of the study: {found}')
        return pyarrow.parquet.read_table(path)

    def report(self) -> FilePath:
        """The page."""
        return self.folder / "report" / "report.html"

    def __repr__(self) -> str:
        return f"<armid.StudyResult in {os.fspath(self.folder)!r}>"


def study(
    plan: Path,
    out: Path,
    *,
    resume: bool = False,
    threads: int = 0,
    until: str | None = None,
    estimators: Mapping[str, Own] | None = None,
    criteria: Mapping[str, Criterion] | None = None,
    progress: Progress | None = None,
) -> StudyResult:
    """Perform a study: designs, experiments on simulated arms, estimates, scores.

    Parameters
    ----------
    plan : path
        study.toml, or a folder with one.
    out : path
        Folder of the results.
    resume : bool
        Continue what is in the folder. Ctrl-C keeps what is finished there.
    threads : int
        Threads; all cores by default.
    until : str, optional
        End where an interval is narrow enough: ``"ratio(condition, d-optimal).prediction < 5 %"``.
    estimators : mapping of names to callables, optional
        Estimators of your own, as in `Robot.identify`; the plan names them beside those of the list. A run in which one raises
        counts as a run without an estimate, and a warning says what it raised.
    criteria : mapping of names to callables, optional
        Criteria of your own, as in `Robot.design`, for the designs of the plan.
    progress : callable, optional
        Is called as ``progress(done, total, what)``.

    Raises
    ------
    ArmidError
        Where the plan cannot be performed, or the folder holds another study.

    >>> import armid, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     armid.study("nowhere", folder)  # doctest: +IGNORE_EXCEPTION_DETAIL
    Traceback (most recent call last):
    ...
    armid.NotFoundError: study "nowhere" is neither a bundled study, nor a folder, nor a file
    """
    own = [(name, checked(name, of)) for name, of in (criteria or {}).items()]
    text, raised = _armid.study(
        os.fspath(plan), os.fspath(out), resume, threads, until, list((estimators or {}).items()), own, progress
    )
    if raised is not None:
        warn(f"an estimator raised in at least one run: {raised}")
    return StudyResult(out, text)
