"""Flows with a mass matrix, M(p) u' = f(u, p), as ordinary differential equations on the same states.

Let the rows of M that vanish belong to the algebraic equations g = 0, the others be m u' = a(u) with m of full rank.
With m = [m_Y m_Z], m_Y invertible, and N = [-K; 1], K = m_Y^-1 m_Z, the matrix S = g_u N is regular exactly where the
index is 1. The flow

    y' = r - r_u N d,          r = m_Y^-1 a,  d = S^-1 g
    z' = -rate d - S^-1 (g_Y y' + g_t),      u_Y' = y' - K z',  u_Z' = z'

has the solutions of the given equations on g = 0, which is invariant and attracts at the given rate (Baumgarte, Comput.
Methods Appl. Mech. Eng. 1 (1972) 1). Beside g = 0 the first line is that of the nearest state on it to first order.
So at an equilibrium the eigenvalues are those of the pencil (f_u, M), its infinite ones replaced by -rate; left
eigenvectors to the others are those of the pencil times M; and all coefficients on centre manifolds are those of the
equations reduced to the states with mass. Where S is singular the flow has a pole, and says so.

An invertible M gives u' = M^-1 f. Nothing is divided by but determinants (`symbolic.calculus.linear_solve`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Final

import numpy as np

from contin.abi import Array
from contin.errors import InputError
from contin.machine import elementary
from contin.model.evaluate import evaluate_all
from contin.model.expression import ONE, ZERO, Expression, add, mul, neg, number, sub, symbols_in
from contin.model.kept import kept_with
from contin.model.model import Model
from contin.model.parts import TIME, Constraints, VanishingMass
from contin.model.source import CallSource, Problems
from contin.model.symmetry import check_symmetries
from contin.symbolic.calculus.derivatives import sparse_jacobian
from contin.symbolic.calculus.linear_solve import BlockError, FormulaSolver, StructureError

BESIDE: Final = 1.37  # the rate is no power of two, that it be no eigenvalue of a model with simple numbers
SINGULAR: Final = 1e-11  # singular value (of a matrix with rows of length 1) that is zero
STEP: Final = 1e-6  # relative, of differences that estimate a rate
PLACES: Final = 4  # at which a matrix is singular, to be singular everywhere


def index_one(model: Model) -> Model:
    """The model itself where it declares no mass; else ordinary differential equations with `constraints`.

    Raises InputError, naming equations, where the index is above 1 or M has no constant rank.
    """
    if not getattr(model, "mass", None):  # also of bare equations, without the parts of a model
        return model
    return kept_with(model, "index_one", lambda: _checked(_reduced(model)))


def _checked(model: Model) -> Model:
    """Its declared symmetries compared with its equations, which only now are those of a flow."""
    if model.symmetries:
        problems = Problems(CallSource(f"model {model.name}"))
        parts = {name: getattr(model, name) for name in ("symmetries", "states", "equations", "parameters", "kind")}
        check_symmetries({**parts, "forcing": model.forcing}, problems)
        problems.raise_if_any()
    return model


@dataclass(frozen=True, eq=False)
class Split:
    """m u' = a (rows `moving`), 0 = g (rows `still`): positions of the equations, and of the states y and z."""

    moving: tuple[int, ...]
    still: tuple[int, ...]
    y: tuple[int, ...]
    z: tuple[int, ...]
    mass: tuple[tuple[Expression, ...], ...]  # (n, n)


def mass_matrix(model: Model) -> tuple[tuple[Expression, ...], ...]:
    """M, (n, n): rows that are not declared are those of the identity."""
    names = model.state_names
    rows = []
    for k, name in enumerate(names):
        row = model.mass.get(name)
        rows.append(tuple(ONE if j == k else ZERO for j in range(len(names))) if row is None
                    else tuple(row.get(other, ZERO) for other in names))  # fmt: skip
    return tuple(rows)


