"""Families of periodic orbits of a flow with events, in one parameter, with a fixed cycle of events.

Unknowns are the state u after the last event of the cycle, and the parameter: u is a fixed point of the map that takes
it to the state after the next such event (`passage`), so there is no phase to fix. Special points and normal forms are
those of the map; the family ends where the cycle of events changes (`grazing`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation import march as generic
from contin.continuation.location.halting import HALF_PERIOD
from contin.continuation.outcome import Outcome, Rejected, Verified
from contin.continuation.problem import Renewal
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.settings import Settings
from contin.normalforms.result import sense
from contin.problems.at_fixed_parameter import at_parameter
from contin.problems.dense_march import DenseLinearisation, dense_linearisation
from contin.problems.equilibria import special_points
from contin.problems.hybrid.closing import is_shut, shut
from contin.problems.hybrid.cycle_of_events import CycleOfEvents
from contin.problems.hybrid.grazing import cut_where_events_change, ending, unexpected
from contin.problems.hybrid.multipliers import stability
from contin.problems.hybrid.sampling import HybridProfile, norm, orbit_columns, sampled
from contin.problems.orbits.measured.measures import standard_columns, standard_names
from contin.problems.scales import parameter_width
from contin.problems.tolerances import ONE_PASSAGE
from contin.records import Fields
from contin.special.table import test_on_branch

if TYPE_CHECKING:
    from contin.continuation.problem import Problem
    from contin.problems.contracts import Probing

OF_ORBITS: Final = {"LP": "LPC", "BP": "BPC"}  # special points of fixed points, and what they are of orbits
OF_MAPS: Final = {orbit: of_map for of_map, orbit in OF_ORBITS.items()}
OPPOSITE: Final = 1e-3  # of the largest part of a tangent: what is left where two halves of an orbit move oppositely
STEEP: Final = 1e5  # multiplier
COEFFICIENTS: Final = ("a", "b", "c", "d")  # of the map's normal forms; those of orbits have other units


@dataclass(frozen=True, eq=False)
class HybridOrbits(CycleOfEvents):
    """Fixed points (`inner`) of the map of a cycle of events, as periodic orbits."""

    def doubled(self) -> HybridOrbits:
        """Orbits with the cycle of events twice."""
        twice = replace(self.map, arcs=2 * self.map.arcs, winding=2.0 * self.map.winding)
        return HybridOrbits(replace(self.inner, system=twice))

    def halved(self) -> HybridOrbits:
        """Orbits with the first half of the cycle of events."""
        arcs = self.map.arcs
        half = replace(self.map, arcs=arcs[: len(arcs) // 2], winding=0.5 * self.map.winding)
        return HybridOrbits(replace(self.inner, system=half))

    def unexpected(self, z: Array) -> tuple[int, int] | None:
        """(event, arc) of the first event on the orbit that its cycle does not have."""
        return unexpected(self, z)

    def is_shut(self, z: Array) -> bool:
        """See `contin.problems.hybrid.closing`."""
        return is_shut(self, z)

    def shut(self, z: Array) -> Array:
        """See `contin.problems.hybrid.closing`."""
        return shut(self, z)

    def profile(self, z: Array) -> HybridProfile:
        """The orbit over one period."""
        return sampled(self, z)

    def multipliers(self, z: Array) -> NDArray[np.complex128]:
        """Multipliers of the orbit, of an autonomous system the trivial one first."""
        return stability(self, z)[2]

    # the engine's contract --------------------------------------------------------------------------------------------

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        width = parameter_width(self.flow.given, self.parameters[0], float(z[-1]), bounds)
        return np.append(np.sqrt(self.n) * self.map.sizes[self.map.kept], width)

    def tangents(self, z: Array, scale: Array) -> Sequence[Array]:
        return self.inner.tangents(z, scale)

    def linearisation(self, z: Array, tangent: Array, scale: Array) -> DenseLinearisation | None:
        """Of the map's fixed points, as `contin.continuation.march` takes it."""
        return dense_linearisation(*self.inner.linearise(z), tangent, scale)

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        """Tests, count and multipliers."""
        return stability(self, z)

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        chunk = generic.march(self, origin, before, length, frame, step, limit, bounds, settings, loop)
        return cut_where_events_change(self, chunk, frame, settings)

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        return generic.probe(self, base, length, guess, frame, settings)

    def placed(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Array | None:
        """The orbit of `probe`, without its tests."""
        found = generic.place(self, base, length, guess, frame, settings)
        return None if found is None else found.z

    def refined(self, sample: Sample, frame: Frame) -> tuple[Problem, Sample, Frame] | None:
        """On more accurate trajectories."""
        finer = HybridOrbits(replace(self.inner, system=self.map.finer()))
        found = solved_twice(finer, sample, frame)
        return None if found is None else (finer, found, frame)

    def at_parameter(self, guess: Array, value: float, scale: Array) -> Array | None:
        return at_parameter(self.inner, guess, value, scale)

    def foretold(self, origin: Sample, before: Sample | None, frame: Frame) -> Renewal | None:
        end = ending(self, origin, before)
        return None if end is None else Renewal(frame.scale, origin, before, None, end)

    # special points ---------------------------------------------------------------------------------------------------

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        found = special_points.explain(True, a, b)
        return None if found is None else tuple(OF_ORBITS.get(type_, type_) for type_ in found)

    def test_of(self, type_: str) -> int | None:
        return test_on_branch(type_)

    def verify(self, type_: str, near: Sample, frame: Frame) -> Outcome:
        try:
            found = self.inner.verify(OF_MAPS.get(type_, type_), self._of_map(near), frame)
            return self._of_orbit(found, near, frame)
        except np.linalg.LinAlgError:  # a point beside which an event of the cycle does not come
            return Rejected("the events beside this point are others")

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
        found = self.inner.verify_compound(self._of_map(a), self._of_map(b), frame)
        return [self._of_orbit(item, a, frame) for item in found]

    def _of_map(self, sample: Sample) -> Sample:
        """Without the trivial multiplier."""
        return sample if self.flow.forced else replace(sample, eigenvalues=sample.eigenvalues[1:])

    def _of_orbit(self, found: Outcome, near: Sample, frame: Frame) -> Outcome:
        if not isinstance(found, Verified):
            return found
        again = replace(self.inner, system=self.map.rougher())
        found = judged(found, again.verify(found.type, replace(self._of_map(near), z=found.z), frame))
        form, errors = found.normal_form, found.normal_form.get("errors", {})
        decides = {"PD": ("c", -1.0), "NS": ("d", 1.0)}.get(found.type)
        if decides is not None and isinstance(form.get(decides[0]), float):
            form = {**form, "criticality": sense(decides[1] * form[decides[0]], errors.get(decides[0], 0.0))}
        type_ = OF_ORBITS.get(found.type, found.type)
        return replace(found, type=type_, eigenvalues=self.multipliers(found.z), normal_form=renamed(dict(form)))

    def reverses(self, z: Array, tangent: Array, scale: Array, symmetries: Sequence[str]) -> bool:
        return HALF_PERIOD in symmetries and self._halves(z, tangent)

    def _halves(self, z: Array, tangent: Array) -> bool:
        """True where the second half of the orbit repeats the first, and `tangent` (raw) drives them apart."""
        arcs = self.map.arcs
        events = [(arc.event, arc.then) for arc in arcs]  # their lengths are of the orbit that the family began with
        if len(arcs) % 2 or events[: len(arcs) // 2] != events[len(arcs) // 2 :]:
            return False
        value, matrix = self.halved().map.jacobian(z[:-1], self.inner.full_parameters(z))
        sizes = self.map.sizes[self.map.kept]
        if not float(np.max(np.abs(value - z[:-1]) / sizes)) <= ONE_PASSAGE:
            return False
        moved = (matrix[:, : self.n] @ tangent[:-1] + tangent[:-1]) / sizes
        return float(np.abs(moved).max()) <= OPPOSITE * float(np.abs(tangent[:-1] / sizes).max())

    # words and columns ------------------------------------------------------------------------------------------------

    def column_names(self) -> tuple[str, ...]:
        """Names that `columns` gives, for user values."""
        names = (*self.system.state_names, *self.system.observable_names)
        extremes = (f"{f}.{e}" for f in names for e in ("min", "max"))
        return (self.parameters[0], "period", *extremes, *standard_names(self.system))

    def columns(self, z: Array) -> dict[str, Array]:
        """Parameter, period, extremes of every state and observable over the orbit, and the standard columns."""
        columns = {self.parameters[0]: z[:, -1].copy()} | orbit_columns(self.system, [(self, row) for row in z])
        return columns | standard_columns(self.system, columns, lambda: np.array([norm(self, row) for row in z]))

    def describe_failure(self, z: Array) -> str:
        why = self.map.why_not_finite(z[:-1], self.inner.full_parameters(z))
        if why:
            return f"Beyond, {why}."
        largest = float(np.nanmax(np.abs(self.multipliers(z)), initial=0.0))
        if largest > STEEP:
            return (
                f"A multiplier of {largest:.1e}: the map from jump to jump is so steep there that its trajectories do "
                "not resolve it (a canard, or a burst that gains or loses a spike)."
            )
        return self.inner.describe_failure(z)


def solved_twice(problem: Probing, sample: Sample, frame: Frame) -> Sample | None:
    """A point next to the sample, solved for again from where Newton's tolerance left it."""
    found = problem.probe(sample, 0.0, sample.z.copy(), frame, Settings())
    return None if found is None else problem.probe(found, 0.0, found.z.copy(), frame, Settings())


def judged(found: Verified, again: Outcome) -> Verified:
    """A point of the map with errors that cover how far it depends on differences and on the trajectories' accuracy.

    again : the same point of the `rougher` map.
    """
    if not isinstance(again, Verified):
        why = f"{found.type}: its error leaves out that of the trajectories (it is not found with less accurate ones)"
        return replace(found, remark="; ".join(filter(None, (found.remark, why))))
    form, errors = dict(found.normal_form), dict(found.normal_form.get("errors", {}))
    for key, value in form.items():
        other = again.normal_form.get(key)
        if isinstance(value, float) and isinstance(other, float):
            errors[key] = float(errors.get(key, 0.0)) + 2.0 * abs(value - other)
    if errors:
        form["errors"] = errors
    moved, vectors = np.abs(found.z - again.z), dict(found.vectors)
    if "second" in vectors:  # of a point in two parameters
        vectors["second"] = float(vectors["second"]) + float(moved[-2])
    return replace(found, error=found.error + float(moved[-1]), normal_form=form, vectors=vectors)


def renamed(form: Fields) -> Fields:
    """A normal form with coefficients that say that they are the map's."""

    def of_map(entries: Mapping[str, object]) -> Fields:
        return {f"{k}_map" if k in COEFFICIENTS else k: v for k, v in entries.items()}

    return of_map(form) | ({"errors": of_map(form["errors"])} if "errors" in form else {})
