"""Special points of equilibria in many digits, where the equilibria are known in closed form along one number s.

Nothing of contin's engine is used: the closed form is checked against the model's equations, and the folds and Hopf
points are the sign changes of det J and of the Hurwitz determinant along s, refined in 30 digits.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import mpmath
import numpy as np
from mpmath import mpf

from contin.model.dual import directional
from contin.model.evaluate import evaluate_all
from contin.model.model import Model

DIGITS = 30
GRID = 300
Point = Mapping[str, Any]


@dataclass(frozen=True)
class Curve:
    """Equilibria along s in (low, high): s, the constants and `math` or `mpmath` -> states and the free parameter."""

    parameter: str
    low: float
    high: float
    point: Callable[[Any, Any, Any], Point]


class Constants:
    """Parameter values as attributes."""

    def __init__(self, values: Mapping[str, Any]) -> None:
        self.__dict__.update(values)


def special_points(
    model: Model, curve: Curve, bounds: tuple[float, float], **parameters: Any
) -> dict[str, list[Point]]:
    """LP and HB points with the free parameter within `bounds`, in the order of s."""
    with mpmath.workdps(DIGITS):
        exactly = exact_parameters(model, parameters)
        constants = Constants(exactly)
        roughly = {name: float(value) for name, value in exactly.items()}

        def environment(s: Any) -> dict[str, Any]:
            return {**exactly, **curve.point(mpf(s), constants, mpmath)}

        def tests(s: Any) -> tuple[Any, Any]:
            a = characteristic(model, environment(s))
            return a[-1], hurwitz(a)

        def rough_tests(s: float) -> tuple[float, float]:
            a = characteristic(model, {**roughly, **curve.point(s, Constants(roughly), math)}, math)
            return a[-1], hurwitz(a)

        grid = np.linspace(curve.low, curve.high, GRID + 1).tolist()
        rows = [rough_tests(s) for s in grid]
        found: dict[str, list[Point]] = {"LP": [], "HB": []}
        for k in range(GRID):
            for which, label in enumerate(found):
                if rows[k][which] * rows[k + 1][which] >= 0:
                    continue
                bracket = (mpf(grid[k]), mpf(grid[k + 1]))
                s = mpmath.findroot(lambda s: tests(s)[which], bracket, solver="anderson", tol=1e-40)  # noqa: B023
                point = environment(s)
                assert max(abs(v) for v in evaluate_all(model.equations, point, mpmath)) < mpf(10) ** (6 - DIGITS)
                inside = bounds[0] < point[curve.parameter] < bounds[1]
                if label == "LP":
                    genuine = turns(curve, s, constants)
                else:
                    genuine = has_imaginary_pair(characteristic(model, point))
                if inside and genuine:
                    found[label].append(point)
        return found


def turns(curve: Curve, s: Any, constants: Constants) -> bool:
    """Whether the parameter turns at s, as at a fold; where it does not, another branch crosses."""
    slope = mpmath.diff(lambda s: curve.point(s, constants, mpmath)[curve.parameter], s)
    return bool(abs(slope) < mpf("1e-12"))


def exact_parameters(model: Model, overrides: Mapping[str, Any]) -> dict[str, Any]:
    """Parameter values in many digits: 8/3 and 1/15 are not rounded to double precision first."""
    names = [p.name for p in model.parameters]
    formulas = {p.name: p.value for p in model.parameters}
    values: dict[str, Any] = {name: mpf(overrides[name]) for name in names if name in overrides}
    for _ in names:
        for name in names:
            if name not in values:
                [value] = evaluate_all([formulas[name]], {**dict.fromkeys(names, mpmath.nan), **values}, mpmath)
                if not mpmath.isnan(value):
                    values[name] = exact(value)
    return values


def exact(value: Any) -> Any:
    """A decimal literal such as 0.1 as the decimal it was written as; quotients stay as computed."""
    return mpf(repr(value)) if isinstance(value, float) else mpf(value)


def characteristic(model: Model, env: Point, lib: Any = mpmath) -> list[Any]:
    """a1 ... an of s^n + a1 s^(n-1) + ... + an, the characteristic polynomial of the Jacobian (Faddeev-LeVerrier)."""
    n = len(model.state_names)
    columns = [directional(model.equations, env, {s: 1}, lib) for s in model.state_names]
    matrix = np.array(columns, dtype=float if lib is math else object).T
    unit = np.eye(n, dtype=int)
    product, coefficients = unit, []
    for k in range(1, n + 1):
        image = matrix @ product
        c = -sum(image[i, i] for i in range(n)) / k
        coefficients.append(c)
        product = image + c * unit
    return coefficients


def hurwitz(a: list[Any]) -> Any:
    """The Hurwitz determinant of order n - 1: zero where two roots have the sum zero."""
    if len(a) == 2:
        return a[0]
    if len(a) == 3:
        return a[0] * a[1] - a[2]
    return a[0] * a[1] * a[2] - a[2] ** 2 - a[0] ** 2 * a[3]


def has_imaginary_pair(a: list[Any]) -> bool:
    """Whether the roots with the sum zero are +-i omega (a Hopf point), not real (a neutral saddle)."""
    squared = {2: lambda: a[1], 3: lambda: a[1], 4: lambda: a[2] / a[0]}[len(a)]()
    return bool(squared > 0)
