"""`PdeProblem`: a discretised partial differential equation, an ordinary large sparse system of every verb."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from scipy.sparse import csc_matrix

from contin.abi import Array
from contin.errors import InputError
from contin.model.advice import closest
from contin.model.expression import Expression
from contin.model.parts import Parameter, Start
from contin.model.values import parameter_values
from contin.pde.arrays import ArrayFormulas
from contin.pde.equations import Discretised
from contin.pde.frame import Travelling
from contin.pde.measures import Observer
from contin.pde.protocol import Equations
from contin.records import Fields, Record
from contin.systems.functions.function_problem import FunctionProblem
from contin.systems.functions.moving_frame import MovingFrame

Reader = Callable[[Record], Start]


class PdeProblem(FunctionProblem):
    """u' = F(u, p) on the unknown values of fields at nodes; `profile` gives the fields of a solution.

    Starts are named, or mappings of fields to formulas in coordinates and parameters, or vectors (n,).
    """

    def __init__(
        self,
        discretised: Equations,
        observer: Observer,
        parameters: Sequence[Parameter],
        starts: Sequence[Start],
        guess: Start,
        read_start: Reader,
        described: Record,
        velocity: str | None = None,
    ) -> None:
        self.discretised, self._read_start = discretised, read_start
        self._formulas = tuple(parameters)
        values = parameter_values(self._formulas, [])
        self._guess = guess
        self.fields = discretised.unknowns.fields
        grid = discretised.grid
        where = np.empty(discretised.n, object)
        for field in self.fields:
            free = discretised.unknowns.free[field]
            places = zip(*(grid.coordinates[axis.name][free] for axis in grid.axes), strict=True)
            for place, x in zip(discretised.unknowns.places[field], places, strict=True):
                where[place] = field, x
        self._where = where
        names = list(values)

        def derivative(u: Array, p: Mapping[str, float], *directions: Array) -> Array:
            n = discretised.n
            split = [(d[:n], dict(zip(names, d[n:].tolist(), strict=True))) for d in directions]
            return discretised.forms(u, p, split)

        def parameter_jacobian(u: Array, p: Mapping[str, float], name: str) -> Array:
            return discretised.forms(u, p, [(np.zeros(discretised.n), {name: 1.0})])

        def record(u: Array, p: Mapping[str, float]) -> dict[str, float]:
            assert velocity is not None
            assert isinstance(discretised, Travelling)
            return {**observer(u, p), velocity: float(discretised.velocity(u, p))}

        bounds = {q.name: q.range for q in parameters if q.range is not None}
        numbers = {name: tuple(evaluated(pair, values)) for name, pair in bounds.items()}
        super().__init__(
            discretised.value,
            self._vector(guess, values),
            values,
            discretised.jacobian,
            parameter_jacobian=parameter_jacobian,
            derivative=derivative,
            record=observer if velocity is None else record,
            states=[f"{field}[{k}]" for k, (field, _) in enumerate(where)],
            ranges={name: (pair[0], pair[1]) for name, pair in numbers.items()},
            explain=self._explained,
            **described,
        )
        self.state_names = ()
        if isinstance(discretised, Travelling):
            assert velocity is not None
            self.frame = MovingFrame(velocity, discretised.weight, "write another wave under travelling.like")
        self.starts = tuple(starts)

    def at_states(self, u: Array, p: Mapping[str, float]) -> Array:
        """F (n, K) at K states u (n, K), in one go."""
        return self.discretised.value(u, p)

    def jacobians_at(self, u: Array, p: Mapping[str, float]) -> list[csc_matrix]:
        """dF/du at K states u (n, K)."""
        return self.discretised.jacobians(u, p)

    def parameter_slopes_at(self, u: Array, p: Mapping[str, float], name: str) -> Array:
        """dF/dp_name (n, K) at K states u (n, K)."""
        return self.discretised.forms(u, p, [(np.zeros(u.shape), {name: 1.0})])

    @property
    def axes(self) -> tuple[str, ...]:
        """Names of the coordinates."""
        return tuple(axis.name for axis in self.discretised.grid.axes)

    @property
    def starting_names(self) -> tuple[str, ...]:
        """What a start may give."""
        return self.fields

    def default_parameters(self, overrides: Record | None = None) -> dict[str, float]:
        """Values of all parameters with overrides, which may be formulas."""
        return parameter_values(self._formulas, [overrides or {}])

    def start_point(
        self, start: Any = None, parameters: Record | None = None, finite: bool = True
    ) -> tuple[Array, Array]:
        """Vectors u (n,) and p (m,): `start` is None (the fields' own), a name, a mapping of fields, or a vector."""
        chosen: Start | None = None
        if start is None:
            chosen = self._guess
        elif isinstance(start, str):
            chosen = next((s for s in self.starts if s.name == start), None)
            if chosen is None:
                known = [s.name for s in self.starts]
                listed = f"there are {', '.join(known)}" if known else "it declares no starts"
                advice = closest(start, known) or listed
                raise InputError(f"{self.name} has no start {start!r}: {advice}")
        elif isinstance(start, Mapping):
            chosen = self._read_start(start)
        if chosen is None:
            values = self.default_parameters(parameters)
            return super().start_point(start, values)
        values = parameter_values(self._formulas, [chosen.parameters, parameters or {}])
        return self._vector(chosen, values), np.array(list(values.values()))

    def _vector(self, start: Start, p: Mapping[str, float]) -> Array:
        u = sampled(self.discretised, {f: start.states.get(f, self._guess.states[f]) for f in self.fields}, p)
        if not np.all(np.isfinite(u)):
            field, x = self._where[int(np.flatnonzero(~np.isfinite(u))[0])]
            raise InputError(f"{self.name}: the start of {field} is not finite at {self._place(x)}")
        return u

    def _place(self, x: Sequence[float]) -> str:
        return ", ".join(f"{name} = {value:.6g}" for name, value in zip(self.axes, x, strict=True))

    def _explained(self, u: Array, p: Array) -> str | None:
        """Which equation is not finite, and where."""
        values = dict(zip(self.parameter_names, p.tolist(), strict=True))
        with np.errstate(all="ignore"):
            bad = np.flatnonzero(~np.isfinite(self.discretised.value(u, values)))
        if not len(bad):
            return None
        if isinstance(self.discretised, Travelling) and not self.discretised.moves(u):
            return "the start does not change along the axis of `travelling`: it has no velocity"
        if isinstance(self.discretised, Travelling) and not np.isfinite(self.discretised.velocity(u, values)):
            return (
                "the state has no phase in the frame of `travelling`, <w_x, u_x> = 0 for the wave w under `like`: "
                "write one that is nearer to it"
            )
        field, x = self._where[int(bad[0])]
        return f"the equation of {field} is not finite at {self._place(x)}"

    def advice(self, u: Array) -> str:
        if not isinstance(self.discretised, Discretised):
            return ""
        axis = self.discretised.shifted_along(u)
        return "" if axis is None else (
            f" States that change along {axis} come in families, for no equation does: translations along {axis} lead "
            f"to others, and the Jacobian is singular at each. `travelling: {{axis: {axis}, like: ...}}` in the model "
            "follows one of each family, with its velocity (0 where it stands)"
        )

    def in_frame(self, states: Array) -> Array:
        """Samples (K, n) of an orbit, of the equations as they are written, in the frame of `travelling`."""
        return self.discretised.in_phase(states) if isinstance(self.discretised, Travelling) else states

    def profile(self, u: Array, p: Mapping[str, float]) -> dict[str, Array]:
        """Coordinates of the axes' nodes, and every field on the grid, (points,) or (points, points)."""
        grid = self.discretised.grid
        fields = self.discretised.fields(np.asarray(u, dtype=float), p)
        nodes = {axis.name: axis.nodes for axis in grid.axes}
        return {**nodes, **{name: values.reshape(grid.shape) for name, values in fields.items()}}

    def text(self) -> str:
        """What a store keeps of it."""
        sizes = " x ".join(str(n) for n in self.discretised.grid.shape)
        return f"# {sizes} nodes\n{super().text()}"


def sampled(d: Equations, formulas: Mapping[str, Expression], p: Mapping[str, float]) -> Array:
    """The unknowns (n,) of fields that formulas give."""
    u = np.empty(d.n)
    for field, formula in formulas.items():
        free = d.unknowns.free[field]
        at = {name: x[free] for name, x in d.grid.coordinates.items()}
        u[d.unknowns.places[field]] = ArrayFormulas([formula])({**p, **at}, len(free))[0]
    return u


def evaluated(formulas: Sequence[Expression], values: Fields) -> list[float]:
    """Formulas in parameters, in numbers."""
    return [float(x[0]) for x in ArrayFormulas(formulas)(values, 1)]
