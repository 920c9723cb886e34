"""Criteria that are written in Python."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ._arrays import Floats
from ._errors import ArmidError

Criterion = Callable[[Floats], tuple[float, Any]]

_STEP = 1e-5


def checked(name: str, criterion: Criterion) -> Criterion:
    """The same criterion. Where it is first called, its derivative is held against differences of its value.

    They are taken along M(h) = (1 + h E) M (1 + h E), with a diagonal E that scales every parameter otherwise: this path keeps M
    positive definite, and no criterion of interest is constant on it.
    """
    is_checked = False

    def call(m: Floats) -> tuple[float, Any]:
        nonlocal is_checked
        answer = criterion(m)
        if not is_checked:
            is_checked = True
            _check(name, criterion, m, answer)
        return answer

    return call


def _check(name: str, criterion: Criterion, m: Floats, answer: Any) -> None:
    try:
        value, s = answer
        s = np.asarray(s, dtype=np.float64)
        value = float(value)
    except (TypeError, ValueError):
        raise ArmidError(f"criterion {name} did not return (value, S), expected a number and an array") from None
    if s.shape != m.shape:
        raise ArmidError(f"S of criterion {name} has the shape {s.shape}, expected {m.shape} as M has")
    e = np.linspace(0.5, 1.0, len(m)) ** 2

    def along(h: float) -> float:
        scale = 1.0 + h * e
        return float(criterion(scale[:, None] * m * scale)[0])

    expected = (along(_STEP) - along(-_STEP)) / (2.0 * _STEP)
    found = float(np.sum(s * (e[:, None] + e) * m))
    size = abs(expected) + abs(found) + 1e-3 * (1.0 + abs(value))
    if np.isfinite(expected) and not abs(found - expected) <= 1e-2 * size:
        raise ArmidError(
            f"S of criterion {name} gives the slope {found:.6g} where differences of its value give {expected:.6g}, "
            "expected d value = tr(S dM)"
        )
