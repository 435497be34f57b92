"""dF/dp by a complex step of a parameter alone, with real states where the function lets them be: its linear terms
are then products of real numbers, four times as cheap as of complex ones.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any, Final

import numpy as np

from contin.abi import Array, Vector
from contin.errors import UserFunctionError
from contin.records import Fields
from contin.systems.functions.complex_steps import COMPLEX_STEP, slope

Function = Callable[[Vector, Vector], Vector]
SAME: Final = 1e-9  # part of a slope that rounding may change, ...
NOTHING: Final = 1e-14  # ... and of the largest, where terms cancel


def moved(p: Array, steps: Array) -> Vector:
    """The parameters of a complex step."""
    return np.asarray(p + 1j * COMPLEX_STEP * steps)


def by_step(function: Function, u: Vector, p: Array, steps: Array) -> Array | None:
    """DF(u, p)[0, steps], steps (m,); None where the function throws imaginary parts away, or fails.

    An array of the states' type is often what a function fills: of real ones it cannot hold what the step shows.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", np.exceptions.ComplexWarning)
            found = function(u, moved(p, steps))
    except UserFunctionError:
        return None  # with complex states it is told whose fault that is
    slopes = slope(found, COMPLEX_STEP)
    return slopes if np.all(np.isfinite(slopes)) else None


def at_rows(residual: Callable[..., Any], u: Vector, named: Fields) -> Array | None:
    """dF/dp (K, n) at the rows of u (K, n), `named` having the step in it; None where one of them is to be asked alone.

    `by_step` at once: each context of warnings takes as long as a function of few states.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", np.exceptions.ComplexWarning)
            found = np.array([np.array(residual(row.copy(), dict(named))) for row in u])
    except Exception:  # noqa: BLE001
        return None  # each row is asked alone then, which says in words what is wrong
    if found.shape != u.shape or found.dtype.kind not in "biufc":
        return None
    slopes = slope(found, COMPLEX_STEP)
    return slopes if np.all(np.isfinite(slopes)) else None


def takes_real_states(function: Function, u: Array, p: Array, sizes: Array) -> bool:
    """Whether slopes by all parameters at once are the same with real states and complex ones, beside (u, p)."""
    n, generator = len(u), np.random.default_rng(12)
    shift = 0.01 * sizes * generator.uniform(-1.0, 1.0, sizes.size)
    states, others = u + shift[:n], p + shift[n:]
    steps = sizes[n:] * generator.uniform(0.5, 1.0, len(p))
    with np.errstate(all="ignore"):
        real, complex_ = by_step(function, states, others, steps), by_step(function, states + 0j, others, steps)
    if real is None or complex_ is None:
        return False
    size = np.abs(complex_)
    return bool(np.all(np.abs(real - complex_) <= SAME * size + NOTHING * size.max()))
