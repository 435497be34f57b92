"""A curve of special orbits, as what looks for points of codimension two takes it."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.outcome import Verified
from contin.continuation.sample import Frame, Sample
from contin.problems.orbits.hopf_end import SMALL
from contin.problems.orbits.two_parameters import OfPeriodicOrbits

HALVES = 100
OPPOSITE: Final = 0.9  # cosine of the ways from one half to the other of neighbouring orbits that have changed places
ROUNDING: Final = 1e-8  # of a state: how far apart halves that are equal are computed
ANGLES: Final = {  # of critical multipliers, of types with one of them
    "CPC": 0.0, "R1": 0.0, "GPD": np.pi, "R2": np.pi, "R3": 2.0 * np.pi / 3.0, "R4": 0.5 * np.pi,
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class CurveOfSpecialOrbits(OfPeriodicOrbits):
    """`curve` is a `CurveOfPeriodicOrbits` of LPC, BPC, PD or NS; that of NS has cos(theta) as a further unknown."""

    halved: ClassVar[tuple[str, ...]] = ("NS",)  # loci whose rows are asked whether the halves have changed places

    def has_met_half(self, z: Array, scale: Array) -> bool:
        """True where the orbit is one of half its period, but for a difference that does not matter."""
        return not self.curve.orbits.multiple % 2 and float(np.max(np.abs(self._halves_apart(z, scale)))) < SMALL

    def passes_half(self, before: Array, here: Array, scale: Array) -> bool:
        """True where the curve has passed orbits of half the period between two rows: the halves change places."""
        if self.curve.orbits.multiple % 2:
            return False
        return float(np.sum(self._halves_apart(before, scale) * self._halves_apart(here, scale))) < 0.0

    def comes_to_half(self, before: Array, here: Array, scale: Array) -> bool:
        """True where the orbit is one of half its period but for a difference that grows less from row to row."""
        if not self.has_met_half(here, scale):
            return False
        left, was = self._halves_apart(here, scale), self._halves_apart(before, scale)
        along = float(np.sum(left * was))
        alike = along > OPPOSITE * float(np.linalg.norm(left) * np.linalg.norm(was))
        return alike and float(np.sum(left * left)) < along

    def joined(self, z: Array) -> End:
        """The end of folds of doubled orbits at z, where the two halves become one."""
        text = "came together with orbits of half the period, at their degenerate period doubling near "
        return End("joined", text + self.place(z))

    def past_half(self, z: Array) -> int | None:
        """Where the halves of a doubled orbit have changed places from row to row: past R2 on one of NS, GPD of LPC.

        States are compared in the sizes of their differences, whatever the metric of a chunk; without those whose
        halves differ by rounding.
        """
        if self.locus not in self.halved or self.curve.orbits.multiple % 2 or len(z) < 2:
            return None
        apart = np.array([self._halves_in_units(row) for row in z])
        largest = np.abs(apart).max(axis=(0, 1))
        sizes = np.max([np.abs(self.curve.profile(row).u).max(axis=0) for row in z[[0, -1]]], axis=0)
        largest = np.where(largest > ROUNDING * sizes, largest, np.inf)
        apart = (apart / largest).reshape(len(z), -1)
        lengths = np.linalg.norm(apart, axis=1)
        turned = np.flatnonzero(np.sum(apart[1:] * apart[:-1], axis=1) < -OPPOSITE * lengths[1:] * lengths[:-1])
        return int(turned[0]) + 1 if len(turned) else None

    def _halves_apart(self, z: Array, scale: Array) -> Array:
        """u(x + 1/2) - u(x), relative to the states' sizes and ranges, at `HALVES` times in half a period."""
        sizes = self.curve.orbits.sizes(self.curve.orbit(z), self.curve.orbit(scale))
        return np.asarray(self._halves_in_units(z) / np.maximum(sizes, np.ptp(self.curve.profile(z).u, axis=0)))

    def _halves_in_units(self, z: Array) -> Array:
        u, times = self.curve.profile(z), np.linspace(0.0, 0.5, HALVES)
        return np.asarray(u.at(times + 0.5) - u.at(times) - 0.5 * self.curve.orbits.winding)

    @abstractmethod
    def on_finer_mesh(self, sample: Sample, frame: Frame) -> tuple[Any, Sample, Frame] | None:
        """This curve with half the mesh's lengths, the sample as it is there and the metric; None without a mesh."""

    def with_coefficients(self, point: Verified, frame: Frame, finer: Any, there: Sample, metric: Frame) -> Verified:
        """The point with the coefficients of its normal form, where they are computed.

        finer, there, metric : as of `on_finer_mesh`, the sample located anew.
        """
        return point

    @abstractmethod
    def error_of_equations(self, z: Array, scale: Array) -> float:
        """What approximate equations (averages by quadrature) leave of the first parameter; 0 of exact ones."""

    def same_point(self, a: Verified, b: Verified, scale: Array) -> bool:
        near = np.abs(a.z[[-1, -2]] - b.z[[-1, -2]]) <= 1e-7 * scale[[-1, -2]]
        return bool(near.all()) and self.curve.orbits.is_one(self.curve.profile(a.z), self.curve.profile(b.z))

    def columns(self, z: Array) -> dict[str, Array]:
        return super().columns(z) | self.angle_columns(z)

    def angle_columns(self, z: Array) -> dict[str, Array]:
        """Of tori: cos(theta), and where the pair is real."""
        if self.locus != "NS":
            return {}
        cosine = z[:, -3].copy()
        return {"cos.theta": cosine, "neutral": np.asarray(np.abs(cosine) > 1.0)}

    @abstractmethod
    def others(self, values: NDArray[np.complex128], z: Array) -> NDArray[np.complex128]:
        """The multipliers without the trivial and the critical ones."""
