"""A curve of special points of equilibria through a given one, as a seed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from contin.abi import Array
from contin.continuation.branch import Parent
from contin.continuation.seed import Seed
from contin.loci.equilibria.curves import curve_of
from contin.loci.equilibria.equilibrium_locus import LocusProblem
from contin.problems.two_parameters import indices

if TYPE_CHECKING:
    from contin.systems.protocol import System


def seed_of(
    system: System, type_: str, parameters: Sequence[str], u: Array, p: Array, sizes: Array, periods: Array,
    scalar: float, parent: Parent | None,
) -> Seed:  # fmt: skip
    """The curve of points of a type through (u, p); scalar: kappa of HB, cos theta of NS."""
    first, second = indices(system, parameters)
    curve = curve_of(type_, system, p, first, second, sizes)
    return Seed(LocusProblem(curve, periods), curve.place(u, p, scalar), parent=parent)
