"""Errors of numbers that are computed from coefficients with errors."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

Numbers = Mapping[str, complex]


def propagated(
    function: Callable[[Numbers], Mapping[str, complex]], values: Numbers, errors: Mapping[str, float]
) -> dict[str, float]:
    """By how much each of function(values) may be off: the sum of its changes where each value is off by its error.

    Complex values are moved in their real and their imaginary part.
    """
    exact = function(values)
    found = dict.fromkeys(exact, 0.0)
    for name, error in errors.items():
        for unit in (1.0, 1.0j) if np.iscomplexobj(values[name]) else (1.0,):
            with np.errstate(all="ignore"):
                moved = function({**values, name: values[name] + unit * error})
            for key, value in exact.items():
                found[key] += float(abs(moved[key] - value))
    return found
