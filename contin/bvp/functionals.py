"""Columns of a branch of boundary-value problems: end values, extrema and norms of the states, and observables."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.machine import elementary
from contin.model.evaluate import evaluate
from contin.model.expression import Expression
from contin.problems.orbits.measured.columns import of_one_size
from contin.problems.orbits.mesh.layout import node_weights
from contin.problems.orbits.mesh.peaks import extrema

if TYPE_CHECKING:
    from contin.bvp.boundary_equations import BoundaryEquations


def columns_of(problem: BoundaryEquations, z: Array, p: Array | None = None) -> dict[str, Array]:
    """The varying parameter, the free ones, NAME.start, .end, .min, .max, .norm of each state, observables.

    norm = sqrt(mean(x^2)) over the interval.  p : full parameters of each row, where others vary than in `problem`.
    """
    two, rows = problem.two, len(z)
    p = np.array([problem.full_parameters(row) for row in z]) if p is None else p
    columns: dict[str, Array] = {problem.parameters[0]: z[:, -1].copy()}
    names = [*two.free, *(f"{s}.{e}" for s in two.model.state_names for e in ("start", "end", "min", "max", "norm"))]
    columns.update({name: np.empty(rows) for name in [*names, *two.model.observables]})
    for chosen, same in of_one_size(z):
        _fill(problem, same, p[chosen], {name: (column, chosen) for name, column in columns.items()})
    return columns


def own_column(problem: BoundaryEquations, name: str, z: Array) -> Array:
    """One column: a parameter is read from the unknowns, others come with all."""
    two = problem.two
    if name == problem.parameters[0]:
        return z[:, -1].copy()
    if name not in two.free:
        return problem.columns(z)[name]
    k = two.n_states + two.free.index(name)  # a constant function on the interval
    return np.asarray(z[:, k].copy())


def functions_at(problem: BoundaryEquations, z: Array) -> dict[str, Array]:
    """The independent variable as `t`, and the states, at the nodes of a solution."""
    two, profile = problem.two, problem.profile(z)
    values = dict(zip(two.parameters, problem.full_parameters(z)[:-1].tolist(), strict=True))
    values.update({name: float(profile.u[0, two.n_states + k]) for k, name in enumerate(two.free)})
    interval = two.model.interval
    assert interval is not None
    t = _evaluated(interval.start, values) + _evaluated(two.length, values) * profile.times
    return {"t": t, **dict(zip(two.model.state_names, profile.u.T[: two.n_states], strict=True))}


def _fill(problem: BoundaryEquations, z: Array, p: Array, out: dict[str, tuple[Array, NDArray[np.intp]]]) -> None:
    two, m = problem.two, problem.points
    first = problem.profile(z[0])
    u = z[:, : first.u.size].reshape(len(z), -1, first.n)
    weights = np.array([node_weights(problem.profile(row).h, m) for row in z])  # (R, K)
    low, high = extrema(u, m)
    norms = np.sqrt(np.einsum("rk,rki->ri", weights, u * u))

    def put(name: str, values: Array) -> None:
        column, chosen = out[name]
        column[chosen] = values

    for k, name in enumerate(two.model.state_names):
        found = {"start": u[:, 0, k], "end": u[:, -1, k], "min": low[:, k], "max": high[:, k], "norm": norms[:, k]}
        for part, values in found.items():
            put(f"{name}.{part}", values)
    for k, name in enumerate(two.free):
        put(name, u[:, 0, two.n_states + k])
    if two.model.observables:
        numbers = _numbers(problem, z, p, u, weights)
        for name, expression in two.model.observables.items():
            put(name, np.array([_evaluated(expression, row) for row in numbers]))


def _evaluated(expression: Expression, values: dict[str, float]) -> float:
    return float(evaluate(expression, values))


def _numbers(problem: BoundaryEquations, z: Array, p: Array, u: Array, weights: Array) -> list[dict[str, float]]:
    """For each row, the values of parameters and functionals by name."""
    two, m = problem.two, problem.points
    inner = _inner_values(problem, z, p, u)  # (R, K, k)
    low, high = extrema(inner, m) if two.inner else (inner[:, 0], inner[:, 0])
    mean = np.einsum("rk,rki->ri", weights, inner)
    square = np.einsum("rk,rki->ri", weights, inner * inner)
    rows = []
    for r, row in enumerate(p):
        values = dict(zip(two.parameters, row[:-1].tolist(), strict=True))
        values.update({name: float(u[r, 0, two.n_states + k]) for k, name in enumerate(two.free)})
        length = float(evaluate(two.length, values))
        for k, name in enumerate(two.inner):
            values[name] = {
                "max": float(high[r, k]), "min": float(low[r, k]), "mean": float(mean[r, k]),
                "integral": length * float(mean[r, k]), "norm": float(elementary.pow(square[r, k], 0.5)),
            }[two.model.functionals[name].kind]  # fmt: skip
        for name, functional in two.model.functionals.items():
            if functional.kind in ("start", "end"):
                state = two.model.state_names.index(str(functional.inner.value))
                values[name] = float(u[r, 0 if functional.kind == "start" else -1, state])
        rows.append(values)
    return rows


def _inner_values(problem: BoundaryEquations, z: Array, p: Array, u: Array) -> Array:
    """The functions inside functionals at the nodes, (R, K, k)."""
    two = problem.two
    if not two.inner:
        return np.zeros((*u.shape[:2], 0))
    rows, nodes, n = u.shape
    p = np.repeat(p, nodes, axis=0)
    p[:, -1] = np.concatenate([problem.profile(row).times for row in z])
    values = two.system.observables(np.ascontiguousarray(u.reshape(-1, n)), p)
    return np.asarray(values).reshape(rows, nodes, -1)
