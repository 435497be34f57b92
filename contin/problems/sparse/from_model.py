"""Large models made of formulas as functions with a sparse Jacobian: the sparsity is that of the formulas."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.linalg.csc import filled
from contin.lowering.alike import Alike
from contin.lowering.switching import switching_functions
from contin.model.explain import explain_not_finite
from contin.model.expression import depends_on, symbol, symbols_in
from contin.model.kept import kept_with
from contin.model.model import Model
from contin.systems.functions.function_problem import FunctionProblem

LARGE: Final = 150  # states from which sparse factors are quicker than dense kernels, measured on chains and grids
SPARSE: Final = 0.1  # entries of the Jacobian, as a part of all, above which dense kernels are taken


class _Formulas:
    """The formulas of a model by shapes, and the order in which their slopes stand in a CSC matrix."""

    def __init__(self, model: Model) -> None:
        names, parameters = model.state_names, model.parameter_names
        self.equations = Alike(model.equations, names, parameters)
        self.observables = Alike(tuple(model.observables.values()), names, parameters)
        self.images = {
            s.name: Alike([s.map.get(name, symbol(name)) for name in names], names, parameters)
            for s in model.symmetries
        }

    def matrix(self, u: Array, p: Array) -> Any:
        """dF/du as a CSC matrix."""
        pattern, order = self._pattern
        return filled(pattern, self.equations.slopes(u, p)[order])

    @cached_property
    def _pattern(self) -> tuple[Any, NDArray[np.intp]]:
        """The pattern as a CSC matrix, and where each of its entries stands in `slopes`."""
        from scipy.sparse import csc_matrix

        rows, columns = self.equations.pattern
        n = self.equations.n
        pattern = csc_matrix((np.arange(1.0, len(rows) + 1.0), (rows, columns)), shape=(n, n))
        pattern.sort_indices()
        return pattern, pattern.data.astype(np.intp) - 1


def sparse_function(model: Model, u: Array, p: Array) -> FunctionProblem | None:
    """The model as a function with a sparse Jacobian, started at (u, p); None where dense kernels serve it better.

    That is so below `LARGE` states, for maps, forced and piecewise flows, masses, angles that turn, and where the
    Jacobian is not sparse.
    """
    formulas = _formulas_of(model)
    if formulas is None:
        return None
    names = model.parameter_names

    def ordered(values: Mapping[str, float]) -> Array:
        return np.array([values[name] for name in names])

    def derivative(u: Array, values: Mapping[str, float], *directions: Array) -> Array:
        return formulas.equations.form(u, ordered(values), directions)

    def parameter_jacobian(u: Array, values: Mapping[str, float], name: str) -> Array:
        return formulas.equations.parameter_slopes(u, ordered(values))[:, names.index(name)]

    def record(u: Array, values: Mapping[str, float]) -> dict[str, float]:
        found = formulas.observables.value(u, ordered(values))
        return dict(zip(model.observables, found.tolist(), strict=True))

    def explain(u: Array, p: Array) -> str | None:
        return _explained(model, formulas, u, p)

    bounds = {name: model.parameter_range(name) for name in names}
    return FunctionProblem(
        lambda u, values: formulas.equations.value(u, ordered(values)),
        u,
        dict(zip(names, p.tolist(), strict=True)),
        lambda u, values: formulas.matrix(u, ordered(values)),
        parameter_jacobian=parameter_jacobian,
        derivative=derivative,
        record=record if model.observables else None,
        states=model.state_names,
        periods={s: float(t) for s, t in zip(model.state_names, model.periods(), strict=True) if t > 0.0},
        ranges={name: pair for name, pair in bounds.items() if pair is not None},
        symmetries={name: _image(alike, p) for name, alike in formulas.images.items()},
        name=model.name,
        title=model.title,
        source=model.source,
        written=model,
        explain=explain,
    )


def _image(alike: Alike, p: Array) -> Callable[[Array], Array]:
    return lambda u: alike.value(np.asarray(u, dtype=float), p)


def is_large(model: Model) -> bool:
    """True where `sparse_function` makes something of a model."""
    return _formulas_of(model) is not None


def _formulas_of(model: Model) -> _Formulas | None:
    if not isinstance(model, Model) or len(model.states) < LARGE:
        return None
    return kept_with(model, "formulas", lambda: _Formulas(model) if _is_sparse_flow(model) else None)


def _is_sparse_flow(model: Model) -> bool:
    if model.kind != "flow" or model.forcing is not None or model.rotation or model.limits or model.mass:
        return False
    if any(state.minimum is not None for state in model.states):
        return False
    if any(depends_on(e, model.parameter_names) for s in model.symmetries for e in s.map.values()):
        return False
    most, entries = SPARSE * len(model.state_names) ** 2, 0
    for equation in model.equations:
        entries += len(symbols_in([equation]))
        if entries > most:
            return False
    return not switching_functions(model.equations, (*model.state_names, *model.parameter_names))


def _explained(model: Model, formulas: _Formulas, u: Array, p: Array) -> str | None:
    """Which equation is not finite at this point and why; None if all are."""
    bad = np.flatnonzero(~np.isfinite(formulas.equations.value(u, p)))
    if not len(bad):
        return None
    name = model.state_names[int(bad[0])]
    values = dict(zip((*model.state_names, *model.parameter_names), [*u.tolist(), *p.tolist()], strict=True))
    reason = explain_not_finite({name: model.equations[int(bad[0])]}, values)
    return f"not finite at this point: {reason or f'equation {name}'}"
