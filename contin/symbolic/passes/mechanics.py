"""From mechanics to a model: equations of motion that are implicit in the accelerations, solved for them.

Equations are written with x, dx and ddx for each coordinate. They must be linear in the accelerations; those are
eliminated one by one, always the one that fills in least (Markowitz), so that many masses on one platform cost little.
Coordinates that are wanted only for their reaction, such as a platform's, are left out of the model.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from contin.errors import InputError
from contin.model.evaluate import evaluate
from contin.model.expression import ZERO, Expression, add, div, mask_of, mul, neg, sub, substitute, symbol
from contin.model.model import Model
from contin.model.parser import parse
from contin.model.scope import Function
from contin.records import Fields, Record
from contin.symbolic.calculus.derivatives import sparse_jacobian

Row = dict[str, Expression]


def mechanical_model(
    name: str,
    coordinates: Sequence[str],
    equations: Sequence[str | Expression],
    *,
    parameters: Record,
    reactions: Sequence[str] = (),
    velocities: Mapping[str, str] | None = None,
    functions: Record | None = None,
    **more: Any,
) -> Model:
    """The first-order model of equations 0 = equations[k], linear in the accelerations dd<coordinate>.

    Parameters
    ----------
    coordinates : names q of the coordinates that become states q and dq.
    equations : as many as there are coordinates and reactions together; formulas or texts in q, d<q>, dd<q>.
    reactions : coordinates of which only the acceleration occurs (a platform that nothing else holds): eliminated.
    velocities : names of the velocity states, default d<q>.
    more : further parts of the model (starts, averaging, symmetries, title, ...), as `Model` takes them.

    Raises
    ------
    InputError
        The equations are not linear in the accelerations, do not determine them, or a reaction's position or velocity
        occurs in them.
    """
    unknowns = [f"dd{q}" for q in (*coordinates, *reactions)]
    if len(equations) != len(unknowns):
        raise InputError(f"mechanics: {len(unknowns)} accelerations need as many equations; got {len(equations)}")
    declared = _functions(functions or {}, parameters)
    known = [*coordinates, *(f"d{q}" for q in coordinates), *unknowns, *parameters]
    residuals = [e if isinstance(e, Expression) else parse(e, known, declared) for e in equations]
    solved = _accelerations(residuals, unknowns, _anywhere(known))
    names = {q: (velocities or {}).get(q, f"d{q}") for q in coordinates}
    renamed = {symbol(f"d{q}"): symbol(v) for q, v in names.items()}
    motion: Fields = {}
    for q in coordinates:
        motion[q] = symbol(names[q])
        motion[names[q]] = substitute([solved[f"dd{q}"]], renamed)[0]
    states = {n: 0 for pair in names.items() for n in pair} | dict(more.pop("values", {}))
    return Model(name, states=states, parameters=dict(parameters), equations=motion, **more)


def _functions(texts: Record, parameters: Record) -> Mapping[str, Function]:
    """Declared functions, read by a model of their own."""
    if not texts:
        return {}
    return Model("functions", states={"t_": 0}, parameters=dict(parameters), functions=dict(texts),
                 equations={"t_": 0}).functions  # fmt: skip


def _anywhere(names: Sequence[str]) -> dict[str, float]:
    """A general point, to tell a zero pivot from others."""
    return {name: 0.61 + 0.137 * ((7 * k) % 11) for k, name in enumerate(names)}


def _accelerations(residuals: Sequence[Expression], unknowns: Sequence[str], point: Mapping[str, float]) -> Row:
    """The unknowns from residuals that are linear in them."""
    mask = mask_of(unknowns)
    rows: list[Row] = [{} for _ in residuals]
    for (i, j), entry in sparse_jacobian(residuals, unknowns).items():
        if entry.mask & mask:
            raise InputError(f"mechanics: equation {i + 1} is not linear in the accelerations")
        rows[i][unknowns[j]] = entry
    at_rest = {symbol(u): ZERO for u in unknowns}
    right = [neg(e) for e in substitute(residuals, at_rest)]
    order: list[tuple[int, str]] = []
    left = set(range(len(rows)))
    while left:
        i, u = _pivot(rows, left, point)
        left.remove(i)
        order.append((i, u))
        for k in left:
            if u not in rows[k]:
                continue
            factor = div(rows[k].pop(u), rows[i][u])
            for other, entry in rows[i].items():
                if other != u:
                    rows[k][other] = sub(rows[k].get(other, ZERO), mul(factor, entry))
            right[k] = sub(right[k], mul(factor, right[i]))
    solution: Row = {}
    for i, u in reversed(order):
        rest = [mul(entry, solution[other]) for other, entry in rows[i].items() if other != u]
        solution[u] = div(sub(right[i], add(*rest)) if rest else right[i], rows[i][u])
    return solution


def _pivot(rows: Sequence[Row], left: set[int], point: Mapping[str, float]) -> tuple[int, str]:
    columns: dict[str, int] = {}
    for i in left:
        for u in rows[i]:
            columns[u] = columns.get(u, 0) + 1
    choices = [
        ((len(rows[i]) - 1) * (columns[u] - 1), i, u)
        for i in sorted(left)
        for u, entry in rows[i].items()
        if abs(evaluate(entry, point)) > 1e-12
    ]
    if not choices:
        raise InputError("mechanics: the equations do not determine the accelerations (the mass matrix is singular)")
    _, i, u = min(choices)
    return i, u
