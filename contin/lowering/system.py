"""`CompiledSystem`: a model as machine code, for kernels (addresses) and for Python (arrays)."""

from __future__ import annotations

import itertools
import threading
from collections.abc import Callable, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike

from contin.abi import NO_FUNCTION, Address, Array, Vector
from contin.errors import InputError
from contin.lowering.calls import Call, Calls, make_call
from contin.lowering.llvm_text import Routine
from contin.lowering.machine import MachineCode, compile_routines
from contin.lowering.pieces import Pieces, compile_pieces
from contin.lowering.routines import Layout, form_routine, gradient_routine, jacobian_routine, vector_routine
from contin.lowering.switching import switching_functions
from contin.model.explain import explain_not_finite
from contin.model.expression import Expression, postorder, symbol
from contin.model.kinds import need_autonomous, need_no_events, need_states
from contin.model.model import Model
from contin.model.parts import Constraints, VanishingMass
from contin.model.printing import to_text
from contin.symbolic.calculus.derivatives import derivative
from contin.symbolic.calculus.remove_singularities import remove_singularities
from contin.symbolic.passes.index_one import index_one

TIME: Final = "t"
COMPILED_AT_ONCE: Final = 400  # formulas with fewer nodes: all basic functions in one module, cheaper than one by one
LONG: Final = 4  # forms of so many directions and more know whether these leave the parameters alone
OF_STATES: Final = "s"
BASIC: Final = ("value", "jacobian", "observe", "switches")


def compile_system(model: Model, regular: bool = False) -> CompiledSystem:
    """Machine code of a model: values, Jacobians, observables, switching functions, derivatives of any order.

    Removable singularities are removed first (`contin.symbolic.calculus.remove_singularities`), unless `regular` says
    that there are none. Each function is compiled when it is first asked for. Raises
    `InputError` if an equation uses a symbol that is neither state nor parameter (nor `t` in a forced model).
    """
    need_states(model, "states")
    need_autonomous(model)
    return CompiledSystem(model, regular)


def compile_in_time(model: Model) -> CompiledSystem:
    """The same for simulations, of a flow that may use the time `t` without `forcing`, or have no states."""
    need_states(model, "states")
    need_no_events(model, "sweeps, scans and searches")
    return CompiledSystem(model, timed=model.uses_time)