def _split(model: Model) -> Split:
    matrix = mass_matrix(model)
    n = len(matrix)
    still = tuple(k for k in range(n) if all(entry is ZERO for entry in matrix[k]))
    moving = tuple(k for k in range(n) if k not in still)
    values, generator = model.default_parameters(), np.random.default_rng(1)
    others = {name: v or float(generator.uniform(0.5, 1.5)) for name, v in values.items()}  # a mass eps, here 0
    y = None
    for known in (values, others):
        rows = np.array([evaluate_all(matrix[k], known) for k in moving], dtype=float).reshape(len(moving), n)
        y = y or _pivots(rows, moving)
    if y is None:
        names = ", ".join(model.state_names[k] for k in moving)
        raise InputError(
            f"model {model.name}, mass: the rows {names} of the mass matrix depend on each other (at the parameters' "
            "values); combine these equations so that the algebraic ones have rows of zeros, such as `mass: {w: 0}`"
        )
    return Split(moving, still, y, tuple(k for k in range(n) if k not in y), matrix)


def _pivots(rows: Array, prefer: Sequence[int]) -> tuple[int, ...] | None:
    """Columns in which the rows are invertible: their own where that serves; None where the rows are dependent."""
    left = rows.copy()
    chosen: list[int] = []
    for k in range(len(left)):
        sizes = np.abs(left[k])
        sizes[chosen] = 0.0
        if not sizes.max(initial=0.0) > SINGULAR * np.abs(rows[k]).max(initial=0.0):
            return None
        own = prefer[k] not in chosen and sizes[prefer[k]] > 1e-3 * sizes.max()
        c = prefer[k] if own else int(np.argmax(sizes))
        chosen.append(c)
        for other in range(len(left)):
            if other != k:
                left[other] -= left[other, c] / left[k, c] * left[k]
    return tuple(chosen)


def _reduced(model: Model) -> Model:
    if model.kind != "flow":
        raise InputError(f"model {model.name}: `mass` belongs to kind: flow; this is kind: {model.kind}")
    names, split = model.state_names, _split(model)
    coefficients = FormulaSolver.of([[split.mass[i][j] for j in split.y] for i in split.moving])
    rates = coefficients.solve([model.equations[i] for i in split.moving])
    vanishing = _vanishing(model, split, coefficients)
    if not split.still:
        equations = dict(zip(split.y, rates, strict=True))
        return model.replace(equations=tuple(equations[k] for k in range(len(names))), mass={}, vanishing=vanishing)
    spread = [coefficients.solve([split.mass[i][j] for i in split.moving]) for j in split.z]  # columns of K
    g = [model.equations[i] for i in split.still]
    slopes = sparse_jacobian(g, names)

    def along(entries: Mapping[tuple[int, int], Expression], i: int, k: int) -> Expression:
        """Entry (i, k) of A N, for a Jacobian A."""
        terms = [entries.get((i, split.z[k]), ZERO)]
        terms += [neg(mul(entries.get((i, j), ZERO), spread[k][m])) for m, j in enumerate(split.y)]
        return add(*(t for t in terms if t is not ZERO)) if any(t is not ZERO for t in terms) else ZERO

    count = range(len(split.z))
    matrix = [[along(slopes, i, k) for k in count] for i in count]
    solver = _solver(model, split, matrix)
    step = solver.solve(g)
    by_states = sparse_jacobian(rates, names)
    drift = [
        sub(rate, add(*(mul(along(by_states, i, k), step[k]) for k in count))) for i, rate in enumerate(rates)
    ]  # fmt: skip
    known = [add(*(mul(slopes.get((i, j), ZERO), drift[m]) for m, j in enumerate(split.y))) for i in count]
    if model.forcing is not None:
        by_time = sparse_jacobian(g, [TIME])
        known = [add(value, by_time.get((i, 0), ZERO)) for i, value in enumerate(known)]
    follow = solver.solve(known)
    rate = _rate(model, split, drift)
    falling = [sub(neg(mul(number(rate), step[k])), follow[k]) for k in count]
    equations = dict(zip(split.z, falling, strict=True)) | {
        j: sub(drift[m], add(*(mul(spread[k][m], falling[k]) for k in count))) for m, j in enumerate(split.y)
    }
    correction = dict(zip(split.z, step, strict=True)) | {
        j: neg(add(*(mul(spread[k][m], step[k]) for k in count))) for m, j in enumerate(split.y)
    }
    massless = tuple(names[j] for j in split.z if all(row[j] is ZERO for row in split.mass))
    order = range(len(names))
    constraints = Constraints(
        tuple(names[i] for i in split.still), tuple(g), massless, tuple(correction[k] for k in order),
        solver.determinant, rate,
    )  # fmt: skip
    return model.replace(
        equations=tuple(equations[k] for k in order), mass={}, constraints=constraints, vanishing=vanishing
    )


