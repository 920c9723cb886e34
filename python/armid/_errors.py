"""What can go wrong, and what a reader should notice."""

from __future__ import annotations

import os
import sys
import warnings

_PACKAGE = os.path.dirname(__file__)


class ArmidError(ValueError):
    """Something is not as expected.

    Attributes
    ----------
    message : str
        What was found and what was expected, with file, line and column where there are any.
    hint : str or None
        What helps.
    place : tuple or None
        Name of the file, line and column, both from 1.
    """

    def __init__(self, message: str, hint: str | None = None, place: tuple[str, int, int] | None = None) -> None:
        super().__init__(message)
        self.message = message
        self.hint = hint
        self.place = place

    def __str__(self) -> str:
        return self.message if self.hint is None else f"{self.message}\n→ {self.hint}"


class NotFoundError(ArmidError, FileNotFoundError):
    """A name is neither that of a file nor of anything built in."""


class ArmidWarning(UserWarning):
    """Something that a reader of a result should know: a finding, a suspicion, a search that did not end as it should."""


def warn(sentence: str) -> None:
    """Warn at the line of the caller outside this package."""
    level = 2
    frame = sys._getframe(1)
    while frame.f_back is not None and os.path.dirname(frame.f_code.co_filename) == _PACKAGE:
        frame = frame.f_back
        level += 1
    warnings.warn(sentence, ArmidWarning, stacklevel=level)


for _class in (ArmidError, NotFoundError, ArmidWarning):
    _class.__module__ = "armid"
