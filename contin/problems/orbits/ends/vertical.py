"""Families whose orbits all exist at one value of the parameter: where a first integral is kept, orbits fill a region.

A family born at a Hopf point of a conservative system (a centre) has the parameter as an unfolding only: it keeps the
value of the Hopf point along the whole family, to rounding (Munoz-Almaraz, Freire, Galan, Doedel and Vanderbauwhede,
Physica D 181 (2003) 1).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.sample import Frame, Sample
from contin.problems.orbits.ends.distances import extent_of
from contin.problems.orbits.march.in_kernel import corrected
from contin.problems.orbits.mesh.layout import Profile, make_scale
from contin.problems.orbits.mesh.move import Move
from contin.problems.scales import parameter_width
from contin.problems.two_parameters import UNBOUNDED
from contin.simulate.natural import natural_metric

if TYPE_CHECKING:
    from contin.problems.orbits.orbit_equations import OrbitEquations

STILL = 1e-10  # dp/ds (scaled) below which the parameter stands still
GROWN = 1e5  # ... and the amplitude up to which orbits are followed then
CONSTANT = 1e-9  # of the range: all that the parameter moves along a vertical family
NOISE = 1e-5  # dp/ds (scaled) of an orbit there, zero but for rounding, at which the family is lost
DRIFTED = (1e-8, 1e-4)  # ... distance from the Hopf point that may be the mesh's error
LARGE = 0.2  # extent of orbits that cannot be so near to their Hopf point otherwise
EXPLAINED = 0.5  # part of that distance which a finer mesh takes away
TOLERANCE = 1e-9  # of Newton's last step there
UNRESOLVED = 1e-6  # a multiplier this close to 1 may be counted on either side: folds are resolved to this only
PAIRED = 1e-6  # products of multipliers this close to 1 are 1
FEWEST = 10  # rows that tell a family


def unbounded(problem: OrbitEquations, origin: Sample, frame: Frame) -> End | None:
    """The end of a family of orbits that grow for ever at one parameter value, or until no mesh resolves them."""
    profile = problem.profile(origin.z)
    hidden = _hidden_by(problem, profile, origin, frame)
    if problem.origin is not None and hidden:
        name, at = problem.parameters[0], problem.origin[0]
        text = (
            f"the orbits of this family all exist at {name} = {at:.10g}; from period {profile.period:.6g} on {hidden} "
            f"hides that ({_range(problem, profile)})"
        )
        return End("bound", text, {"value": at})
    if abs(float(origin.tangent[-1])) > STILL:
        return None
    rest = profile.u[0] if problem.origin is None else problem.origin[1]
    usual = natural_metric(problem.system, rest, problem.full_parameters(origin.z)[: problem.system.m]).states
    extents = np.ptp(profile.u, axis=0) / np.maximum(usual, np.abs(rest))
    largest = int(np.argmax(extents))
    if float(extents[largest]) < GROWN:
        return None
    name, state = problem.parameters[0], problem.system.state_names[largest]
    at = profile.parameter if abs(profile.parameter) > STILL * float(frame.scale[-1]) else 0.0
    text = f"the orbits of this family all exist at {name} = {at:.10g}, and {state} grows without bound"
    return End("bound", text, {"value": at})


def _hidden_by(problem: OrbitEquations, profile: Profile, origin: Sample, frame: Frame) -> str:
    """What keeps a large orbit from being seen at the parameter of the Hopf point, "" where it is, or is not there.

    Rounding, where the parameter still stands there but the tangent says that it moves; the error of the mesh, where it
    has left that value and goes back on a finer mesh.
    """
    if problem.origin is None:
        return ""
    at = problem.origin[0]
    moved, width = abs(profile.parameter - at), float(frame.scale[-1])
    if extent_of(profile, problem.sizes(origin.z, frame.scale)) < LARGE:
        return ""
    if moved <= CONSTANT * width:
        return "rounding" if abs(float(origin.tangent[-1])) > NOISE else ""
    if not DRIFTED[0] * width < moved < DRIFTED[1] * width:
        return ""
    finer = _on_finer_mesh(problem, profile, origin, frame)
    explained = finer is not None and abs(float(finer[-1]) - at) < EXPLAINED * moved
    return "the error of the mesh" if explained else ""


def _on_finer_mesh(problem: OrbitEquations, profile: Profile, origin: Sample, frame: Frame) -> Array | None:
    """The orbit on a mesh of half the lengths: where the plane normal to the family's tangent meets it."""
    h = np.repeat(profile.h / 2.0, 2)
    sizes, period = problem.sizes(origin.z, frame.scale), float(frame.scale[profile.u.size])
    scale = make_scale(h, profile.m, sizes, period, float(frame.scale[-1]))
    moved = Move(problem, frame.scale, scale, h)(origin)
    return corrected(problem, moved, Frame(scale), TOLERANCE)


