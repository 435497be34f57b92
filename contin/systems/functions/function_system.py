"""A user's function with all its derivatives: what a compiled system is to a model, without machine code."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from copy import copy
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import ArrayLike

from contin.abi import NO_FUNCTION, Array, Vector
from contin.errors import InputError, InputWarning, NotFiniteError, UserFunctionError
from contin.linalg.probed import ProbedMatrix
from contin.normalforms.jet import expand_complex
from contin.records import Fields
from contin.systems.functions import by_parameters, complex_steps
from contin.systems.functions.derivatives import Lines, is_analytic
from contin.systems.functions.grain import Grain
from contin.systems.functions.guarded import as_array, called, numbers, vector
from contin.systems.functions.stencils import STEPS
from contin.systems.functions.trials import BESIDE, not_analytic, real, try_function
from contin.systems.functions.trouble import Trouble
from contin.systems.protocol import form_by_form, one_by_one

if TYPE_CHECKING:
    from contin.systems.functions.given_function import GivenFunction
    from contin.systems.protocol import Limit

PROBED = 20  # states from which a Jacobian that is not given is looked at for zeros
SLOPES = 1e-12  # what stencils of first derivatives leave where their inner pairs differ by `stencils.RESOLVED_SLOPE`
OTHERS = (1.4, 0.7)  # times the usual width of differences, to tell their errors


class FunctionSystem:
    """Values and derivatives of a `FunctionProblem` in vectors u (n,), p (m,); z = (u, p).

    The same methods as a compiled system has; its addresses are `NO_FUNCTION`. Jacobians are dense here.

    A user's function that fails where it worked before (raises, returns the wrong shape) gives NaN: a branch ends
    there, with what was computed, and `why_not_finite` and `trouble_near` say why. At the start it is an error.
    """

    jacobian_address = NO_FUNCTION
    is_forced = False
    n_switches = 0
    look_again = 8  # Jacobians by complex steps after which these are compared with differences
    limits: tuple[Limit, ...] = ()

    def __init__(self, model: GivenFunction) -> None:
        self.model = model
        self.kind = model.kind
        self.n, self.m = model.n, len(model.parameter_names)
        self.p_size = self.m
        self.state_names, self.parameter_names = model.state_names, model.parameter_names
        self._trouble: Trouble | None = None  # the last failure
        self._worked: set[str] = set()
        self._lost = np.full(self.n, np.nan)
        self._made = 0  # Jacobians by complex steps
        self._probed = ProbedMatrix(model.n)
        u0, p0 = model.start_point()
        self.observable_names: tuple[str, ...] = ()
        value = self.value(u0, p0)
        known = np.all(np.isfinite(value))
        if not known and model.explain is None:  # formulas have a value where a run starts: that is looked at there
            raise NotFiniteError(f"{self.why_not_finite(u0, p0)} (at u0)")
        if known and model.jacobian is not None:
            self._check_jacobian(u0, p0)
        if known and model.written is None:
            try_function(self, u0, p0)
        self.observable_names = tuple(self._recorded(u0, p0))
        taken = sorted(set(self.observable_names) & {*self.state_names, *self.parameter_names, "stable", "unstable"})
        if taken:
            raise InputError(f"record: the names {', '.join(taken)} are taken; choose others")

    def _check_jacobian(self, u0: Array, p0: Array) -> None:
        assert self.model.jacobian is not None
        shape = np.shape(called("Jacobian", self.model.jacobian, u0, self._named(p0)))
        if shape != (self.n, self.n):
            raise InputError(f"jacobian must return dF/du of shape ({self.n}, {self.n}); got {shape}")

    def _named(self, p: Vector) -> Fields:
        return dict(zip(self.parameter_names, p.tolist(), strict=True))

    def attempt(self, what: str, evaluate: Callable[[], Any], failed: object, u: Vector, p: Vector) -> Any:
        """evaluate(); where it raises UserFunctionError, `failed`, and the reason is kept. The first one must work."""
        try:
            value = evaluate()
        except UserFunctionError as error:
            self._keep(what, error, u, p)
            return failed
        self._worked.add(what)
        return value

    def _keep(self, what: str, error: UserFunctionError, u: Vector, p: Vector) -> None:
        """Keep the reason of a failure where `what` worked before; raise `error` where it did not."""
        if what not in self._worked:
            raise error
        self._trouble = Trouble(str(error), np.real(u).astype(float), np.real(p).astype(float))

    # values ---------------------------------------------------------------------------------------------------------

    def raw(self, u: Vector, p: Vector) -> Vector:
        """F(u, p) (n,), real or complex, as the user's function gives it."""

        value: Vector = self.attempt("residual", lambda: self._bare(u, p), np.full(self.n, np.nan), u, p)
        return value

    def _bare(self, u: Vector, p: Vector) -> Vector:
        """`raw`, or UserFunctionError, of which nothing is kept."""
        return vector("residual", called("residual", self.model.residual, u, self._named(p)), self.n)

    def quickly(self, u: Vector, p: Vector) -> Vector:
        """`raw` without looking for what is wrong, until something is: for the many points of a difference or circle.

        Floating point warnings are the caller's to switch off.
        """
        try:
            value = np.array(self.model.residual(u, self._named(p)))  # a function may fill one array again and again
        except Exception:  # noqa: BLE001 - said in words there
            return self.raw(u, p)
        return value if value.shape == (self.n,) and value.dtype.kind in "biufc" else self.raw(u, p)

    def quickly_at_rows(self, u: Vector, p: Vector) -> Vector:
        """`quickly` at the rows of u (K, n), (K, n)."""
        found = self._at_rows(u, p, "biufc")
        return np.array([self.quickly(row, p) for row in u]) if found is None else found

    def value(self, u: ArrayLike, p: ArrayLike) -> Array:
        """F(u, p), (n,)."""
        states, others = np.array(u, dtype=float), np.asarray(p, dtype=float)
        before = self._trouble
        try:
            with np.errstate(all="ignore"):
                value = real("residual", self.quickly(states, others))
        except UserFunctionError as error:
            self._keep("value", error, states, others)
            return self._lost
        self._worked |= {"residual", "value"}
        if self._trouble is before and not np.all(np.isfinite(value)):
            bad = int(np.flatnonzero(~np.isfinite(value))[0])
            self._trouble = Trouble(f"component {bad} of the residual is {value[bad]:.3g}", states, others)
        return value

    def _recorded(self, u: Array, p: Array) -> dict[str, float]:
        """What `record` gives at a point; NaN where it fails."""
        if self.model.record is None:
            return {}
        record = self.model.record

        def evaluate() -> dict[str, float]:
            with np.errstate(all="ignore"):
                given = numbers("record", called("function `record`", record, u, self._named(p)))
            missing = [name for name in names if name not in given]
            if missing:
                raise UserFunctionError(f"record must return the same names everywhere; {missing[0]!r} is missing")
            return given

        names = self.observable_names
        failed = dict.fromkeys(names, float("nan"))
        recorded: dict[str, float] = self.attempt("record", evaluate, failed, u, p)
        return recorded

    def observables(self, u: ArrayLike, p: ArrayLike) -> Array:
        """Recorded values at N points, (N, k)."""
        rows_u = np.atleast_2d(np.asarray(u, dtype=float))
        rows_p = np.broadcast_to(np.asarray(p, dtype=float), (len(rows_u), self.m))
        out = np.empty((len(rows_u), len(self.observable_names)))
        if self.model.record is not None:
            for k, (row_u, row_p) in enumerate(zip(rows_u, rows_p, strict=True)):
                recorded = self._recorded(row_u, row_p)
                out[k] = [recorded[name] for name in self.observable_names]
        return out

    def symmetry(self, name: str, u: ArrayLike, p: ArrayLike) -> Array:
        """Images of N states, (N, n)."""
        chosen = next(s for s in self.model.symmetries if s.name == name)
        return np.array([chosen.map(row) for row in np.atleast_2d(np.asarray(u, dtype=float))], dtype=float)

    def margins(self, u: ArrayLike, p: ArrayLike) -> Array:
        """Functions hold everywhere."""
        return np.empty((len(np.atleast_2d(np.asarray(u))), 0))

    def switches(self, u: ArrayLike, p: ArrayLike) -> Array:
        """Functions are taken to be smooth."""
        return np.empty(0)

    def why_not_finite(self, u: ArrayLike, p: ArrayLike) -> str | None:
        """What is not finite at this point, or fails, and why; None if nothing is."""
        states, others = np.asarray(u, dtype=float), np.asarray(p, dtype=float)
        if self.model.explain is not None:
            return self.model.explain(states, others)
        self._trouble = None
        value = self.value(states, others)
        if np.all(np.isfinite(value)) and self.model.method == "dense":
            with np.errstate(all="ignore"):
                matrix = self.state_jacobian(states, others)
            if self._trouble is None and not np.all(np.isfinite(matrix)):
                self._trouble = Trouble("an entry of the Jacobian is not finite", states, others)
        return None if self._trouble is None else f"not finite at this point: {self._told()}"

    def why_observables_not_finite(self, u: ArrayLike, p: ArrayLike) -> str | None:
        """Why a recorded value is not finite at this point, where `record` failed."""
        self._trouble = None
        self._recorded(np.asarray(u, dtype=float), np.asarray(p, dtype=float))
        return None if self._trouble is None else self._told()

    def trouble_near(self, u: Array, p: Array) -> str | None:
        """The last failure of a user's function, if it was close to this point: why a branch cannot go on from here."""
        return self._told() if self._trouble is not None and self._trouble.is_near(u, p) else None

    def _told(self) -> str:
        assert self._trouble is not None
        return self._trouble.told(self._named(self._trouble.p))

    # derivatives ----------------------------------------------------------------------------------------------------

    @cached_property
    def lines(self) -> Lines:
        """Directional derivatives by complex steps or differences."""
        u0, p0 = self.model.start_point()
        states, others = np.where(u0 != 0.0, np.abs(u0), self.model.typical), np.where(p0 != 0.0, np.abs(p0), 1.0)
        sizes = np.concatenate([states, others])
        analytic = self.model.written is None and is_analytic(self.raw, u0, p0, sizes)
        slope = None if analytic or self.model.jacobian is None else self._slope
        return Lines(self.quickly, sizes, analytic, slope, grain=None if analytic else self._grain_of(sizes, u0, p0))

    def _grain_of(self, sizes: Array, u0: Array, p0: Array) -> Callable[[Array, Array], Array] | None:
        """What values are off by, where that is more than rounding of double precision beside the start."""
        found = Grain(self.quickly, sizes)
        with np.errstate(all="ignore"):
            return found.at if found.relative(u0 + BESIDE * sizes[: self.n], p0) > 0.0 else None

    @cached_property
    def _takes_real_states(self) -> bool:
        """Asked of large systems only, where an evaluation is dear."""
        if self.model.method == "dense" or self.n < PROBED:
            return False
        u0, p0 = self.model.start_point()
        return by_parameters.takes_real_states(self._bare, u0, p0, self.lines.sizes)

    def _slope(self, u: Array, p: Array, v: Array) -> Array:
        """D F[v] by the user's Jacobian."""
        assert self.model.jacobian is not None
        total = self.jacobian_product(u, p, v[: self.n])
        for k in np.flatnonzero(v[self.n :]):
            total = total + v[self.n + k] * self.parameter_slope(u, p, int(k))
        return total

    def jacobian_product(self, u: Array, p: Array, v: Array) -> Array:
        """dF/du v by the user's Jacobian, (n,)."""
        assert self.model.jacobian is not None
        jacobian = self.model.jacobian

        def evaluate() -> Array:
            return real("Jacobian", np.asarray(called("Jacobian", lambda: jacobian(u, self._named(p)) @ v)))

        product: Array = self.attempt("Jacobian", evaluate, np.full(self.n, np.nan), u, p)
        return product

    def parameter_slope(self, u: Array, p: Array, k: int) -> Array:
        """dF/dp_k, (n,)."""
        if self.model.parameter_jacobian is not None:
            given, name = self.model.parameter_jacobian, self.parameter_names[k]

            def evaluate() -> Array:
                what = "parameter Jacobian"
                return real(what, vector(what, called(what, given, u, self._named(p), name), self.n))

            slope: Array = self.attempt("parameter Jacobian", evaluate, np.full(self.n, np.nan), u, p)
            return slope
        direction = np.zeros(self.n + self.m)
        direction[self.n + k] = 1.0
        lines = self.lines
        with np.errstate(all="ignore"):
            if lines.analytic:
                size = np.maximum(np.abs(p), lines.sizes[self.n :]) * direction[self.n :]
                by_step = by_parameters.by_step(self._bare, u, p, size) if self._takes_real_states else None
                return lines.first(u, p, direction) if by_step is None else by_step / size[k]
            return replace(lines, function=self.quickly, slope=None).pure(u, p, direction, 1)

    def parameter_slopes(self, u: Array, p: Array, k: int) -> Array:
        """`parameter_slope` at the rows of u (K, n), (K, n)."""
        if self.model.parameter_jacobian is None and self.lines.analytic:
            steps = np.zeros(self.m)
            steps[k] = max(abs(float(p[k])), float(self.lines.sizes[self.n + k]))
            with np.errstate(all="ignore"):
                rows = u if self._takes_real_states else u + 0j
                found = by_parameters.at_rows(self.model.residual, rows, self._named(by_parameters.moved(p, steps)))
            if found is not None:
                return np.asarray(found / steps[k])
        return np.array([self.parameter_slope(row, p, k) for row in u])

    def state_jacobian(self, u: Array, p: Array) -> Array:
        """dF/du, (n, n), dense."""
        if self.model.jacobian is not None:
            given = self.model.jacobian

            def evaluate() -> Array:
                matrix = as_array(called("Jacobian", given, u, self._named(p)))
                if np.shape(matrix) != (self.n, self.n):
                    raise UserFunctionError(
                        f"jacobian must return dF/du of shape ({self.n}, {self.n}); got {np.shape(matrix)}"
                    )
                return real("Jacobian", np.array(matrix))

            full: Array = self.attempt("Jacobian", evaluate, np.full((self.n, self.n), np.nan), u, p)
            return full
        self.watch_steps(u, p)
        with np.errstate(all="ignore"):
            if self.n < PROBED:
                return np.column_stack([self._along(u, p, v) for v in np.eye(self.n)])
            matrix = self._probed.at(lambda v: self._along(u, p, v), self.sizes_at(u))
        assert matrix is not None
        return np.asarray(matrix.toarray())

    def _along(self, u: Array, p: Array, v: Array) -> Array:
        return self.lines.first(u, p, np.concatenate([v, np.zeros(self.m)]))

    def _by_complex_steps(self, u: Array, p: Array) -> bool:
        """Whether all columns of [dF/du dF/dp] come from complex steps: of few states they cost less than a sparse
        matrix, or products with one."""
        dense = self.model.jacobian is not None and self.model.method == "dense"
        if dense or self.model.parameter_jacobian is not None or self.n >= PROBED:
            return False
        self.watch_steps(u, p)
        return self.lines.analytic

    def _columns(self, u: Array, p: Array, first: int = 0) -> Array:
        """[dF/du dF/dp] from the column `first` on, by complex steps."""
        found = complex_steps.columns(self.model.residual, u, p, self.parameter_names, self.lines.sizes, first)
        if found is not None:
            return found
        return np.column_stack([self.lines.first(u, p, v) for v in np.eye(self.n + self.m)[first:]])

    def _slopes_by_all(self, u: Array, p: Array) -> Array:
        """[dF/du dF/dp] (n, n + m), dense."""
        matrix = self.state_jacobian(u, p)
        if self.model.parameter_jacobian is None and self.lines.analytic and not self._takes_real_states:
            return np.hstack([matrix, self._columns(u, p, self.n)])
        return np.column_stack([matrix, *(self.parameter_slope(u, p, k) for k in range(self.m))])

    def sizes_at(self, u: Array) -> Array:
        """Of the states, (n,): |u|, or typical ones where those are larger."""
        return np.asarray(np.maximum(np.abs(u), self.lines.sizes[: self.n]))

    def watch_steps(self, u: Array, p: Array) -> None:
        """Look now and then whether complex steps still give derivatives."""
        self._made += 1
        if self.lines.analytic and self._made % self.look_again == 0:
            self._look_again(u, p)

    def slopes(self, u: Array, p: Array) -> Any:
        """dF/du, (n, n): sparse where the user gives it so."""
        given = self.model.jacobian
        if given is None or self.model.method != "sparse":
            return self.state_jacobian(u, p)
        matrix = self.attempt("Jacobian", lambda: called("Jacobian", given, u, self._named(p)), None, u, p)
        return self.state_jacobian(u, p) if matrix is None else matrix

    def _look_again(self, u: Array, p: Array) -> None:
        """Where complex steps no longer give the derivative, take differences from here on, with a warning."""
        try:
            why = not_analytic(self, u, p, self.lines.first)
        except UserFunctionError:
            return  # told where the value itself is needed
        if why is not None:
            self.lines = replace(self.lines, analytic=False)
            warnings.warn(f"{self.model.name}: {why}", InputWarning, stacklevel=2)

    def jacobian(self, u: ArrayLike, p: ArrayLike) -> tuple[Array, Array]:
        """F (n,) and dF/dz (n, n + m)."""
        states, others = np.array(u, dtype=float), np.array(p, dtype=float)
        with np.errstate(all="ignore"):
            by_steps = self._by_complex_steps(states, others)
            matrix = (self._columns if by_steps else self._slopes_by_all)(states, others)
        return self.value(states, others), matrix

    def values(self, u: Array, p: Array) -> Array:
        """F at N points u (N, n), (N, n), p (N, m) or one (m,) for all: at once, until something is wrong with one."""
        others = np.asarray(p, dtype=float)
        with np.errstate(all="ignore"):
            found = self._at_rows(np.array(u, dtype=float), others, "biuf") if others.ndim == 1 else None
        if found is not None and np.all(np.isfinite(found)):
            self._worked |= {"residual", "value"}
            return found
        return np.array([self.value(*at) for at in zip(u, np.broadcast_to(others, (len(u), self.m)), strict=True)])

    def _at_rows(self, u: Vector, p: Vector, kinds: str) -> Vector | None:
        """F (K, n) at the rows of u (K, n) where the user's function gives numbers of these kinds; None else."""
        named = self._named(p)
        try:
            found = np.array([np.array(self.model.residual(row.copy(), dict(named))) for row in u])
        except Exception:  # noqa: BLE001
            return None  # whoever asks goes from row to row then, where it is said in words
        return found if found.shape == u.shape and found.dtype.kind in kinds else None

    def jacobians(self, u: Array, p: Array) -> tuple[Array, Array]:
        """`jacobian` at N points, u (N, n) and p (N, m): (N, n) and (N, n, n + m)."""
        return one_by_one(self.jacobian, u, p)

    def derivatives(self, u: Array, p: Array, *directions: Vector) -> Vector:
        """`derivative` at N points, (N, n): u (N, n), p (N, m), directions (N, n + m)."""
        return form_by_form(self.derivative, u, p, directions)

    def derivative(self, u: ArrayLike, p: ArrayLike, *directions: ArrayLike) -> Vector:
        """D^k F(z)[d1, ..., dk], (n,), directions (n + m,), real or complex."""
        states, others = np.array(u, dtype=float), np.array(p, dtype=float)

        def real(parts: tuple[Array, ...]) -> Array:
            if self.model.derivative is not None and (2 <= len(parts) <= 3 or self.model.written is not None):
                given = called("function `derivative`", self.model.derivative, states, self._named(others), *parts)
                return vector("function `derivative`", given, self.n).astype(float)
            with np.errstate(all="ignore"):
                return self.lines.form(states, others, parts)

        vectors = tuple(np.asarray(d) for d in directions)
        if len(vectors) > 1 and self.model.derivative is None and self.lines.takes_complex(states, others, vectors):
            with np.errstate(all="ignore"):
                found = self.lines.form(states, others, vectors)
            return found.astype(complex) if any(np.iscomplexobj(d) for d in vectors) else found
        return expand_complex(lambda wanted: [real(parts) for parts in wanted], vectors, self.n)

    def tensor(self, u: Array, p: Array, order: int) -> Array | None:
        """All derivatives of order 2 or 3 by the states (n, .., n); None where the user's function gives forms."""
        if self.model.derivative is not None:
            return None
        with np.errstate(all="ignore"):
            return self.lines.tensor(np.array(u, dtype=float), np.array(p, dtype=float), order)

    def functional(self, left: Callable[[Vector], Any], u: ArrayLike, p: ArrayLike, v: Vector, order: int) -> float:
        """left(D^k F(z)[v, ..., v]), of a linear functional and a real direction v (n + m,), k = `order`."""
        return self.functional_with_terms(left, u, p, v, order)[0]

    def functional_with_terms(
        self, left: Callable[[Vector], Any], u: ArrayLike, p: ArrayLike, v: Vector, order: int
    ) -> tuple[float, Array]:
        """`functional`, and D^k F(z)[v, ..., v] as well as that needs it."""
        if self.model.derivative is not None:
            terms = self.derivative(u, p, *[v] * order)
            return float(np.real(left(terms))), terms
        with np.errstate(all="ignore"):
            return self.lines.functional_with_terms(
                left, np.array(u, dtype=float), np.array(p, dtype=float), v, order
            )

    @property
    def error_of_slopes(self) -> float:
        """Relative, of an entry of the Jacobian; 0 where it is given, or comes from complex steps."""
        return 0.0 if self.lines.analytic or self.model.jacobian is not None else SLOPES

    @property
    def error_of_grain(self) -> float:
        """Relative, of an entry of the Jacobian by differences, where values are rounded to some digits; else 0."""
        if self.lines.grain is None or self.model.jacobian is not None:
            return 0.0
        u0, p0 = self.model.start_point()
        return Grain(self.quickly, self.lines.sizes).relative(u0 + BESIDE * self.lines.sizes[: self.n], p0) / STEPS[1]

    def with_wider_stencils(self, factor: float) -> Self | None:
        """The same with other differences for derivatives of order 2 and 3; None where these are no differences."""
        return None if self.lines.analytic else self._otherwise(factor)

    def with_other_differences(self) -> tuple[Self, ...]:
        """The same with stencils, or circles in the complex plane, of other widths, off by as much as rounding may make
        them; () of given derivatives."""
        found = [self._otherwise(factor) for factor in OTHERS] if self.lines.wider == 1.0 else []
        return tuple(one for one in found if one is not None)

    def _otherwise(self, factor: float) -> Self | None:
        if self.model.derivative is not None:
            return None
        made = copy(self)
        made.lines = replace(self.lines, wider=factor, unsure=factor in OTHERS)
        return made

    def gradient(self, u: ArrayLike, p: ArrayLike, v: ArrayLike, roughly: bool = False) -> Vector:
        """The matrix D^2F(z)[v, .], (n, n + m), v real or complex; `roughly` as Newton's method needs it."""
        direction = np.asarray(v)
        if np.iscomplexobj(direction):
            return self.gradient(u, p, direction.real) + 1j * self.gradient(u, p, direction.imag)
        states, others = np.array(u, dtype=float), np.array(p, dtype=float)
        along = self.lines.roughly_along if roughly else self.lines.along
        with np.errstate(all="ignore"):
            if self._by_complex_steps(states, others):
                return along(self._columns, states, others, direction)
            if self.lines.analytic or self.model.jacobian is not None:
                return along(self._slopes_by_all, states, others, direction)
        unit = np.eye(self.n + self.m)
        return np.column_stack([self.derivative(u, p, direction, row) for row in unit])

    def gradients(self, u: Array, p: Array, v: Vector) -> Vector:
        """`gradient` at N points: u (N, n), p (N, m), v (N, n + m) real or complex; (N, n, n + m)."""
        return np.stack([self.gradient(*at) for at in zip(u, p, v, strict=True)])
