"""What the search for special points asks of a branch or a curve of connecting orbits."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from functools import cached_property

from contin.abi import Array
from contin.continuation.sample import Frame, Sample
from contin.homoclinic.equations import ConnectionCurve
from contin.homoclinic.separation import mixed
from contin.problems.orbits.marched_in_python import MarchedInPython
from contin.problems.orbits.mesh.layout import Profile, trimmed


@dataclass(frozen=True, eq=False)
class CurveOfConnections(MarchedInPython):
    """See `contin.homoclinic.equations` for the unknowns and equations."""

    curve: ConnectionCurve
    maximum_chunk = 5  # a step takes some 20 ms

    @property
    def isolated(self) -> bool:
        """True where connections persist at fixed parameters: one parameter varies along a branch of them."""
        return len(self.curve.slots) == 1

    @property
    def kind(self) -> str:  # type: ignore[override]
        return "connection" if self.isolated else "locus"

    @property
    def locus(self) -> str | None:  # type: ignore[override]
        return None if self.isolated else str(self.curve.type)

    @cached_property
    def parameters(self) -> tuple[str, ...]:
        names = self.system.parameter_names
        both = names[self.curve.first], names[self.curve.second]
        return both[:1] if self.isolated else both

    def profile(self, z: Array) -> Profile:
        """The whole orbit of a point."""
        return self.curve.orbit_of(z)

    def orbit_at(self, z: Array) -> Profile:
        return self.profile(z)

    @property
    def has_reach(self) -> bool:
        return True

    def left_reach(self, z: Array) -> tuple[int, str] | None:
        """Where the orbit leaves the equations' domain, or its directions are no longer told from others."""
        left = super().left_reach(z) if super().has_reach else None
        z = z if left is None else z[: left[0]]
        texts = ((k, mixed(self.curve, trimmed(row))) for k, row in enumerate(z))
        return next(((k, text) for k, text in texts if text is not None), left)

    def at_held(self, z: Array, scale: Array) -> Array | None:
        """Solved with the second parameter as it is; where that is no unknown, the first one."""
        slot = -1 if self.isolated else -2
        return self.at_unknown(slot, z, float(z[slot]), scale)

    @abstractmethod
    def discretisation(self, found: Sample, frame: Frame, index: int) -> float | None:
        """How far a mesh of half the lengths moves the zero of test `index`; None where there is none."""