class CompiledSystem:
    """Machine code of `model`, and the owner of its memory: an address is valid while this object lives.

    Shapes: u (n,), p (m,), or (m + 1,) with the time appended for a forced model, whose Jacobian has a last column
    df/dt; so p and z = (u, p) have `p_size` and `n + p_size` components. Methods and addresses may be used from several
    threads at once. Copies and pickles carry the model and compile again.

    Where an equation is not finite, so are the results; `why_not_finite` says why. Nothing is raised.
    """

    def __init__(self, model: Model, regular: bool = False, timed: bool = False) -> None:
        self.written, self.regular, self.timed = model, regular, timed
        self.model = model = index_one(model)
        self.constraints = model.constraints if isinstance(model, Model) else None
        self.vanishing = model.vanishing if isinstance(model, Model) else ()
        self.kind = model.kind
        self.state_names = tuple(model.state_names)
        self.parameter_names = tuple(model.parameter_names)
        self.observable_names = tuple(model.observables)
        self.limits = tuple(model.limits)
        self.is_forced = timed or model.forcing is not None
        self.n = len(self.state_names)
        self.m = len(self.parameter_names)
        self.layout = Layout(self.state_names, self.parameter_names + ((TIME,) if self.is_forced else ()))
        self.p_size = len(self.layout.others)
        self.layout.check(dict(zip(self.state_names, model.equations, strict=True)) | dict(model.observables))
        formulas = [*model.equations, *model.observables.values()]
        formulas = formulas if regular else remove_singularities(formulas)
        self._equations, self._observables = tuple(formulas[: self.n]), tuple(formulas[self.n :])
        self.switching: tuple[Expression, ...] = tuple(switching_functions(model.equations, self.layout.names))
        self.n_switches = len(self.switching)
        if self.constraints is not None and self.n_switches:
            raise InputError(
                f"model {model.name}, mass: flows with algebraic states must be smooth; these equations change formula "
                f"where {to_text(self.switching[0])} = 0"
            )
        self._lock = threading.RLock()
        self._code: dict[str, MachineCode] = {}
        self._functions: dict[str, Call] = {}
        self._is_small = len(postorder(formulas)) < COMPILED_AT_ONCE
        self._pieces: Pieces | None = None
        self._calls = Calls(self.n, self.p_size)

    def __reduce__(self) -> tuple[Any, ...]:
        if self.timed:
            return compile_in_time, (self.written,)
        return compile_system, (self.written, self.regular)

    def __repr__(self) -> str:
        return f"<CompiledSystem of {getattr(self.model, 'name', 'a model')!r}: n = {self.n}, m = {self.m}>"

    @property
    def computable(self) -> Model:
        """The model with the equations that are compiled: what is derived from them has no removable singularity."""
        return self.model.replace(equations=self._equations)

    @property
    def forcing_period(self) -> Expression:
        """Formula for the period of a forced flow."""
        forcing = self.model.forcing
        if forcing is None:
            raise ValueError(f"{self.model.name} is not forced")
        return forcing.period

    # addresses for kernels (layouts in `contin.abi`)

    @property
    def value_address(self) -> Address:
        """(u, p, F)"""
        return self._address("value")

    @property
    def jacobian_address(self) -> Address:
        """(u, p, F, J)"""
        return self._address("jacobian")

    @property
    def observe_address(self) -> Address:
        """(u, p, out), or `NO_FUNCTION` without observables."""
        return self._address("observe")

    @property
    def switches_address(self) -> Address:
        """(u, p, out), or `NO_FUNCTION` where the equations are smooth."""
        return self._address("switches")

    def form(self, order: int) -> Address:
        """(u, p, v_1, ..., v_order, out): derivative of this order along as many directions of length n + p_size."""
        if order < 1:
            raise ValueError(f"order must be 1 or more; got {order}")
        return self._address(f"form{order}")

    @property
    def gradient_address(self) -> Address:
        """(u, p, v, w, H): w = Df[v], H = D^2f[v, .] (n, n + p_size)"""
        return self._address("gradient")

    def statements(self, name: str) -> int:
        """Length of a compiled function ('value', 'jacobian', 'observe', 'switches', 'form2', ...): its cost a call."""
        return self._code[name].statements[name] if self._address(name) else 0

    # values for Python

    def value(self, u: ArrayLike, p: ArrayLike) -> Array:
        """f(u, p), (n,)."""
        return self._calls.vector(self._call("value"), self.n, u, p)

    def values(self, u: ArrayLike, p: ArrayLike) -> Array:
        """f at N points, (N, n): u (N, n), p (N, p_size) or one (p_size,) for all."""
        return self._calls.vectors(self._call("value"), self.value_address, self.n, u, p)

    def steps(self, points: Array, p: Array) -> None:
        """Of a map: from points[0] on, its iterates into points[1:], (N, n)."""
        self._calls.steps(self.value_address, points, p)

    def jacobian(self, u: ArrayLike, p: ArrayLike) -> tuple[Array, Array]:
        """f (n,) and df/dz (n, n + p_size), z = (u, p)."""
        return self._calls.jacobian(self._call("jacobian", 4), u, p)

    def jacobians(self, u: Array, p: Array) -> tuple[Array, Array]:
        """`jacobian` at N points, u (N, n) and p (N, p_size): (N, n) and (N, n, n + p_size)."""
        return self._calls.jacobians(self._call("jacobian", 4), u, p)

    def observables(self, u: ArrayLike, p: ArrayLike) -> Array:
        """Observables at N points, (N, k) in the order of `observable_names`; at one point u (n,), (k,)."""
        size = len(self.observable_names)
        return self._calls.vectors(self._call("observe"), self.observe_address, size, u, p)

    def margins(self, u: ArrayLike, p: ArrayLike) -> Array:
        """Of the model's `limits` at N points, (N, number of limits): the equations hold where none is negative."""
        return self._calls.vectors(self._call("limits"), self._address("limits"), len(self.limits), u, p)

    def correction(self, u: ArrayLike, p: ArrayLike) -> Array:
        """Of N states, (N, n): Newton's step from each onto the algebraic equations, which are to hold at it."""
        return self._calls.vectors(self._call("correction"), self._address("correction"), self.n, u, p)

    def algebraic(self, u: ArrayLike, p: ArrayLike) -> Array:
        """The algebraic equations' left-hand sides at one state, (k,)."""
        count = 0 if self.constraints is None else len(self.constraints.residuals)
        return self._calls.vector(self._call("algebraic"), count, u, p)

    def index_determinants(self, u: ArrayLike, p: ArrayLike) -> Array:
        """Of N states, (N,): the index is 1 where these do not vanish."""
        return self._calls.vectors(self._call("index"), self._address("index"), 1, u, p).reshape(-1)

    def masses(self, u: ArrayLike, p: ArrayLike) -> Array:
        """Determinants of M's blocks that depend on parameters (`vanishing`) at N points, (N, blocks)."""
        return self._calls.vectors(self._call("masses"), self._address("masses"), len(self.vanishing), u, p)

    def symmetry(self, name: str, u: ArrayLike, p: ArrayLike) -> Array:
        """Images of N states, (N, n), under a declared symmetry of the model: u (N, n), p (N, p_size) or (p_size,)."""
        index = [s.name for s in self.model.symmetries].index(name)
        image = f"image{index}"
        return self._calls.vectors(self._call(image), self._address(image), self.n, u, p)

    def switches(self, u: ArrayLike, p: ArrayLike) -> Array:
        """Switching functions at N points, (N, n_switches); at one point u (n,), (n_switches,).

        The equations change formula where one of them changes sign.
        """
        return self._calls.vectors(self._call("switches"), self.switches_address, self.n_switches, u, p)

    def derivative(self, u: ArrayLike, p: ArrayLike, *directions: ArrayLike) -> Vector:
        """D^k f(z)[v_1, ..., v_k], (n,): k = len(directions), each (n + p_size,), real or complex.

        Complex directions are expanded by multilinearity; real parts that occur twice (q and its conjugate, symmetric
        arguments) are evaluated once.
        """
        if not directions:
            return self.value(u, p)
        vectors = [self._direction(v) for v in directions]
        call = self._call(self._form(vectors), 3 + len(vectors))
        if not any(v.dtype.kind == "c" for v in vectors):
            return self._calls.form(call, u, p, vectors)
        return _multilinear(lambda parts: self._calls.form(call, u, p, parts), vectors)

    def derivatives(self, u: Array, p: Array, *directions: Vector) -> Vector:
        """`derivative` at N points, (N, n): u (N, n), p (N, p_size), k >= 1 directions (N, n + p_size)."""
        call = self._call(self._form(directions), 3 + len(directions))
        return _multilinear(lambda parts: self._calls.forms(call, u, p, parts), directions)

    def _form(self, directions: Sequence[Vector]) -> str:
        """Name of the routine: of long forms along states alone, one without the parameters' many terms."""
        alone = len(directions) >= LONG and not any(np.any(d[..., self.n :]) for d in directions)
        return f"form{len(directions)}" + OF_STATES * alone

    def gradient(self, u: ArrayLike, p: ArrayLike, v: ArrayLike) -> Vector:
        """The matrix D^2f(z)[v, .], (n, n + p_size), for one direction v (n + p_size,), real or complex."""
        direction = self._direction(v)
        call = self._call("gradient", 5)
        real = self._calls.gradient(call, u, p, direction.real)
        if not np.iscomplexobj(direction):
            return real
        return real + 1j * self._calls.gradient(call, u, p, direction.imag)

    def gradients(self, u: Array, p: Array, v: Vector) -> Vector:
        """`gradient` at N points: u (N, n), p (N, p_size), v (N, n + p_size) real or complex; (N, n, n + p_size)."""
        call = self._call("gradient", 5)
        real = self._calls.gradients(call, u, p, v.real)
        return real + 1j * self._calls.gradients(call, u, p, v.imag) if np.iscomplexobj(v) else real

    def _direction(self, v: ArrayLike) -> Vector:
        vector = np.asarray(v)
        size = self.n + self.p_size
        if vector.shape == (self.n + self.m,) and self.is_forced:
            vector = np.append(vector, 0.0)  # along states and parameters at fixed time
        if vector.shape != (size,):
            raise ValueError(f"a direction must have shape ({size},) for (u, p); got {vector.shape}")
        return vector

    @property
    def pieces(self) -> Pieces:
        """The flow taken apart at its switching surfaces, for trajectories (smooth equations: no surfaces)."""
        with self._lock:
            if self._pieces is None:
                time = TIME if self.is_forced else None
                self._pieces = compile_pieces(self._equations, self.layout, time, self._code_of)
            return self._pieces

    def why_not_finite(self, u: ArrayLike, p: ArrayLike) -> str | None:
        """Which equation, or entry of the Jacobian, is not finite at this point and why; None if all are finite."""
        z = np.concatenate([np.asarray(u, dtype=float), np.asarray(p, dtype=float)])
        if self.n and np.all(np.isnan(z[: self.n])):  # no equation is the cause
            return "no state is a number any more: Newton's method diverged, or met a pole of the equations nearby"
        f, matrix = self.jacobian(u, p)
        bad_rows = np.flatnonzero(~np.isfinite(f))
        # states come first: a parameter's column may be infinite without harm while that parameter is fixed
        bad_entries = np.argwhere(~np.isfinite(matrix.T))
        if not len(bad_rows) and not len(bad_entries):
            return None
        suspects = dict(zip(self.state_names, self._equations, strict=True))
        if not len(bad_rows):
            column, row = bad_entries[0]
            names = self.state_names[row], self.layout.names[column]
            suspects = {"d({})/d({})".format(*names): derivative(self._equations[row], names[1])}
        reason = explain_not_finite(suspects, dict(zip(self.layout.names, z.tolist(), strict=True)))
        first = self.state_names[bad_rows[0]] if len(bad_rows) else next(iter(suspects))
        massless = "" if not self.vanishing else massless_at(self.vanishing, self.masses(u, p).reshape(-1))
        return f"not finite at this point: {reason or f'equation {first}'}{massless}"

    def why_observables_not_finite(self, u: ArrayLike, p: ArrayLike) -> str | None:
        """Which observable is not finite at this point and why; None if all are."""
        z = np.concatenate([np.asarray(u, dtype=float), np.asarray(p, dtype=float)])
        named = dict(zip(self.observable_names, self._observables, strict=True))
        return explain_not_finite(named, dict(zip(self.layout.names, z.tolist(), strict=False)), "observable") or None

    def trouble_near(self, u: Array, p: Array) -> str | None:
        """Formulas do not fail (`why_not_finite` finds where they are not finite)."""
        return None

    # compilation

    def _call(self, name: str, pointers: int = 3) -> Call:
        try:
            return self._functions[name]
        except KeyError:
            call = self._functions[name] = make_call(self._address(name), pointers)
            return call

    def _address(self, name: str) -> Address:
        return self._code_of(name).addresses.get(name, NO_FUNCTION)

    def _code_of(self, name: str) -> MachineCode:
        code = self._code.get(name)
        if code is None:
            with self._lock:
                code = self._code.get(name)
                if code is None:
                    names = BASIC if self._is_small and name in BASIC else (name,)
                    code = compile_routines([r for n in names if (r := self._routine(n)) is not None])
                    self._code.update(dict.fromkeys(names, code))
        return code

    def _routine(self, name: str) -> Routine | None:
        if name == "value":
            return vector_routine(name, self._equations, self.layout)
        if name == "jacobian":
            return jacobian_routine(name, self._equations, self.layout)
        if name.startswith("image"):
            images = self.model.symmetries[int(name.removeprefix("image"))].map
            return vector_routine(name, [images.get(s, symbol(s)) for s in self.state_names], self.layout)
        if name == "limits":
            return vector_routine(name, [limit.margin for limit in self.limits], self.layout)
        if self.constraints is not None and (parts := algebraic_parts(self.constraints, name)):
            return vector_routine(name, parts, self.layout)
        if name == "masses":
            return vector_routine(name, [mass.determinant for mass in self.vanishing], self.layout)
        if name in ("observe", "switches"):
            expressions = self._observables if name == "observe" else self.switching
            return vector_routine(name, expressions, self.layout) if expressions else None
        if name == "gradient":
            return gradient_routine(name, self._equations, self.layout)
        order = int(name.removeprefix("form").removesuffix(OF_STATES))
        return form_routine(name, self._equations, self.layout, order, name.endswith(OF_STATES))


