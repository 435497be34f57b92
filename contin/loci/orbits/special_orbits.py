"""What curves of special periodic orbits have in common, by collocation and by shooting."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.outcome import Outcome
from contin.continuation.problem import Renewal
from contin.continuation.sample import Frame, Sample, opposite
from contin.loci.orbits import criticality, events
from contin.loci.orbits.curve_of_orbits import CurveOfSpecialOrbits
from contin.loci.orbits.homoclinic_approach import approached
from contin.problems.orbits.linearised import lost_multipliers
from contin.problems.orbits.linearised.multipliers import nontrivial, without, without_critical
from contin.special.table import tests_of_orbits


@dataclass(frozen=True, eq=False)
class OfSpecialOrbits(CurveOfSpecialOrbits):
    """`curve` is a `CurveOfPeriodicOrbits` of LPC, BPC, PD or NS; that of NS has cos(theta) as a further unknown."""

    def others(self, values: NDArray[np.complex128], z: Array) -> NDArray[np.complex128]:
        """The multipliers without the trivial and the critical ones."""
        left = nontrivial(self.curve.orbits, values)
        if self.locus != "NS":
            return without_critical(left, events.critical(self.locus, 0.0)[0].real)
        return without(left, events.critical(self.locus, self.curve.further(z)))

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        return events.explain(self.locus, a, b)

    def test_of(self, type_: str) -> int | None:
        return events.test_of(self.locus, type_)

    def verify(self, type_: str, near: Sample, frame: Frame) -> Outcome:
        return events.verify(self, type_, near, frame)

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
        changed = opposite(a.tests[2:], b.tests[2:])
        return [self.verify(t, a, frame) for t, c in zip(tests_of_orbits(self.locus), changed, strict=True) if c]

    def connected(self, origin: Sample, before: Sample | None, frame: Frame) -> Renewal | None:
        """The end of the curve where it cannot be told from one of connecting orbits any more."""
        end = None if before is None else approached(self, origin.z, before.z, frame.scale)
        return None if end is None else Renewal(frame.scale, origin, before, None, end)

    def foretold(self, origin: Sample, before: Sample | None, frame: Frame) -> Renewal | None:
        """What this curve was near when its corrector failed: a degenerate period doubling, or homoclinic orbits."""
        if before is None:
            return None
        if self.locus == "LPC" and self.comes_to_half(before.z, origin.z, frame.scale):
            return Renewal(frame.scale, origin, before, None, self.joined(origin.z))
        end = approached(self, origin.z, before.z, frame.scale, failed=True)
        return None if end is None else Renewal(frame.scale, origin, before, None, end)

    def shortcomings(self, z: Array, eigenvalues: NDArray[np.complex128]) -> Sequence[str]:
        def critical(row: Array) -> tuple[complex, ...]:
            return events.critical(self.locus, self.curve.further(row))

        lost = lost_multipliers.remarks(self, self.curve.orbits, z, eigenvalues, critical)
        return (*criticality.remarks(self.curve), *lost)