def _vanishing(model: Model, split: Split, coefficients: FormulaSolver) -> tuple[VanishingMass, ...]:
    """The determinants of M's blocks that depend on parameters, each with the states of its equations."""
    blocks = zip(coefficients.blocks, coefficients.determinants, strict=True)
    return tuple(
        VanishingMass(tuple(model.state_names[split.moving[r]] for r in rows), determinant)
        for (rows, _), determinant in blocks
        if symbols_in([determinant])
    )


def _solver(model: Model, split: Split, matrix: Sequence[Sequence[Expression]]) -> FormulaSolver:
    """Of S; the equations that keep it from being regular are named."""
    names = [model.state_names[i] for i in split.still]
    free = ", ".join(model.state_names[j] for j in split.z)
    try:
        solver = FormulaSolver.of(matrix)
    except StructureError as error:
        raise InputError(_too_high(model, [names[r] for r in error.rows], free)) from None
    except BlockError as error:
        raise InputError(f"model {model.name}, mass: of the algebraic equations {', '.join(names)}, {error}") from None
    guilty: list[str] = []
    for place in range(PLACES):
        values = _values(model, place)
        here = np.array([evaluate_all(row, values) for row in matrix], dtype=float)
        lengths = np.linalg.norm(here, axis=1)
        if not np.all(np.isfinite(here)):
            return solver
        if np.all(lengths > 0.0):
            left, singular, _ = np.linalg.svd(here / lengths[:, None])
            if singular[-1] > SINGULAR:
                return solver
            guilty = [name for name, part in zip(names, left[:, -1], strict=True) if abs(part) > 1e-6]
        else:
            guilty = [name for name, length in zip(names, lengths, strict=True) if length == 0.0]
    raise InputError(_too_high(model, guilty, free))


def _too_high(model: Model, equations: Sequence[str], free: str) -> str:
    """Why the index is above 1."""
    several = len(equations) > 1
    which = f"equations {', '.join(equations)} do" if several else f"equation {equations[0]} does"
    return (
        f"model {model.name}, mass: the index is above 1: the algebraic {which} not determine the algebraic states "
        f"({free}), whatever the values are. Differentiate {'them' if several else 'it'} by time, insert the other "
        "equations, and write what follows in place of it"
    )


def _values(model: Model, place: int) -> dict[str, float]:
    """Parameters and states at the start, and at other places (fixed, without meaning)."""
    u, p = model.start_point()
    generator = np.random.default_rng(place)
    if place:
        u = u + generator.uniform(-1.0, 1.0, u.size) * np.maximum(np.abs(u), 1.0)
    values = dict(zip((*model.state_names, *model.parameter_names), [*u.tolist(), *p.tolist()], strict=True))
    return values | {TIME: 0.1 * place}


def _rate(model: Model, split: Split, drift: Sequence[Expression]) -> float:
    """About the largest rate of the reduced equations at the start: it turns with the unit of time; 1 without one."""
    for place in range(PLACES):
        values = _values(model, place)
        rows = []
        for j in split.y:
            name = model.state_names[j]
            h = STEP * max(abs(values[name]), STEP)
            ends = [evaluate_all(drift, values | {name: values[name] + side * h}) for side in (1.0, -1.0)]
            with np.errstate(invalid="ignore"):  # next to a singularity there are no rates: another place is taken
                rows.append((np.array(ends[0], dtype=float) - np.array(ends[1], dtype=float)) / (2.0 * h))
        if rows and np.all(np.isfinite(rows)):
            largest = float(np.abs(np.linalg.eigvals(np.array(rows))).max())
            if largest > 0.0 and isfinite(largest):
                return BESIDE * float(elementary.exp2(np.rint(elementary.log2(largest))))
    return BESIDE