def massless_at(vanishing: Sequence[VanishingMass], determinants: Array) -> str:
    """That masses vanish at a point, and what to do; empty where none does."""
    gone = [mass for mass, value in zip(vanishing, determinants, strict=True) if value == 0.0]
    return f". Here {gone[0].words()}" if gone else ""


def algebraic_parts(constraints: Constraints, name: str) -> Sequence[Expression]:
    """The formulas of a function that only flows with algebraic states have."""
    if name == "correction":
        return constraints.correction
    if name == "algebraic":
        return constraints.residuals
    return (constraints.determinant,) if name == "index" else ()


def _multilinear(form: Callable[[Sequence[Array]], Array], vectors: Sequence[Vector]) -> Vector:
    """A symmetric multilinear form of real vectors, at real or complex ones (or rows of them)."""
    if all(v.dtype == float for v in vectors) or not any(np.iscomplexobj(v) for v in vectors):
        return form(vectors)
    distinct: list[Array] = []
    parts = [_parts(v, distinct) for v in vectors]
    known: dict[tuple[int, ...], Array] = {}
    total: object = 0.0j
    for choice in itertools.product(*parts):
        key = tuple(sorted(index for index, _ in choice))
        if key not in known:
            known[key] = form([distinct[index] for index in key])
        total = total + np.prod([factor for _, factor in choice]) * known[key]
    return np.asarray(total) if known else 0.0j + form([np.zeros_like(v, dtype=float) for v in vectors])


def _parts(v: Vector, distinct: list[Array]) -> Sequence[tuple[int, complex]]:
    """v = sum of factor * distinct[index] over real vectors, entered into `distinct` once up to sign."""
    parts: list[tuple[int, complex]] = []
    for vector, factor in ((np.real(v), 1.0 + 0.0j), (np.imag(v), 1.0j)):
        if not vector.any():
            continue
        for index, known in enumerate(distinct):
            if np.array_equal(known, vector):
                parts.append((index, factor))
                break
            if np.array_equal(known, -vector):
                parts.append((index, -factor))
                break
        else:
            parts.append((len(distinct), factor))
            distinct.append(np.ascontiguousarray(vector, dtype=float))
    return parts
