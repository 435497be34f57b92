"""Equilibria of flows and fixed points of maps of a compiled model, as a continuation problem in one parameter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from contin.abi import NO_FUNCTION, Array
from contin.continuation import march as python_march
from contin.continuation.outcome import NOTHING, Corner, Jump, Outcome, Rejected, Verified
from contin.continuation.problem import Floor, Renewal
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.settings import Settings
from contin.errors import NotFiniteError
from contin.model.evaluate import evaluate
from contin.model.model import Model
from contin.problems.algebraic_states import finite_eigenvalues
from contin.problems.at_fixed_parameter import at_parameter
from contin.problems.dense_march import DenseMarch
from contin.problems.equilibria import corners, special_points
from contin.problems.equilibria import march_in_kernel as in_kernel
from contin.problems.equilibria.branching.at_start import unfolded
from contin.problems.equilibria.corners_of_functions import cross_unnamed_corner, unnamed_corner
from contin.problems.equilibria.equations import AlgebraicEquations
from contin.problems.equilibria.normal_forms import with_normal_form
from contin.problems.equilibria.rounding_of_tests import branch_point_is_lost, pair_is_lost
from contin.problems.equilibria.scaled import ScaledSystem
from contin.problems.equilibria.singularity_induced import cut_before_pole, end_at_pole, end_without_mass, has_poles
from contin.problems.equilibria.start_metric import scales_at
from contin.problems.equilibria.tangent_branches import beyond
from contin.problems.neutral_pairs import NeutralMarch, is_neutral
from contin.problems.neutral_pairs import remarks as neutral_remarks
from contin.problems.state_columns import state_columns
from contin.problems.surfaces import boundary
from contin.problems.symmetry import reversing_symmetries
from contin.problems.turning_at_folds import no_fold
from contin.simulate.natural import guessed_note
from contin.simulate.reach import has_reach, left_reach
from contin.special.table import test_on_branch
from contin.symbolic.passes.translations import translation_notes
from contin.systems.iterate import IteratedSystem

ON_FLOOR = 1e-9  # scaled: how near to a value at which the equations have none Newton's method comes


@dataclass(frozen=True, eq=False)
class EquilibriumProblem(AlgebraicEquations):
    """F(u, p) = f(u, p) = 0 (flow) or f(u, p) - u = 0 (map), one parameter free.

    `base` holds all parameter values (m,); entry `active` varies. The compiled system is held here: the addresses that
    kernels get must not outlive it.
    """

    locus = None
    parts_touching = True

    @cached_property
    def kind(self) -> str:
        return "fixed-point" if self.is_map else "equilibrium"

    @cached_property
    def maximum_chunk(self) -> int:
        """A chunk of some 30 ms: a step costs about 1.5 us, and 15 n^3 ns for the eigenvalues of large systems."""
        return int(min(2000.0, max(4.0, 0.03 / (1.5e-6 + 1.5e-8 * self.n**3))))

    @cached_property
    def floors(self) -> tuple[Floor, ...]:
        """Where branches end: a state falls to its declared minimum (amplitudes), or all fall to zero together.

        The latter where the equations have no derivative there.
        """
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
        if self.n > 1 and not found and self._is_singular_at_rest:
            names = ", ".join(s.name for s in model.states)
            beyond = " ".join(s.beyond for s in model.states if s.beyond)
            text = f"{names} fell to zero together, where the equations are not smooth. {beyond}".rstrip()
            found.append(Floor(0, 0.0, text, True, tuple(range(self.n))))
        return tuple(found)

    @property
    def _is_singular_at_rest(self) -> bool:
        """True where f or its derivative has no value at u = 0, as of formulas with u/|u| or x y/(x + y)."""
        f, matrix = self.system.jacobian(np.zeros(self.n), self.base)
        return not (np.isfinite(f).all() and np.isfinite(matrix).all())

    @property
    def motion(self) -> str | None:
        """The surface that the state slides on, in words: branches of different motions are never one."""
        return None if self.sliding is None else self.sliding.jump.surface.text

    def separated(self, a: Array, b: Array) -> bool:
        """True where a surface on which the equations jump lies between a and b: no branch leads across.

        Of pseudo-equilibria also where motion does not slide at b.
        """
        if self.sliding is not None and not boundary.slides(self, b):
            return True
        return bool(self.system.n_switches) and boundary.separated(self, a, b)

    # -- the engine's contract ----------------------------------------------------------------------------------------

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        states, _, width = self._scales(z, bounds)
        return np.append(np.sqrt(self.n) * states, width)

    def _scales(self, z: Array, bounds: tuple[float, float]) -> tuple[Array, NDArray[np.bool_], float]:
        """`scales_at`, kept for the last start: it is asked for there, and of that again at the end."""
        place = z.tobytes(), *bounds
        if place not in self._known_scales:
            self._known_scales.clear()
            self._known_scales[place] = scales_at(self, z, bounds)
        return self._known_scales[place]

    @cached_property
    def _known_scales(self) -> dict[tuple[object, ...], tuple[Array, NDArray[np.bool_], float]]:
        return {}

    def guessed(self, z: Array, bounds: tuple[float, float]) -> Sequence[str]:
        """The states whose scale at the start is a mere 1."""
        if z[:-1].all() or not self.system.state_names:
            return ()
        _, unknown, _ = self._scales(z, bounds)
        return [name for name, is_unknown in zip(self.system.state_names, unknown, strict=True) if is_unknown]

    def guess_note(self, columns: Sequence[str]) -> str:
        """What to say of them."""
        return guessed_note(columns)

    def tangents(self, z: Array, scale: Array) -> Sequence[Array]:
        if not np.all(np.isfinite(self.linearise(z)[1])):
            raise NotFiniteError(f"no branch passes here: {self.describe_failure(z)}")
        return special_points.branch_tangents(ScaledSystem(self, scale), z / scale)

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
        chunk = in_kernel.march(self, origin, before, length, frame, step, limit, bounds, settings, loop)
        if has_poles(self.system):
            chunk = cut_before_pole(self.system, chunk, self.rows_of_parameters(chunk.z), self.n)
        return corners.one_corner_a_step(self, boundary.cut_at_surface(self, chunk), frame.scale)

    def foretold(self, origin: Sample, before: Sample | None, frame: Frame) -> Renewal | None:
        """The end at a surface of discontinuity, or a singularity of algebraic equations, that lies ahead."""

        def determinant(z: Array) -> float:
            return float(self.system.index_determinants(z[None, : self.n], self.rows_of_parameters(z[None]))[0])  # type: ignore[attr-defined]

        def probe(base: Sample, length: float) -> Sample | None:
            return self.probe(base, length, base.z + length * frame.scale * base.tangent, frame, Settings())

        pole = end_without_mass(self.system, origin, frame, self.parameters[0], self.rows_of_parameters) or end_at_pole(
            self.system, origin, frame, self.parameters[0], determinant, probe
        )
        return pole or boundary.foretold(self, origin, frame)

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        if self.system.jacobian_address == NO_FUNCTION:
            return python_march.probe(DenseMarch(self), base, length, guess, frame, settings)
        return self.probes(base, np.array([length]), guess[None].copy(), frame, settings)[0]

    def probes(
        self, base: Sample, lengths: Array, guesses: Array, frame: Frame, settings: Settings
    ) -> Sequence[Sample | None]:
        """`probe` at several lengths, from the rows of `guesses`."""
        if self.system.jacobian_address == NO_FUNCTION:
            places = zip(lengths.tolist(), guesses, strict=True)
            return [self.probe(base, *place, frame, settings) for place in places]
        return self._counted_anew(base, in_kernel.probes(self, base, lengths, guesses, frame, settings), frame.scale)

    def _counted_anew(self, base: Sample, found: Sequence[Sample | None], scale: Array) -> Sequence[Sample | None]:
        """Points that the kernel has found, with tests of exact pairs where there are such at their base."""
        if not is_neutral(self, base.z, base.eigenvalues, scale):
            return found
        march = NeutralMarch(self, scale)
        return [None if sample is None else march.counted(sample) for sample in found]

    def points_between(
        self, base: Sample, ends: tuple[Sample, Sample], lengths: tuple[float, float], fractions: Sequence[float],
        frame: Frame, settings: Settings,
    ) -> Sequence[Sample | None] | None:  # fmt: skip
        if self.system.jacobian_address == NO_FUNCTION:
            return None
        found = in_kernel.points_between(self, base, ends, lengths, fractions, frame, settings)
        return self._counted_anew(base, found, frame.scale)

    def tests_between(
        self, base: Sample, ends: tuple[Sample, Sample], lengths: tuple[float, float], fractions: Sequence[float],
        frame: Frame, settings: Settings,
    ) -> tuple[Array, Sequence[int]] | None:  # fmt: skip
        compiled = self.system.jacobian_address != NO_FUNCTION
        if not compiled or is_neutral(self, base.z, base.eigenvalues, frame.scale):
            return None
        return in_kernel.tests_between(self, base, ends, lengths, fractions, frame, settings)

    def at_parameter(self, guess: Array, value: float, scale: Array) -> Array | None:
        return at_parameter(self, guess, value, scale)

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        return special_points.explain(self.is_map, a, b)

    def test_of(self, type_: str) -> int | None:
        return test_on_branch(type_)

    def is_lost(self, test: int, z: Array, scale: Array) -> bool:
        jacobian = self.linearise(z)[1] * scale / scale[:-1, None]
        if not np.isfinite(jacobian).all():
            return False
        if test == self.test_of("BP"):
            return branch_point_is_lost(jacobian)
        return test == self.test_of("HB") and not self.is_map and pair_is_lost(jacobian[:, :-1])

    @cached_property
    def _opaque(self) -> bool:
        """True for functions whose corners nobody knows; iterates of formulas are as smooth as these."""
        system = self.system.base if isinstance(self.system, IteratedSystem) else self.system
        return bool(system.jacobian_address == NO_FUNCTION)

    @property
    def is_smooth(self) -> bool:
        return not (self._opaque or self.system.n_switches)

    def verify(self, type_: str, near: Sample, frame: Frame) -> Outcome:
        return self.described(self._turning(special_points.verify(self, type_, near, frame), near, frame), frame)

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
        found = (self._turning(item, a, frame) for item in special_points.verify_compound(self, a, b, frame))
        return [self.described(item, frame) for item in found]

    def _turning(self, found: Outcome, near: Sample, frame: Frame) -> Outcome:
        """A fold of a user's function only where the curve itself turns: its derivatives may be wrong."""
        if not self._opaque or (isinstance(found, Verified) and found.type != "LP"):
            return found
        if not isinstance(found, Verified):
            return self._corner_beside(near, frame) or found
        here = DenseMarch(self).linearisation(found.z, near.tangent, frame.scale)
        why = no_fold(lambda z: self.linearise(z)[0], here, found.z, frame.scale)
        return found if why is None else Rejected(f"no LP: {why}")

    def described(self, found: Outcome, frame: Frame) -> Outcome:
        """What was found with its normal form; nothing where it lies where the branch ends."""
        if not isinstance(found, Verified):
            return found
        if any(f.singular and f.heights(found.z[None], frame.scale)[0] <= ON_FLOOR for f in self.floors):
            return NOTHING  # it is none of this branch, which ends there
        return with_normal_form(self, found, frame.scale)

    def _corner_beside(self, near: Sample, frame: Frame) -> Rejected | None:
        """What a corner of a user's function does at a sample; None where there is none."""
        if not self._opaque or self.system.n_switches:
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
        columns: dict[str, Array] = {self.parameters[0]: z[:, -1].copy()}
        return columns | state_columns(self.system, z[:, : self.n], lambda: self.rows_of_parameters(z))

    def remarks(self, z: Array, eigenvalues: NDArray[np.complex128]) -> Sequence[str]:
        """What holds all along the branch (rows z) or a part of it."""
        bounds = float(z[:, -1].min()), float(z[:, -1].max())
        return neutral_remarks(self, z, eigenvalues, lambda: self.initial_scale(z[0], bounds))

    def finite(self, z: Array, values: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Without the eigenvalues of algebraic equations."""
        return finite_eigenvalues(self.system, values)

    @property
    def has_reach(self) -> bool:
        return has_reach(self.system)

    def left_reach(self, z: Array) -> tuple[int, str] | None:
        """The first row at which the model does not hold, and why."""
        return left_reach(self.system, z[:, : self.n], self.rows_of_parameters(z))

    def cross_corner(
        self, last: Sample, frame: Frame, settings: Settings
    ) -> tuple[Sample, Verified | Corner | Jump | None] | None:
        if self._opaque and not self.system.n_switches:
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
        text: str | None = self.system.why_observables_not_finite(z[:-1], self.full_parameters(z))
        return text

    def describe_failure(self, z: Array) -> str:
        near = self.system.trouble_near(z[:-1], self.full_parameters(z))
        if near:
            return f"Beyond, {near}"
        text = self.system.why_not_finite(z[:-1], self.full_parameters(z))
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
