"""Arrays as the extension takes them: contiguous, of real numbers, one row for each sample."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import ArmidError

Floats = NDArray[np.float64]


def real(values: ArrayLike, name: str) -> Floats:
    """Contiguous numbers of double precision."""
    try:
        array = np.asarray(values)
    except ValueError as error:
        raise ArmidError(f"{name} is not an array: {error}") from None
    if array.dtype.kind not in "fiu":
        raise ArmidError(f"{name} has the type {array.dtype}, expected real numbers")
    # Unlike `ascontiguousarray`, this keeps a number without dimensions as it is.
    return np.asarray(array, dtype=np.float64, order="C")


def vector(values: ArrayLike, name: str) -> Floats:
    """Numbers of one dimension."""
    array = real(values, name)
    if array.ndim != 1:
        raise ArmidError(f"{name} has the shape {array.shape}, expected one dimension")
    return array


def rows(**quantities: ArrayLike) -> tuple[list[Floats], bool]:
    """Arrays of one row for each sample, and whether a single sample was given, without its dimension."""
    arrays = [real(values, name) for name, values in quantities.items()]
    for name, array in zip(quantities, arrays):
        if array.ndim not in (1, 2) or array.ndim != arrays[0].ndim:
            first = next(iter(quantities))
            expected = "(n,) or (N, n)" if array is arrays[0] else f"as many dimensions as {first}"
            raise ArmidError(f"{name} has the shape {array.shape}, expected {expected}")
    single = arrays[0].ndim == 1
    return ([array[np.newaxis] for array in arrays] if single else arrays), single


def output(out: Floats | None, shape: tuple[int, ...]) -> Floats:
    """Where a result of this shape goes."""
    if out is None:
        return np.empty(shape)
    if not isinstance(out, np.ndarray) or out.dtype != np.float64 or out.shape != shape:
        found: Any = f"{out.dtype} of the shape {out.shape}" if isinstance(out, np.ndarray) else type(out).__name__
        raise ArmidError(f"out is {found}, expected float64 of the shape {shape}")
    if not (out.flags.c_contiguous and out.flags.writeable):
        raise ArmidError("out is not contiguous or cannot be written, expected an array as numpy.empty makes it")
    return out
