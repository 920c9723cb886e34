"""Monte Carlo studies of designs and estimators."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any

from . import _armid

if TYPE_CHECKING:
    import pyarrow

    from ._log import Path

Progress = Callable[[int, int, str], object]


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
        """A table of the study by Arrow, which pandas and polars take: "runs" or "parameters". Needs pyarrow."""
        import pyarrow.parquet

        return pyarrow.parquet.read_table(self.folder / f"{table}.parquet")

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
    progress : callable, optional
        Is called as ``progress(done, total, what)``.

    Raises
    ------
    ArmidError
        Where the plan cannot be performed, or the folder holds another study.
    """
    text = _armid.study(os.fspath(plan), os.fspath(out), resume, threads, until, progress)
    return StudyResult(out, text)
