"""A user's Python function as it is given, checked."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal, Self

import numpy as np
from numpy.typing import ArrayLike

from contin.abi import Array, Vector
from contin.errors import InputError, NotFiniteError
from contin.model.expression import number
from contin.model.parts import Expectation, Start
from contin.records import Record
from contin.systems.functions.foreign_arrays import Elsewhere
from contin.systems.functions.guarded import called, numbers
from contin.systems.functions.mass import Divided, Mass, as_sparse
from contin.systems.functions.moving_frame import MovingFrame
from contin.systems.functions.names import check_name, check_names
from contin.systems.functions.rotation import Rotation

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

    from contin.model.model import Model
    from contin.model.parts import Expectation

NAMED = 50  # up to this number, states are columns of their own
DENSE = 200  # without a Jacobian or its sparsity, a dense one is differenced up to this number of states
Values = Mapping[str, float]
Method = Literal["dense", "sparse", "matrix-free"]


@dataclass(frozen=True)
class Named:
    """A state or parameter as reports and files describe it."""

    name: str
    unit: str | None = None


@dataclass(frozen=True, eq=False)
class FunctionSymmetry:
    """A map of states (n,) -> (n,) that takes solutions to solutions."""

    name: str
    map: Callable[[Array], ArrayLike]


class GivenFunction:
    """What a user gives of a function, and what verbs and reports ask of it as of a model; see `FunctionProblem`."""

    forcing = None
    interval = None
    starts: tuple[Start, ...] = ()
    uses_time = False
    averaging = None
    measured_names: tuple[str, ...] = ()  # of states whose columns are those of the record, see `measured`
    # what only formulas have: none here
    functions: Mapping[str, str] = {}
    labels: Mapping[str, str] = {}
    mass: Mapping[str, float] = {}
    mass_matrix: csc_matrix | None = None  # of M u' = F, where the functions are not divided by it
    equations: tuple[()] = ()
    frame: MovingFrame | None = None  # that it is seen from, where it is not at rest

    def __init__(
        self,
        residual: Callable[[Vector, Any], ArrayLike],
        u0: ArrayLike,
        parameters: Values,
        jacobian: Callable[[Array, Any], Any] | None = None,
        *,
        kind: Literal["flow", "map"] = "flow",
        parameter_jacobian: Callable[[Array, Any, str], ArrayLike] | None = None,
        derivative: Callable[..., ArrayLike] | None = None,
        record: Callable[[Array, Any], Values] | None = None,
        states: Sequence[str] | None = None,
        periods: Values | None = None,
        ranges: Mapping[str, tuple[float, float]] | None = None,
        symmetries: Mapping[str, Callable[[Array], ArrayLike]] | None = None,
        rotation: object = None,
        sparsity: object = None,
        preconditioner: Callable[[Array, Any], Callable[[Array], ArrayLike]] | None = None,
        typical: ArrayLike = 1.0,
        arrays: tuple[Callable[..., Any], Callable[..., Any]] | None = None,
        name: str = "function",
        title: str | None = None,
        source: str | None = None,
        expect: Sequence[Record] = (),
        written: Model | None = None,
        explain: Callable[[Array, Array], str | None] | None = None,
        mass: object = None,
    ) -> None:
        self.residual, self.jacobian = residual, jacobian
        self.u0 = np.array(u0, dtype=float).ravel()
        self.n = self.u0.size
        if self.n == 0 or not np.all(np.isfinite(self.u0)):
            raise InputError(f"u0 must be a vector of at least one finite number; got shape {np.shape(u0)}")
        if kind not in ("flow", "map"):
            raise InputError(f"kind must be 'flow' or 'map'; got {kind!r}")
        self.kind = kind
        self.values = {key: float(value) for key, value in parameters.items()}
        self.parameter_names = tuple(self.values)
        if not self.values:
            raise InputError("parameters: at least one is needed, {name: value}")
        if states is not None and len(states) != self.n:
            raise InputError(f"states names {len(states)} states; u0 has {self.n}")
        default = tuple(f"u{k}" for k in range(self.n)) if self.n <= NAMED else ()
        self.state_names = tuple(states) if states is not None else default
        self._check_names(name, title, symmetries or {})
        self.parameter_jacobian, self.derivative, self.record = parameter_jacobian, derivative, record
        self.ranges = {name: (float(low), float(high)) for name, (low, high) in (ranges or {}).items()}
        self.symmetries = tuple(FunctionSymmetry(key, map_) for key, map_ in (symmetries or {}).items())
        self.rotation = self._rotation(rotation, periods)
        self.sparsity, self.preconditioner = sparsity, preconditioner
        if arrays is not None:
            self._computes_elsewhere(Elsewhere.of(arrays))
        self.typical = np.broadcast_to(np.asarray(typical, dtype=float), (self.n,))
        self.declared_sizes = np.zeros(self.n)  # of states about which their values say nothing; 0: they do
        self.name, self.title, self.source = name, title, source
        self.written, self.explain = written, explain
        self._expect = tuple(expect)
        self._periods = self._periods_of(periods or {})
        if mass is not None:
            self._weigh(Mass.of(mass, self.n))

    def _check_names(self, name: str, title: str | None, symmetries: Iterable[str]) -> None:
        check_names(parameters=self.parameter_names, states=self.state_names)
        for given, what in ((name, "name"), (title, "title"), *((key, "symmetries") for key in symmetries)):
            if given is not None:
                check_name(what, given, column=False)

    def _periods_of(self, periods: Values) -> Array:
        """Periods (n,) of states, 0 of those that are no angles."""
        found = np.zeros(self.n)
        for key, value in periods.items():
            found[self._state(key)] = value
        return found

    def _rotation(self, given: object, periods: Values | None) -> Rotation | None:
        if given is None:
            return None
        if self.kind == "map" or periods:
            raise InputError("rotation: of a flow whose states are no angles (periods); maps and angles have none here")
        return Rotation.of(given, self.n)

    def _computes_elsewhere(self, other: Elsewhere) -> None:
        self.residual = other.function(self.residual)
        self.jacobian = None if self.jacobian is None else other.product(self.jacobian, self.n)
        given = self.parameter_jacobian, self.derivative
        self.parameter_jacobian, self.derivative = (None if f is None else other.function(f) for f in given)
        self.record = None if self.record is None else other.record(self.record)
        self.preconditioner = None if self.preconditioner is None else other.preconditioner(self.preconditioner)
        self.symmetries = tuple(FunctionSymmetry(one.name, other.image(one.map)) for one in self.symmetries)

    def _weigh(self, mass: Mass) -> None:
        """The functions divided by M where that keeps their form; else M stays beside them, as `mass_matrix`."""
        if self.kind != "flow":
            raise InputError(f"function {self.name!r}: `mass` belongs to flows, M u' = F; this is kind: {self.kind}")
        if mass.is_regular and (mass.is_diagonal or self.method == "dense"):
            self._divide(mass)
            return
        if self.rotation is not None:
            raise InputError(
                f"function {self.name!r}: `rotation` beside a mass matrix that is not divided by (singular, or full "
                "beside a sparse Jacobian) is not done; leave one of the two out"
            )
        if self.method == "dense":
            if self.jacobian is None:
                self.sparsity = np.ones((self.n, self.n))
            else:
                self.jacobian = as_sparse(self.jacobian)
            del self.method
        self.mass_matrix = mass.matrix

    def _divide(self, mass: Mass) -> None:
        divided = Divided(mass, self.n)
        residual = divided.vectors(self.residual)
        assert residual is not None
        self.residual, self.jacobian = residual, divided.jacobian(self.jacobian)
        self.parameter_jacobian = divided.vectors(self.parameter_jacobian)
        self.derivative = divided.vectors(self.derivative)
        self.preconditioner = divided.preconditioner(self.preconditioner)
        self.mass_matrix = None

    @property
    def has_singular_mass(self) -> bool:
        """Whether there is a mass matrix that cannot be divided by."""
        return self.mass_matrix is not None and not Mass(self.mass_matrix).is_regular

    def divided(self) -> Self:
        """The same as u' = M^-1 F, dense; itself where no mass matrix is kept."""
        if self.mass_matrix is None:
            return self
        mass = Mass(self.mass_matrix)
        if not mass.is_regular:
            raise InputError(
                f"function {self.name!r} has a singular mass matrix ({mass.words}): what computes with u' = M^-1 F "
                "cannot take it. There are its equilibria, orbits from Hopf points or samples, their curves in two "
                "parameters, and trajectories by method='Radau'"
            )
        divided = copy(self)
        for kept in ("in_kernels", "method"):
            divided.__dict__.pop(kept, None)
        divided._divide(mass)
        return divided

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.name!r}: n = {self.n}, {self.method}>"

    @cached_property
    def method(self) -> Method:
        """How linear systems are solved: 'dense', 'sparse' or 'matrix-free'."""
        if self.jacobian is None:
            if self.sparsity is not None:
                return "sparse"
            return "dense" if self.n <= DENSE and self.preconditioner is None else "matrix-free"
        from scipy.sparse import issparse
        from scipy.sparse.linalg import LinearOperator

        matrix = called("Jacobian", self.jacobian, self.u0, dict(self.values))
        if issparse(matrix):
            return "sparse"
        if isinstance(matrix, LinearOperator):
            return "matrix-free"
        if self.preconditioner is not None:
            raise InputError(
                f"function {self.name!r}: jacobian returns an array, which is factored; a preconditioner needs a "
                "scipy.sparse matrix or a LinearOperator from it"
            )
        return "dense"

    # what verbs and reports ask of a model --------------------------------------------------------------------------

    @property
    def states(self) -> tuple[Named, ...]:
        """States with names."""
        return tuple(Named(s) for s in self.state_names)

    @property
    def parameters(self) -> tuple[Named, ...]:
        """All parameters."""
        return tuple(Named(p) for p in self.parameter_names)

    @cached_property
    def observables(self) -> dict[str, None]:
        """Names of what `record` gives."""
        if self.record is None:
            return {}
        return dict.fromkeys(numbers("record", called("function `record`", self.record, self.u0, dict(self.values))))

    @property
    def expect(self) -> tuple[Expectation, ...]:
        """The points that runs must find, as a model's."""

        def read(label: str, at: Any, run: Any = (), tolerance: float = 1e-8) -> Expectation:
            points = [at] if isinstance(at, Mapping) else at
            numbers = tuple({key: number(float(value)) for key, value in point.items()} for point in points)
            return Expectation(label, numbers, tolerance, (run,) if isinstance(run, Mapping) else tuple(run))

        return tuple(read(**entry) for entry in self._expect)

    def text(self) -> str:
        """What a store keeps of it: its name, size and parameters; the function itself is Python code."""
        values = ", ".join(f"{key}: {value!r}" for key, value in self.values.items())
        return f"# a Python function\nname: {self.name}\nunknowns: {self.n}\nparameters: {{{values}}}\n"

    def advice(self, u: Array) -> str:
        """What may help where no solution is found near u (n,), beside what always may; empty: nothing is known."""
        return ""

    def default_parameters(self, overrides: Record | None = None) -> dict[str, float]:
        """Values of all parameters with overrides."""
        unknown = sorted(set(overrides or {}) - set(self.values))
        if unknown:
            raise InputError(f"no parameter {', '.join(unknown)}; there are {', '.join(self.values) or 'none'}")
        return {**self.values, **{key: float(value) for key, value in (overrides or {}).items()}}

    def parameter_range(self, name: str, overrides: Record | None = None) -> tuple[float, float] | None:
        """Default range of a parameter."""
        return self.ranges.get(name)

    def periods(self, overrides: Record | None = None) -> Array:
        """Period of each state (n,), 0 where it is not an angle."""
        return self._periods

    def start_point(
        self, start: Any = None, parameters: Record | None = None, finite: bool = True
    ) -> tuple[Array, Array]:
        """Vectors u (n,) and p (m,): `start` is None (u0), a vector, or a mapping of states to values.

        finite : of a model's start that may have infinite values; a function's may not.
        """
        p = np.array(list(self.default_parameters(parameters).values()), dtype=float)
        if start is None:
            return self.u0.copy(), p
        if isinstance(start, str):
            raise InputError(f"a function has no named start {start!r}; give a vector or a mapping of states")
        if isinstance(start, Mapping):
            u = self.u0.copy()
            for key, value in start.items():
                u[self._state(key)] = float(value)
            return u, p
        u = np.array(start, dtype=float).ravel()
        if u.shape != (self.n,):
            raise InputError(f"a start must have {self.n} components; got {u.size}")
        if not np.all(np.isfinite(u)):
            raise NotFiniteError("the start is not finite")
        return u, p

    def _state(self, name: str) -> int:
        if name not in self.state_names:
            raise InputError(f"no state {name!r}; there are {', '.join(self.state_names) or 'only unnamed ones'}")
        return self.state_names.index(name)
