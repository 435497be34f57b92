"""Columns of a branch of boundary-value problems: end values, extrema and norms of the states, and observables."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.machine import elementary
from contin.model.evaluate import evaluate, evaluate_all
from contin.model.expression import Expression
from contin.problems.orbits.measured.columns import of_one_size
from contin.problems.orbits.mesh.layout import node_times, node_weights
from contin.problems.orbits.mesh.peaks import extrema

if TYPE_CHECKING:
    from contin.bvp.boundary_equations import BoundaryEquations

PARTS: Final = ("start", "end", "min", "max", "norm")  # of a state: its columns


def columns_of(
    problem: BoundaryEquations, z: Array, p: Array | None = None, wanted: Sequence[str] | None = None
) -> dict[str, Array]:  # fmt: skip
    """The varying parameter, the free ones, NAME.start, .end, .min, .max, .norm of each state, observables.

    norm = sqrt(mean(x^2)) over the interval.  p : full parameters of each row, where others vary than in `problem`.
    wanted : some of these columns but the first, where not all are to be computed.
    """
    two, rows = problem.two, len(z)
    p = np.array([problem.full_parameters(row) for row in z]) if p is None else p
    columns: dict[str, Array] = {problem.parameters[0]: z[:, -1].copy()}
    names = [*two.free, *(f"{s}.{e}" for s in two.model.state_names for e in PARTS), *two.model.observables]
    if wanted is not None:
        if unknown := [name for name in wanted if name not in names]:
            raise KeyError(unknown[0])
        names = list(wanted)
    columns.update({name: np.empty(rows) for name in names})
    for chosen, same in of_one_size(z):
        _fill(problem, same, p[chosen], {name: (columns[name], chosen) for name in names})
    return columns


def own_column(problem: BoundaryEquations, name: str, z: Array) -> Array:
    """One column: a parameter is read from the unknowns, others are computed alone."""
    two = problem.two
    if name == problem.parameters[0]:
        return z[:, -1].copy()
    if name not in two.free:
        return columns_of(problem, z, None, [name])[name]
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
    """The columns that `out` has, of rows of one size."""
    two = problem.two
    first = problem.profile(z[0])
    u = z[:, : first.u.size].reshape(len(z), -1, first.n)

    def put(name: str, values: Array) -> None:
        if name in out:
            column, chosen = out[name]
            column[chosen] = values

    ends = {"start": u[:, 0], "end": u[:, -1]}
    if any(f"{state}.{part}" in out for state in two.model.state_names for part in PARTS[len(ends) :]):
        ends["min"], ends["max"] = extrema(u, problem.points)
        ends["norm"] = np.sqrt(np.einsum("rk,rki->ri", _each(problem, z, node_weights), u * u))
    for k, state in enumerate(two.model.state_names):
        for part, values in ends.items():
            put(f"{state}.{part}", values[:, k])
    for k, name in enumerate(two.free):
        put(name, u[:, 0, two.n_states + k])
    observed = {name: formula for name, formula in two.model.observables.items() if name in out}
    if observed:
        numbers = _numbers(problem, z, p, u)
        found = [evaluate_all(observed.values(), row) for row in numbers]
        for k, name in enumerate(observed):
            put(name, np.array([float(row[k]) for row in found]))


def _each(problem: BoundaryEquations, z: Array, function: Callable[[Array, int], Array]) -> Array:
    """A function of mesh and points an interval for each row, (R, ..); the mesh of all of them is mostly the same."""
    meshes = z[:, -1 - problem.profile(z[0]).intervals : -1]
    if np.all(meshes == meshes[0]):
        return np.repeat(function(meshes[0], problem.points)[None], len(z), axis=0)
    return np.array([function(h, problem.points) for h in meshes])


def _evaluated(expression: Expression, values: dict[str, float]) -> float:
    return float(evaluate(expression, values))


def _numbers(problem: BoundaryEquations, z: Array, p: Array, u: Array) -> list[dict[str, float]]:
    """For each row, the values of parameters and functionals by name."""
    two, m = problem.two, problem.points
    inner = _inner_values(problem, z, p, u)  # (R, K, k)
    kinds = {two.model.functionals[name].kind for name in two.inner}
    none = inner[:, 0]
    low, high = extrema(inner, m) if not kinds.isdisjoint(("min", "max")) else (none, none)
    weights = _each(problem, z, node_weights)
    mean = np.einsum("rk,rki->ri", weights, inner)
    square = np.einsum("rk,rki->ri", weights, inner * inner) if "norm" in kinds else none
    rows = []
    for r, row in enumerate(p):
        values = dict(zip(two.parameters, row[:-1].tolist(), strict=True))
        values.update({name: float(u[r, 0, two.n_states + k]) for k, name in enumerate(two.free)})
        length = float(evaluate(two.length, values)) if "integral" in kinds else 0.0
        for k, name in enumerate(two.inner):
            kind = two.model.functionals[name].kind
            if kind == "norm":
                values[name] = float(elementary.pow(square[r, k], 0.5))
            elif kind == "integral":
                values[name] = length * float(mean[r, k])
            else:
                values[name] = float({"max": high, "min": low, "mean": mean}[kind][r, k])
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
    p[:, -1] = _each(problem, z, node_times).ravel()
    values = two.system.observables(np.ascontiguousarray(u.reshape(-1, n)), p)
    return np.asarray(values).reshape(rows, nodes, -1)