def stands_at_birth(problem: OrbitEquations, z: Array) -> bool:
    """True where the parameter is still that of the Hopf point."""
    if problem.origin is None:
        return False
    at = float(problem.origin[0])
    return abs(float(z[-1]) - at) <= CONSTANT * problem.width_at_birth


def is_at_birth(problem: OrbitEquations, z: Array, error: float, frame: Frame) -> bool:
    """True for a large orbit whose parameter is that of the Hopf point to its error: a fold there is the mesh's."""
    if problem.origin is None or error > DRIFTED[1] * float(frame.scale[-1]):
        return False
    if abs(float(z[-1]) - problem.origin[0]) > error:
        return False
    return extent_of(problem.profile(z), problem.sizes(z, frame.scale)) > LARGE


def width_at_birth(problem: OrbitEquations) -> float:
    """Of the parameter's own range; its scale, or its value at the Hopf point, where it has none."""
    assert problem.origin is not None
    at = float(problem.origin[0])
    declared = problem.default_range(problem.parameters[0])
    return parameter_width(problem.system.model, problem.parameters[0], at, declared or UNBOUNDED)


def _range(problem: OrbitEquations, profile: Profile) -> str:
    low, high = profile.u.min(axis=0), profile.u.max(axis=0)
    names = problem.system.state_names
    return ", ".join(f"{k} in [{a:.3g}, {b:.3g}]" for k, a, b in zip(names, low, high, strict=True))


def is_vertical(problem: OrbitEquations, z: Array) -> bool:
    """True where all orbits of the family (rows z) exist at one parameter value."""
    values = z[:, -1]
    if len(values) < FEWEST or problem.origin is None or not problem.autonomous:
        return False
    moved, width = np.abs(values - problem.origin[0]), problem.width_at_birth
    return bool(float(np.median(moved)) <= CONSTANT * width and float(moved.max()) <= DRIFTED[1] * width)


def remarks(problem: OrbitEquations, z: Array) -> Sequence[str]:
    """That all orbits of the family (rows z) exist at one parameter value, in words."""
    if not is_vertical(problem, z):
        return ()
    assert problem.origin is not None
    name, at = problem.parameters[0], problem.origin[0]
    return (
        f"vertical family: {name} is constant along it (to {float(np.abs(z[:, -1] - at).max()):.1e}). At {name} = "
        f"{at:.10g} the orbits form a continuum, as where the system has a first integral (an energy); none of them is "
        "isolated",
    )


def recounted(
    problem: OrbitEquations, z: Array, unstable: NDArray[np.int64], eigenvalues: NDArray[np.complex128]
) -> NDArray[np.int64]:
    """Unstable multipliers of the rows of a family, on a vertical one without the second multiplier 1.

    That one belongs to the direction along the family, in which orbits neither approach nor leave: the side of the unit
    circle on which it is computed is rounding.
    """
    if not is_vertical(problem, z):
        return unstable
    counts = unstable.copy()
    for row, values in enumerate(eigenvalues):
        others = values[1:]
        if not stays_critical(values) or int(np.sum(np.abs(others) > 1.0)) != unstable[row]:  # a labelled orbit
            continue
        second = others[int(np.argmin(np.abs(others - 1.0)))]
        counts[row] -= int(second.imag == 0.0 and abs(second) > 1.0)
    return counts


def stays_critical(values: NDArray[np.complex128]) -> bool:
    """True where a second multiplier is 1 up to what the trivial one, the first, is off."""
    return distance_from_one(values) < UNRESOLVED + 3.0 * abs(complex(values[0]) - 1.0)


def distance_from_one(values: NDArray[np.complex128]) -> float:
    """Of the nontrivial multiplier nearest to 1 (the trivial one stands first; without it nothing is gained)."""
    others = values[1:]
    return float(np.min(np.abs(others - 1.0))) if others.size and np.all(np.isfinite(others)) else np.inf


def is_reciprocal(values: NDArray[np.complex128]) -> bool:
    """True for multipliers that come in pairs (m, 1/m), as in Hamiltonian systems: a pair leaves the unit circle only
    through 1, -1 or another pair, so the sign of |m| - 1 on it is rounding."""
    left = list(values)
    while len(left) > 1:
        value = left.pop()
        partner = int(np.argmin([abs(value * w - 1.0) for w in left]))
        if not abs(value * left.pop(partner) - 1.0) <= PAIRED:  # NaN, too
            return False
    return not left
