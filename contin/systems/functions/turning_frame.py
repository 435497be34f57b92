"""A user's function with a rotation, seen from a frame that turns with a mode of the state.

With the mode z = <a, u> + i <b, u>, z' = i w z along the rotation u' = G u (`rotation`), the equations

    u' = F(u, p) - c(u) G u,    c(u) = (<b, F> + k <b, u>)/(w <a, u>)

keep <b, u>' = -k <b, u> exactly. On <b, u> = 0 the flow is the quotient by the rotation: relative equilibria
F = c G u are equilibria there, orbits that return turned are periodic, each with the eigenvalues or multipliers of the
full space, where those of the rotation itself (0; 1) have become -k and exp(-k T). The rate k is |F_u a|/|a| at the
start. Defined where <a, u>, the mode's size, is not 0.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from itertools import combinations
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.abi import Array, Vector
from contin.errors import InputError, InputWarning
from contin.linalg.vectors import dot, norm
from contin.systems.functions.function_problem import FunctionProblem
from contin.systems.functions.given_function import DENSE, FunctionSymmetry
from contin.systems.functions.moving_frame import MovingFrame
from contin.systems.functions.rotation import KEPT, Mode, Rotation

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

RATE: Final = "rotation_rate"
LARGEST_FULL: Final = 3000  # states, where the frame's Jacobian is full: 72 MB
EXACT: Final = 1e-8  # relative: a function that commutes with the rotation to rounding
WRONG: Final = 0.5  # one that does not: differences on a grid of a few nodes a wave do to a tenth
SAMPLES: Final = 3
PUSHED: Final = 0.3  # parts of each
HOLDS: Final = 1e-8  # relative, for a declared symmetry


class FunctionInFrame(FunctionProblem):
    """`still` in the frame that turns with `mode`; `start` (n,) has <b, start> = 0."""

    def __init__(self, still: FunctionProblem, turning: Rotation, mode: Mode, start: Array, p: Array) -> None:
        self.still, self.turning, self.mode = still, turning, mode
        system = still.system()
        moved = system.lines.first(start, p, np.concatenate([mode.a, np.zeros(system.m)]))
        decay = norm(moved) / norm(mode.a)
        self.decay = decay if decay > 0.0 and np.isfinite(decay) else 1.0
        self.smallest = KEPT * abs(dot(mode.a, start))  # of the mode, up to which nothing turns
        matrix = still.jacobian is None
        super().__init__(
            self._residual,
            start,
            dict(zip(still.parameter_names, p.tolist(), strict=True)),
            None if matrix else self._jacobian,
            parameter_jacobian=None if still.parameter_jacobian is None else self._parameter_slope,
            derivative=None if still.derivative is None else self._form,
            record=self._record,
            states=still.state_names or None,
            ranges=still.ranges,
            preconditioner=still.preconditioner,
            typical=still.typical,
            name=still.name,
            title=still.title,
            source=still.source,
            explain=self._explained,
        )
        self._expect = still._expect
        self.frame = MovingFrame(RATE, lambda u: np.asarray(u @ mode.a), "choose another mode, rotation=(G, wave)")
        # along the phase nothing moves: where a state is that alone, its size is that of the mode
        sizes = abs(dot(mode.a, start)) * np.abs(mode.b) / dot(mode.b, mode.b)
        self.declared_sizes = np.where(np.abs(start) < KEPT * sizes, sizes, 0.0)
        self.symmetries = tuple(one for one in still.symmetries if self._holds(one))

    @cached_property
    def generator_matrix(self) -> Array:
        """G (n, n), dense."""
        return np.asarray(self.turning.generator @ np.eye(self.n))

    def _inner(self, u: Vector, f: Vector) -> tuple[Any, Any]:
        """<b, F> + k <b, u> and w <a, u> (NaN where that is 0), whose quotient is the rate."""
        a = self.mode.a @ u
        below = self.mode.rate * a if abs(a) > self.smallest else np.nan
        return self.mode.b @ f + self.decay * (self.mode.b @ u), below

    def _explained(self, u: Array, p: Array) -> str | None:
        """Why the equations are not finite here."""
        if not abs(dot(self.mode.a, u)) > self.smallest:
            return (
                "the mode of the rotation that the frame turns with is 0 here: start again from a state beyond it, or "
                "choose another mode, rotation=(G, wave)"
            )
        text: str | None = self._own.why_not_finite(u, p)
        return text

    def _residual(self, u: Vector, values: Mapping[str, Any]) -> Vector:
        f = np.asarray(self.still.residual(u, values))
        above, below = self._inner(u, f)
        return np.asarray(f - (above / below) * self.turning.along(u))

    def _record(self, u: Array, values: Mapping[str, float]) -> dict[str, float]:
        own = {} if self.still.record is None else dict(self.still.record(u, values))
        if RATE in own:
            raise InputError(f"record: {RATE} is the rate at which the state turns here; choose another name")
        above, below = self._inner(u, np.asarray(self.still.residual(u, values)))
        return {**own, RATE: float(above / below)}

    def _jacobian(self, u: Array, values: Mapping[str, float]) -> Any:
        """J - c G - G u dc, in the form in which the function gives J."""
        from scipy.sparse import csc_matrix, issparse
        from scipy.sparse.linalg import LinearOperator

        assert self.still.jacobian is not None
        J, f, w = self.still.jacobian(u, values), np.asarray(self.still.residual(u, values)), self.turning.along(u)
        above, below = self._inner(u, f)
        c = above / below
        a, b, k, rate = self.mode.a, self.mode.b, self.decay, self.mode.rate
        if isinstance(J, LinearOperator):

            def product(v: Array) -> Array:
                v = np.asarray(v).ravel()
                moved = np.asarray(J @ v)
                by = (b @ moved + k * (b @ v) - c * rate * (a @ v)) / below
                return np.asarray(moved - c * self.turning.along(v) - by * w)

            return LinearOperator(J.shape, matvec=product, dtype=float)
        by = (J.T @ b + k * b - c * rate * a) / below
        if not issparse(J):
            return np.asarray(J) - c * self.generator_matrix - np.outer(w, by)
        full = J.toarray() - c * self.generator_matrix - np.outer(w, by)
        rows, starts = np.tile(np.arange(self.n, dtype=np.int32), self.n), np.arange(0, self.n**2 + 1, self.n)
        matrix: csc_matrix = csc_matrix((full.ravel("F"), rows, starts), shape=full.shape)  # zeros too: one pattern
        return matrix

    def _parameter_slope(self, u: Array, values: Mapping[str, float], name: str) -> Array:
        assert self.still.parameter_jacobian is not None
        slope = np.asarray(self.still.parameter_jacobian(u, values, name))
        return np.asarray(slope - (self.mode.b @ slope) / (self.mode.rate * (self.mode.a @ u)) * self.turning.along(u))

    def _form(self, u: Array, values: Mapping[str, float], *directions: Array) -> Array:
        """D^k (F - c G u)[d_1, ..., d_k] by the rules of products and quotients, k = 2 or 3; G u is linear."""
        n, given = self.n, self.still.derivative
        assert given is not None
        whole = frozenset(range(len(directions)))
        forms: dict[frozenset[int], Vector] = {frozenset(): np.asarray(self.still.residual(u, values))}
        system_slope = self._slope_of_function(u, values)
        for part in _parts(whole):
            chosen = [directions[i] for i in sorted(part)]
            forms[part] = system_slope(chosen[0]) if len(chosen) == 1 else np.asarray(given(u, values, *chosen))
        below = self.mode.rate * (self.mode.a @ u)
        rates: dict[frozenset[int], Any] = {}
        for part in [frozenset(), *_parts(whole)]:
            above = self.mode.b @ forms[part]
            if len(part) == 0:
                above = above + self.decay * (self.mode.b @ u)
            if len(part) == 1:
                above = above + self.decay * (self.mode.b @ directions[min(part)][:n])
            for i in part:
                above = above - rates[part - {i}] * self.mode.rate * (self.mode.a @ directions[i][:n])
            rates[part] = above / below
        out = forms[whole] - rates[whole] * self.turning.along(u)
        for i in whole:
            out = out - rates[whole - {i}] * self.turning.along(directions[i][:n])
        return np.asarray(out)

    def _slope_of_function(self, u: Array, values: Mapping[str, float]) -> Callable[[Array], Array]:
        """DF[d] of the function itself."""
        system, p = self._own, np.array([values[name] for name in self.parameter_names])
        return lambda d: system.lines.first(u, p, d)

    @property
    def _own(self) -> Any:
        if "_still_system" not in self.__dict__:
            self.__dict__["_still_system"] = self.still.system()
        return self.__dict__["_still_system"]

    def _holds(self, symmetry: FunctionSymmetry) -> bool:
        """Whether a symmetry of the function is one in the frame, at states near the start."""
        chance = np.random.default_rng(2)
        for u in (self.u0, self.u0 * chance.uniform(0.8, 1.2, self.n), self.u0 * chance.uniform(0.8, 1.2, self.n)):
            image = np.asarray(symmetry.map(u), dtype=float)
            there = self._residual(image, self.values)
            here = np.asarray(symmetry.map(self._residual(u, self.values)), dtype=float)
            terms = max(norm(np.asarray(self.still.residual(u, self.values))), norm(self.turning.along(u)) * self.decay)
            if not norm(there - here) <= HOLDS * max(terms, norm(here)):
                return False
        return True


def _parts(whole: frozenset[int]) -> Iterator[frozenset[int]]:
    """Subsets but the empty one, small ones first."""
    for size in range(1, len(whole) + 1):
        yield from (frozenset(part) for part in combinations(sorted(whole), size))


def in_frame(problem: FunctionProblem, states: Array, p: Array) -> tuple[FunctionInFrame, Array] | None:
    """The function in the frame for states (K, n), and these turned to its phase; None where nothing turns them.

    Raises InputError where the rotation is no symmetry, or the frame's Jacobian is out of reach.
    """
    turning = problem.rotation
    if turning is None or not turning.moves(states[0]):
        return None
    _check_size(problem)
    mode = turning.mode_of(states)
    turned = turning.in_phase(states, mode)
    _check_symmetry(problem, turning, mode, turned[0], p)
    return FunctionInFrame(problem, turning, mode, turned[0], p), turned


def _check_size(problem: FunctionProblem) -> None:
    if problem.method == "sparse" and problem.n > LARGEST_FULL:
        raise InputError(
            f"function {problem.name!r} has {problem.n} states; in the frame of a rotation the Jacobian is full, for "
            f"up to {LARGEST_FULL} of them. Give it as a LinearOperator, with a preconditioner"
        )
    if problem.jacobian is None and problem.n > DENSE:
        raise InputError(
            f"function {problem.name!r} has {problem.n} states; a rotation needs its jacobian beyond {DENSE} of them"
        )


def _check_symmetry(problem: FunctionProblem, turning: Rotation, mode: Mode, u: Array, p: Array) -> None:
    """F_u G u = G F at sums of turned copies of the start and of its square, which has other modes."""
    system, chance, worst = problem.system(), np.random.default_rng(3), 0.0
    padding, parts = np.zeros(system.m), (u, u * (u / np.abs(u).max()))
    for _ in range(SAMPLES):
        angles = chance.uniform(-3.0, 3.0, 2) / mode.rate
        at = u + PUSHED * sum(turning.turned(one, x) for one in parts for x in angles)
        left = system.lines.first(at, p, np.concatenate([turning.along(at), padding]))
        right = turning.along(system.value(at, p))
        if np.all(np.isfinite(left)) and np.all(np.isfinite(right)):
            worst = max(worst, norm(left - right) / max(norm(left), norm(right), 1e-300))
    if worst > WRONG:
        raise InputError(
            f"rotation: not a symmetry of {problem.name!r}: F_u G u and G F differ by {worst:.2g} of their size (on "
            "a coarse grid products alias: take more points)"
        )
    if worst > EXACT:
        warnings.warn(
            f"{problem.name}: the rotation is a symmetry to {worst:.1g} only (differences in place of derivatives?): "
            "waves are those of F = c G u, with an error of about that size",
            InputWarning,
            stacklevel=2,
        )
