"""The orbits that start at a homoclinic orbit of a symmetric system: a loop joined with its mirror image.

Where a symmetry keeps the saddle but not the loop, the loop and its image are both homoclinic there, and orbits that
follow one and then the other exist too (gluing bifurcation). One of them, with a long period, starts their family.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.sample import Frame
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.march.in_kernel import probe
from contin.problems.orbits.mesh.layout import Profile, make_scale
from contin.problems.orbits.symmetric.symmetry import states_moved
from contin.problems.symmetry import symmetry_names
from contin.transitions.orbits_at_point import along_own_parameter
from contin.transitions.registry import Explored, born

AT_SADDLE = 1e-2  # distance of the orbit's slowest point from its image (relative to the extent) where they are joined
DISTINCT = 0.1  # ... and of the loop from its image
ROUGH, EXACT = 1e-4, 1e-9  # (scaled) of the joined orbit: a first step closes the gap, then Newton starts anew
LONGEST_MOVE = 0.3  # (scaled) from the joined loops to the orbit

GLUED: Final = Explored(generation=True, uncertain=True)


@born(OrbitProblem, "HOM", "the orbits that follow both loops", explored=GLUED)
def glued(problem: OrbitProblem, point: SpecialPoint, parameter: str) -> list[Seed]:
    """Seed of the family of joined orbits, which begins with a long period and runs to shorter ones.

    Raises InputError where no symmetry keeps the saddle and moves the loop, or where no orbit is found.
    """
    along_own_parameter(problem, point, parameter)
    profile = _from_the_saddle(problem.profile(point.z))
    p = problem.full_parameters(point.z)
    extent = float(np.ptp(profile.u, axis=0).max())
    for name in symmetry_names(problem) if not problem.winding.any() else ():
        image = states_moved(problem, name, profile.u, p)
        gap = float(np.abs(image[0] - profile.u[0]).max())
        if gap > AT_SADDLE * extent or float(np.abs(image - profile.u).max()) < DISTINCT * extent:
            continue
        sizes = problem.sizes(point.z, point.scale)
        for metric in (sizes, np.full(sizes.size, sizes.max())):  # in small states the gap may be too wide for Newton
            seed = _joined(problem, point, profile, image, metric)
            if seed is not None:
                return [seed]
    raise InputError(
        f"{point.branch}.{point.label}: no other family starts here: no declared symmetry keeps the saddle and moves "
        "the loop"
    )


def _from_the_saddle(profile: Profile) -> Profile:
    """The same orbit, with the mesh point at which it is slowest in front."""
    steps = np.linalg.norm(np.diff(profile.u, axis=0), axis=1) / np.diff(profile.times)
    m = profile.m
    slowest = [max(steps[i * m - 1], steps[i * m]) for i in range(profile.intervals)]
    first = int(np.argmin(slowest))
    u = np.concatenate([profile.u[first * m : -1], profile.u[: first * m + 1]])
    return replace(profile, u=u, h=np.roll(profile.h, -first))


def _joined(problem: OrbitProblem, point: SpecialPoint, loop: Profile, image: Array, sizes: Array) -> Seed | None:
    """The orbit of twice the period near loop and image, by Newton at this period, in a metric of these sizes."""
    h = np.tile(loop.h / 2.0, 2)
    both = Profile(loop.m, np.concatenate([loop.u, image[1:]]), 2.0 * loop.period, h, loop.parameter)
    both.u[-1] = both.u[0]
    nodes = both.u.size
    scale = make_scale(h, loop.m, sizes, 2.0 * float(point.scale[loop.u.size]), float(point.scale[-1]))
    family = replace(problem, multiple=1)
    guess = both.vector()
    fixed = np.zeros(scale.size)
    fixed[nodes] = 1.0
    found = probe(family, guess, fixed, 0.0, guess, Frame(scale), ROUGH)
    found = found and probe(family, found.z, fixed, 0.0, found.z, Frame(scale), EXACT)
    if found is None or float(np.linalg.norm((found.z - guess) / scale)) > LONGEST_MOVE:
        return None
    direction = np.asarray(found.tangent if found.tangent[nodes] < 0.0 else -found.tangent)
    return Seed(
        family, found.z, direction, None, scale, (1,), Parent.of(point),
        measured=(found.unstable, found.eigenvalues),
    )  # fmt: skip
