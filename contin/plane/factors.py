"""The scalar functions whose zeros are the nullclines: the factors of each equation.

A product vanishes where a factor does. Each factor is followed for itself: x*(1 - y) gives two lines that cross, the
edge x = 0 of a window is seen, and x^2*y gives x = 0, along which the product keeps its sign.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from contin.abi import Array
from contin.lowering import compile_system
from contin.lowering.system import CompiledSystem
from contin.model.expression import Expression, depends_on, numeric_value, sub, symbol
from contin.model.model import Model
from contin.plane.field import PlanarField

Scalar = Callable[[Array], Array]  # of points (K, 2), (K,); nan where it has no value


def components(field: PlanarField) -> tuple[list[Scalar], list[Scalar]]:
    """Of both states; of Python functions, and of maps of angles (which wrap), the motion as a whole."""
    model = field.planar
    if not isinstance(model, Model) or (field.is_map and np.any(field.periods)):
        return [_motion(field, 0)], [_motion(field, 1)]
    kept: dict[str, Expression] = {}
    owner: list[int] = []
    for k, (equation, name) in enumerate(zip(model.equations, field.names, strict=True)):
        for factor in _factors(sub(equation, symbol(name)) if field.is_map else equation):
            if depends_on(factor, field.names):
                kept[f"factor {len(kept)}"] = factor  # no name in a model contains a blank
                owner.append(k)
    system = compile_system(model.replace(observables=kept, events=(), symmetries=()))
    found: tuple[list[Scalar], list[Scalar]] = ([], [])
    for number, k in enumerate(owner):
        found[k].append(_factor(system, field, number, k))
    return found


def _factors(node: Expression) -> list[Expression]:
    if node.op == "mul":
        return [one for factor in node.args for one in _factors(factor)]
    if node.op == "pow" and node.args[1].op == "number":
        return _factors(node.args[0]) if numeric_value(node.args[1]) > 0 else []
    return [] if node.op == "number" else [node]


def _motion(field: PlanarField, k: int) -> Scalar:
    return lambda points: field.motion(points)[:, k]


def _factor(system: CompiledSystem, field: PlanarField, number: int, k: int) -> Scalar:
    def value(points: Array) -> Array:
        rows = np.tile(field.p, (len(points), 1))
        with np.errstate(all="ignore"):
            found = np.asarray(system.observables(np.ascontiguousarray(points), rows)).reshape(len(points), -1)
        return np.where(np.isfinite(field.motion(points)[:, k]), found[:, number], np.nan)

    return value
