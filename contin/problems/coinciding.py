"""Events of equilibria at one place that are one label."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from contin.abi import Array
from contin.continuation.outcome import Outcome, Verified
from contin.linalg.vectors import norm

SEVERAL_PAIRS: Final = (
    "HB: several pairs of eigenvalues cross at once, for which there is no normal form here; families of cycles born "
    "there are told apart by declared symmetries alone, and without these one is followed"
)
SEVERAL_MULTIPLIERS: Final = {
    "NS": "NS: several pairs of multipliers cross at once, for which there is no normal form here",
    "PD": "PD: several multipliers pass -1 at once, for which there is no normal form here; the doubled cycles are "
    "those through the branch point of the map applied twice",
}
OF_ORBITS: Final = {
    "NS": "NS: {count} pairs of multipliers cross at once, for which there is no normal form here",
    "PD": "PD: {count} multipliers pass -1 at once, for which there is no normal form here",
    "BPC": "BPC: {count} multipliers pass 1 at once: the families that cross there were not told apart",
}
SAME: Final = 1e-6  # distance in the metric within which two events are at one place


def with_hopf_points_told(found: Sequence[Outcome], scale: Array) -> list[Outcome]:
    """A fold or branch point with a Hopf point on it is one label, also ZH: the form of the latter has a pole there."""
    real = next((p for p in found if isinstance(p, Verified) and p.type in ("LP", "BP")), None)
    if real is None:
        return list(found)
    on_it = [
        isinstance(f, Verified) and f.type == "HB" and norm((f.z - real.z) / scale) < SAME for f in found
    ]  # fmt: skip
    told = replace(real, also=("ZH",) * sum(on_it))
    return [told if item is real else item for item, merged in zip(found, on_it, strict=True) if not merged]
