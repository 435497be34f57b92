"""Equilibria of flows and fixed points of maps of a compiled model, as a continuation problem in one parameter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.abi import NO_FUNCTION, Array, Vector
from contin.continuation import march as python_march
from contin.continuation.metric import far_from_zero
from contin.continuation.problem import (
    NOTHING,
    STOPS,
    Chunk,
    Corner,
    Floor,
    Frame,
    Jump,
    Outcome,
    Problem,
    Rejected,
    Renewal,
    Sample,
    Stop,
    Verified,
)
from contin.continuation.settings import Settings
from contin.errors import NotFiniteError
from contin.kernels import algebraic as kernel
from contin.machine import elementary
from contin.model.evaluate import evaluate
from contin.model.model import Model
from contin.problems import corners, special
from contin.problems.branching.at_start import unfolded
from contin.problems.describe import with_normal_form
from contin.problems.functions.crossing import cross_unnamed_corner, unnamed_corner
from contin.problems.functions.march import DenseMarch
from contin.problems.functions.system import FunctionSystem
from contin.problems.functions.turning import no_fold
from contin.problems.kernel_memory import memory_of
from contin.problems.massless import finite_eigenvalues
from contin.problems.neutral import NeutralMarch, is_neutral
from contin.problems.neutral import remarks as neutral_remarks
from contin.problems.poles import cut_before_pole, end_at_pole
from contin.problems.polish import at_parameter
from contin.problems.scaled import ScaledSystem
from contin.problems.scales import bending_lengths, parameter_width, state_scales
from contin.problems.surfaces import boundary
from contin.problems.surfaces.sliding import Sliding
from contin.problems.symmetry import reversing_symmetries
from contin.problems.touching import beyond
from contin.simulate.natural import BENDS_UP_TO, growth_lengths, guessed_note, pure_derivatives, sizes_of
from contin.simulate.reach import has_reach, is_constrained, left_reach
from contin.special.table import test_on_branch
from contin.symbolic.passes.translations import translation_notes

if TYPE_CHECKING:
    from contin.systems.protocol import System

_NO_TANGENT = np.empty(0)
ON_FLOOR = 1e-9  # scaled: how near to a value at which the equations have none Newton's method comes
NO_GROWTH = -1.0  # in place of an angle's period: a state whose size does not matter


@dataclass(frozen=True, eq=False)
class EquilibriumProblem(Problem):
    """F(u, p) = f(u, p) = 0 (flow) or f(u, p) - u = 0 (map), one parameter free.

    `base` holds all parameter values (m,); entry `active` varies. The compiled system is held here: the addresses that
    kernels get must not outlive it.
    """

    system: System  # contin.lowering.CompiledSystem
    base: Array
    active: int
    angle_periods: Array = field(default_factory=lambda: np.zeros(0))
    sliding: Sliding | None = None  # of pseudo-equilibria: the surface that they lie on

    locus = None
    parts_touching = True

    def __post_init__(self) -> None:
        if self.angle_periods.size == 0:
            object.__setattr__(self, "angle_periods", np.zeros(self.system.n))

    @cached_property
    def kind(self) -> str:
        return "fixed-point" if self.is_map else "equilibrium"

    @cached_property
    def maximum_chunk(self) -> int:
        """A chunk of some 30 ms: a step costs about 1.5 us, and 15 n^3 ns for the eigenvalues of large systems."""
        return int(min(2000.0, max(4.0, 0.03 / (1.5e-6 + 1.5e-8 * self.n**3))))

    @cached_property
    def floors(self) -> tuple[Floor, ...]:
        """States with a declared minimum (amplitudes): the branch ends where one falls to it."""
        model = getattr(self.system, "model", None)
        if not isinstance(model, Model):
            return ()
        values = dict(zip(self.system.parameter_names, (float(v) for v in self.base), strict=True))
        found = []
        for k, s in enumerate(model.states):
            if s.minimum is not None:
                lowest = float(evaluate(s.minimum, values))
                u, _ = model.start_point()
                u[k] = lowest
                alone = np.where(np.arange(self.n) == k, lowest, 0.0)  # or the only one that is not at rest
                singular = not all(np.all(np.isfinite(self.system.value(v, self.base))) for v in (u, alone))
                text = f"{s.name} fell to its lowest value. {s.beyond or ''}".rstrip()
                found.append(Floor(k, lowest, text, singular))
        return tuple(found)

    @property
    def motion(self) -> str | None:
        """The surface that the state slides on, in words: branches of different motions are never one."""
        return None if self.sliding is None else self.sliding.jump.surface.text

    def separated(self, a: Array, b: Array) -> bool:
        """True where a surface on which the equations jump lies between a and b: no branch leads across."""
        return bool(self.system.n_switches) and boundary.separated(self, a, b)

    @cached_property
    def is_map(self) -> bool:
        return bool(self.system.kind == "map")

    @cached_property
    def n(self) -> int:
        return int(self.system.n)

    @cached_property
    def parameters(self) -> tuple[str, ...]:
        return (self.system.parameter_names[self.active],)

    def with_active(self, name: str, z: Array | None = None) -> EquilibriumProblem:
        """The same system with another parameter free; the present one is frozen at its value in z."""
        base = self.base.copy()
        if z is not None:
            base[self.active] = z[-1]
        return replace(self, base=base, active=list(self.system.parameter_names).index(name))

    def full_parameters(self, z: Array) -> Array:
        """All parameter values at z."""
        p = self.base.copy()
        p[self.active] = z[-1]
        return p

    def constants(self) -> dict[str, float]:
        return {name: float(v) for name, v in zip(self.system.parameter_names, self.base, strict=True)}

    def default_range(self, parameter: str) -> tuple[float, float] | None:
        """The model's own range of a parameter, at the present parameter values."""
        found = self.system.model.parameter_range(
            parameter, dict(zip(self.system.parameter_names, self.base, strict=True))
        )
        return None if found is None else (float(found[0]), float(found[1]))

    @cached_property
    def _trust(self) -> float:
        """See `kernels.algebraic.correct`."""
        return 0.0 if self.system.n_switches else 0.01

    # -- evaluation ---------------------------------------------------------------------------------------------------

    def linearise(self, z: Array) -> tuple[Array, Array]:
        """F (n,) and [F_u F_p] (n, n + 1), unscaled."""
        f, jacobian = self.system.jacobian(z[:-1], self.full_parameters(z))
        matrix = self._active_columns(jacobian)
        if self.is_map:
            f = f - z[:-1]
            matrix[:, : self.n] -= np.eye(self.n)
        return f, matrix

    def linearised(self, z: Array) -> tuple[Array, Array]:
        """`linearise` at rows z (m, n + 1): (m, n) and (m, n, n + 1)."""
        n = self.n
        f, jacobians = self.system.jacobians(z[:, :n], self._all_parameters(z))
        matrices = np.concatenate([jacobians[:, :, :n], jacobians[:, :, n + self.active, None]], axis=2)
        if self.is_map:
            f = f - z[:, :n]
            matrices[:, :, :n] -= np.eye(n)
        return f, matrices

    def form(self, z: Array, *directions: Vector) -> Vector:
        """D^kf(z)[d1, .., dk] of the model's equations (for k >= 2 the same as of F), directions (n + 1,) = (state.

        Active parameter), real or complex.
        """
        n, width = self.n, self.n + len(self.base)
        wide = []
        for d in directions:
            v = np.zeros(width, d.dtype)
            v[:n] = d[:n]
            v[n + self.active] = d[n]
            wide.append(v)
        return np.asarray(self.system.derivative(z[:n], self.full_parameters(z), *wide))

    def hessian(self, z: Array, v: Vector) -> Vector:
        """The matrix D^2F(z)[v, .], (n, n + 1), for a direction v (n + 1,) = (state, active parameter)."""
        wide = np.zeros(self.n + len(self.base), v.dtype)
        wide[: self.n] = v[: self.n]
        wide[self.n + self.active] = v[self.n]
        matrix = self.system.gradient(z[: self.n], self.full_parameters(z), wide)
        return self._active_columns(matrix)

    def _active_columns(self, matrix: Vector) -> Vector:
        """Derivatives in the states and the active parameter, of those in the states and all parameters."""
        chosen = np.empty((self.n, self.n + 1), matrix.dtype)
        chosen[:, : self.n] = matrix[:, : self.n]
        chosen[:, self.n] = matrix[:, self.n + self.active]
        return chosen

    def linear_part(self, z: Array) -> Array:
        """The matrix whose eigenvalues decide stability: f_u."""
        if isinstance(self.system, FunctionSystem):  # differences by the parameters would cost the user's time
            with np.errstate(all="ignore"):
                return self.system.state_jacobian(np.array(z[:-1]), self.full_parameters(z))
        _, matrix = self.linearise(z)
        return matrix[:, : self.n] + (np.eye(self.n) if self.is_map else 0.0)

    def scaled(self, scale: Array) -> ScaledSystem:
        """The same equations in unknowns z / scale."""
        return ScaledSystem(self, scale)

    def _second_derivatives(self, z: Array) -> Array:
        """d^2 F_k / d u_i^2, (n, n)."""
        directions = np.eye(self.n, self.n + 1)
        return np.column_stack([self.hessian(z, directions[i])[:, i] for i in range(self.n)])

    # -- the engine's contract ----------------------------------------------------------------------------------------

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        states, _, width = self._scales(z, bounds)
        return np.append(np.sqrt(self.n) * states, width)

    def guessed(self, z: Array, bounds: tuple[float, float]) -> Sequence[str]:
        """The states whose scale at the start is a mere 1."""
        if z[:-1].all() or not self.system.state_names:
            return ()
        _, unknown, _ = self._scales(z, bounds)
        return [name for name, is_unknown in zip(self.system.state_names, unknown, strict=True) if is_unknown]

    def guess_note(self, columns: Sequence[str]) -> str:
        """What to say of them."""
        return guessed_note(columns)

    def _scales(self, z: Array, bounds: tuple[float, float]) -> tuple[Array, Array, float]:
        """Sizes of the states (n,), which of them are a mere 1, and the scale of the parameter."""
        place = z.tobytes(), *bounds
        if place not in self._known_scales:
            self._known_scales.clear()  # asked for at a start, and of that again at the end
            self._known_scales[place] = self._found_scales(z, bounds)
        return self._known_scales[place]

    @cached_property
    def _known_scales(self) -> dict[tuple[object, ...], tuple[Array, Array, float]]:
        return {}

    def _found_scales(self, z: Array, bounds: tuple[float, float]) -> tuple[Array, Array, float]:
        width = parameter_width(self.system.model, self.parameters[0], float(z[-1]), bounds)
        jacobian = self.linearise(z)[1]
        declared, usual = sizes_of(self.system.model, tuple(self.full_parameters(z).tolist()))
        declared = np.where(self.angle_periods > 0.0, self.angle_periods / (2.0 * np.pi), declared)
        lengths = None
        if self.n <= BENDS_UP_TO and np.any(z[:-1] != 0.0):
            lengths = bending_lengths(jacobian, self._second_derivatives(z), width)
        growth = partial(self._growth, z, jacobian, width) if self.n <= BENDS_UP_TO else None
        states, unknown = state_scales(z[:-1], jacobian, width, declared, usual, lengths, growth)
        return states, unknown, width

    def _growth(self, z: Array, jacobian: Array, width: float) -> tuple[Array, Array]:
        """`growth_lengths` at rest, (n,), with slopes as large as they become; and second derivatives (n, n)."""
        p = self.full_parameters(z)
        by_parameter = self.hessian(z, np.eye(1, self.n + 1, self.n)[0])[:, : self.n]
        slopes = np.maximum(np.abs(jacobian[:, : self.n]), np.abs(by_parameter) * width)
        second, third = pure_derivatives(self.system, z[: self.n], p)
        return growth_lengths(np.nan_to_num(slopes), second, third), second

    def tangents(self, z: Array, scale: Array) -> Sequence[Array]:
        if not np.all(np.isfinite(self.linearise(z)[1])):
            raise NotFiniteError(f"no branch passes here: {self.describe_failure(z)}")
        return special.branch_tangents(self.scaled(scale), z / scale)

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        if self.system.jacobian_address == NO_FUNCTION:
            return python_march.march(
                DenseMarch(self), origin, before, length, frame, step, limit, bounds, settings, loop
            )

        if is_neutral(self, origin.z, origin.eigenvalues, frame.scale):
            dense = NeutralMarch(self, frame.scale)
            return python_march.march(dense, origin, before, length, frame, step, limit, bounds, settings, loop)

        n = self.n
        rows = limit + 1
        z, t, tests = np.empty((rows, n + 1)), np.empty((rows, n + 1)), np.empty((rows, kernel.TESTS))
        unstable = np.zeros(rows, np.int64)
        re, im, lengths, info = np.empty((rows, n)), np.empty((rows, n)), np.zeros(rows), np.zeros(6)
        z[0], t[0] = origin.z, origin.tangent
        controls = np.array([
            step, settings.min_step, settings.max_step, elementary.cos(np.radians(settings.max_angle)),
            settings.newton_tolerance,
            length if before is not None else 0.0, np.radians(settings.max_angle) / 2.5, self._trust,
        ])  # fmt: skip
        reason = kernel.march(
            self.system.jacobian_address, self.is_map, self.base.copy(), self.active, frame.scale,
            np.array(bounds, dtype=float), controls, limit,
            origin.tangent if before is None else before.tangent,
            np.zeros(kernel.TESTS) if before is None else before.tests,
            _NO_TANGENT if loop is None else loop.z, _NO_TANGENT if loop is None else loop.tangent,
            np.where(far_from_zero(origin.z, frame.scale, self.angle_periods), NO_GROWTH, self.angle_periods),
            z, t, tests, unstable, re, im, lengths, info, *memory_of(n, len(self.base)),
        )  # fmt: skip
        stop = STOPS[reason]
        m = int(info[0]) + 1
        detail = ""
        if stop is Stop.NOT_FINITE:
            nearby = z[m - 1] + frame.scale * info[1] * t[m - 1]
            detail = self.system.explain(nearby[:n], self.full_parameters(nearby)) or ""
        chunk = Chunk(
            z[:m], t[:m], tests[:m], unstable[:m], re[:m] + 1j * im[:m], lengths[:m], stop,
            float(info[1]), float(info[3]), int(info[4]), int(info[2]), detail,
        )  # fmt: skip
        if is_constrained(self.system):
            chunk = cut_before_pole(self.system, chunk, self._all_parameters(chunk.z), n)
        return corners.one_corner_a_step(self, boundary.cut_at_surface(self, chunk))

    def _all_parameters(self, z: Array) -> Array:
        """All parameter values of rows z."""
        p = np.empty((len(z), self.base.size))
        p[:] = self.base
        p[:, self.active] = z[:, -1]
        return p

    def foretold(self, origin: Sample, before: Sample | None, frame: Frame) -> Renewal | None:
        """The end at a surface of discontinuity, or a singularity of algebraic equations, that lies ahead."""
        def determinant(z: Array) -> float:
            return float(self.system.index_determinants(z[None, : self.n], self._all_parameters(z[None]))[0])  # type: ignore[attr-defined]

        def probe(base: Sample, length: float) -> Sample | None:
            return self.probe(base, length, base.z + length * frame.scale * base.tangent, frame, Settings())

        pole = end_at_pole(self.system, origin, frame, self.parameters[0], determinant, probe)
        return pole or boundary.foretold(self, origin, frame)

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        if self.system.jacobian_address == NO_FUNCTION:
            return python_march.probe(DenseMarch(self), base, length, guess, frame, settings)
        if is_neutral(self, base.z, base.eigenvalues, frame.scale):
            return python_march.probe(NeutralMarch(self, frame.scale), base, length, guess, frame, settings)

        return self._probes(base, np.array([length]), guess[None].copy(), frame, settings)[0]

    def probes(
        self, base: Sample, lengths: Array, guesses: Array, frame: Frame, settings: Settings
    ) -> Sequence[Sample | None]:
        """`probe` at several lengths, from the rows of `guesses`."""
        compiled = self.system.jacobian_address != NO_FUNCTION
        if compiled and not is_neutral(self, base.z, base.eigenvalues, frame.scale):
            return self._probes(base, lengths, guesses, frame, settings)
        return [self.probe(base, *place, frame, settings) for place in zip(lengths.tolist(), guesses, strict=True)]

    def _probes(
        self, base: Sample, lengths: Array, guesses: Array, frame: Frame, settings: Settings
    ) -> Sequence[Sample | None]:
        """The same in one kernel call."""
        shape = len(lengths), self.n
        z, t, tests = guesses, np.empty(guesses.shape), np.empty((shape[0], kernel.TESTS))
        re, im, counts = np.empty(shape), np.empty(shape), np.empty(shape[0], np.int64)
        kernel.probes(
            self.system.jacobian_address, self.is_map, base.z, base.tangent, lengths, self.base.copy(), self.active,
            frame.scale, min(settings.tolerance, 1e-9), self._trust, frame.reference, z, t, tests, re, im, counts,
            *memory_of(self.n, len(self.base)),
        )  # fmt: skip
        values = re + 1j * im
        rows = zip(z, t, tests, counts.tolist(), values, strict=True)
        return [None if row[3] < 0 else Sample(*row) for row in rows]

    def at_parameter(self, guess: Array, value: float, scale: Array) -> Array | None:
        return at_parameter(self, guess, value, scale)

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        return special.explain(self.is_map, a, b)

    def watch(self, type_: str) -> int | None:
        return test_on_branch(type_)

    def verify(self, type_: str, near: Sample, frame: Frame) -> Outcome:
        return self._described(self._turning(special.verify(self, type_, near, frame), near, frame), frame)

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
        found = (self._turning(item, a, frame) for item in special.verify_compound(self, a, b, frame))
        return [self._described(item, frame) for item in found]

    def _turning(self, found: Outcome, near: Sample, frame: Frame) -> Outcome:
        """A fold of a user's function only where the curve itself turns: its derivatives may be wrong."""
        if self.system.jacobian_address != NO_FUNCTION or (isinstance(found, Verified) and found.type != "LP"):
            return found
        if not isinstance(found, Verified):
            return self._corner_beside(near, frame) or found
        here = DenseMarch(self).linearisation(found.z, near.tangent, frame.scale)
        why = no_fold(lambda z: self.linearise(z)[0], here, found.z, frame.scale)
        return found if why is None else Rejected(f"no LP near {self.parameters[0]} = {found.z[-1]:.10g}: {why}")

    def _described(self, found: Outcome, frame: Frame) -> Outcome:
        if not isinstance(found, Verified):
            return found
        if any(f.singular and found.z[f.index] - f.lowest <= ON_FLOOR * frame.scale[f.index] for f in self.floors):
            return NOTHING  # it is none of this branch, which ends there
        return with_normal_form(self, found, frame.scale)

    def _corner_beside(self, near: Sample, frame: Frame) -> Rejected | None:
        """What a corner of a user's function does at a sample; None where there is none."""
        if self.system.jacobian_address != NO_FUNCTION or self.system.n_switches:
            return None
        corner = unnamed_corner(self, near, frame)
        if corner is None:
            return None
        place = f"near {self.parameters[0]} = {corner.z[-1]:.10g}, where the function is not smooth"
        turns = corner.before[-1] * corner.beyond[-1] < 0.0
        return Rejected(
            f"the parameter turns at a corner {place}" if turns else f"the branch bends at a corner {place}"
        )

    def verify_corner(self, a: Sample, b: Sample, frame: Frame) -> Outcome | Jump | None:
        found = self._corner_beside(a, frame)
        if found is None:
            return corners.verify_corner(self, a, b, frame)
        return found if a.unstable == b.unstable else Jump(found.reason)

    def columns(self, z: Array) -> dict[str, Array]:
        n, names = self.n, self.system.parameter_names
        columns: dict[str, Array] = {names[self.active]: z[:, -1].copy()}
        for k, name in enumerate(self.system.state_names):
            columns[name] = z[:, k].copy()
        if self.system.observable_names:
            p = np.tile(self.base, (len(z), 1))
            p[:, self.active] = z[:, -1]
            recorded = self.system.observables(np.ascontiguousarray(z[:, :n]), p)
            for k, name in enumerate(self.system.observable_names):
                columns[name] = recorded[:, k].copy()
        return columns

    def remarks(self, z: Array, eigenvalues: NDArray[np.complex128]) -> Sequence[str]:
        """What holds all along the branch (rows z)."""
        bounds = float(z[:, -1].min()), float(z[:, -1].max())
        return neutral_remarks(self, z, lambda: self.initial_scale(z[0], bounds))

    def finite(self, z: Array, values: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Without the eigenvalues of algebraic equations."""
        return finite_eigenvalues(self.system, values)

    @property
    def has_reach(self) -> bool:
        return has_reach(self.system)

    def left_reach(self, z: Array) -> tuple[int, str] | None:
        """The first row at which the model does not hold, and why."""
        return left_reach(self.system, z[:, : self.n], self._all_parameters(z))

    def cross_corner(
        self, last: Sample, frame: Frame, settings: Settings
    ) -> tuple[Sample, Verified | Corner | None] | None:
        if self.system.jacobian_address == NO_FUNCTION and not self.system.n_switches:
            return cross_unnamed_corner(self, last, frame, settings)
        crossed = corners.cross_corner(self, last, frame, settings)
        return None if crossed is None or self.separated(last.z, crossed[0].z) else crossed

    def reverses(self, z: Array, tangent: Array, scale: Array, symmetries: Sequence[str]) -> bool:
        return bool(symmetries) and any(name in symmetries for name in reversing_symmetries(self, z, tangent, scale))

    def unfolded(self, z: Array, frame: Frame) -> tuple[Sample, Verified, Mapping[int, Array]] | None:
        return unfolded(self, z, frame)

    def beyond(self, point: Verified, frame: Frame, settings: Settings) -> Sample | None:
        return beyond(self, point, frame, settings)

    def explain_columns(self, z: Array) -> str | None:
        """The first observable that is not finite at z, and why."""
        text: str | None = self.system.explain_observables(z[:-1], self.full_parameters(z))
        return text

    def describe_failure(self, z: Array) -> str:
        near = self.system.trouble_near(z[:-1], self.full_parameters(z))
        if near:
            return f"Beyond, {near}"
        text = self.system.explain(z[:-1], self.full_parameters(z))
        if text:
            return str(text)
        _, matrix = self.linearise(z)
        if not np.all(np.isfinite(matrix)):
            return "The equations have no derivatives here."
        values = np.linalg.svd(matrix, compute_uv=False)
        if values[-1] < 1e-9 * values[0]:
            known = translation_notes(self.system.model)
            if known:
                return f"The Jacobian is singular here: {'; '.join(known)}."
            return (
                "The Jacobian is singular here: a branch point where Newton stalls (start off it), or the equations "
                "are dependent (a conserved quantity or a continuous symmetry; fix it by an equation or a parameter)."
            )
        return (
            "Try a smaller settings.step or min_step, or a larger settings.tolerance; check that the equations are "
            "smooth here."
        )
