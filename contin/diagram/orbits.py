"""Families of periodic orbits in a diagram: which are known already, and which are mirror images of others."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Branch, Parent, SpecialPoint
from contin.diagram.images import image
from contin.diagram.sizes import sizes_among
from contin.diagram.wiggles import beside_homoclinic
from contin.problems.symmetry import apply_symmetry, every_symmetry
from contin.transitions.registry import Explored

if TYPE_CHECKING:
    from contin.continuation.branch import Parent
    from contin.problems.equilibria.equilibrium import EquilibriumProblem
    from contin.problems.orbits.mesh.layout import Profile

CASCADE = 2  # period doublings, or gluings, after which a cascade is left to the user
LENGTHENING = ("PD", "HOM")  # where orbits of twice the period, or of twice the loops, are born
TWICE = 3  # of both together: their cascades alternate without end (Shimizu and Morioka's equations)
SAME_PARAMETER = 1e-6  # relative to the range
SAME_PERIOD = 1e-4  # relative
SAME_ORBIT = 1e-2  # distance between two orbits as sets, relative to their extent: period and parameter agree already
SHRUNK = 1e-4  # of the states' sizes: the extent of an orbit that is next to a point
SAMPLES = 200


def generation(born_at: Sequence[str], families: Sequence[str] = ("PD", "BPC")) -> int:
    """How often, on the way to a branch, a family of orbits was born on another one (`Branch.born_at`)."""
    return sum(type_ in families for type_ in born_at)


def left_to_the_user(branch: Branch, point: SpecialPoint, rule: Explored) -> str:
    """Why the families born at a point of a family of orbits are not followed; empty where they are.

    There are infinitely many in cascades of period doublings and of gluings at homoclinic orbits, and beside a
    homoclinic orbit to a saddle-focus.
    """
    if branch.kind != "orbit":
        return ""
    if rule.cascade and branch.born_at.count(point.type) >= CASCADE:
        return f"orbits of {2**CASCADE} times the period are the last that are followed"
    if point.type in LENGTHENING:
        born = [type_ for type_ in branch.born_at if type_ in LENGTHENING]
        if born.count(point.type) >= CASCADE or len(born) >= TWICE:
            return (
                f"families of twice as many loops, at {point.type}, are not followed: these came after {len(born)} such"
            )
    if rule.crowded and beside_homoclinic(branch, point):
        return "families of long orbits beside a homoclinic orbit to a saddle-focus are not followed"
    return ""


def known_family(branches: Iterable[Branch], seed: Any, width: float) -> Branch | None:
    """The branch that already is the family of this seed, or its image.

    A family is told by its special orbits: two families that have one in common, where only two cross, are one. So the
    seed is compared with the ends of every family and with its branch points, but not with the branch it was born at.
    """
    problem, parent = seed.problem, seed.parent
    here, sizes = list(_variants(problem, seed.z)), _sizes(problem, seed.z)
    own_birth = None if parent is None else _birth(parent)
    for branch in branches:
        if branch.kind != "orbit" or branch.image_of is not None or branch.parameters != tuple(problem.parameters):
            continue
        own = parent is not None and parent.branch == branch.name
        rows = {p.index for p in branch.points if p.type == "BPC"} if not own else set()
        sibling = own_birth is not None and branch.parent is not None and own_birth == _birth(branch.parent)
        beside = parent is not None and branch.parent is not None and _are_two_hopf_points(parent, branch.parent)
        if branch.parent is not None and not sibling and not beside:  # several families may be born at one point
            rows.add(branch.start_row)
        ends = zip((0, len(branch) - 1), branch.ends, strict=True)
        rows |= {k for k, end in ends if end.reason in ("hopf", "joined")}
        for row in sorted(rows):
            z = branch.z[row]
            if abs(z[-1] - seed.z[-1]) > SAME_PARAMETER * width:
                continue
            other = branch.problem.profile(z)
            if any(_same(other, one, sizes) for one in here):
                return branch
    return None


def _are_two_hopf_points(a: Parent, b: Parent) -> bool:
    """Two labels of one branch are two points, however near, and what is born at each is another family."""
    return a.branch == b.branch and a.label != b.label and a.type == b.type == "HB"


def family_through(branches: Iterable[Branch], seed: Any, bounds: tuple[float, float]) -> Branch | None:
    """The family that passes through the orbit of this seed, or through an image of it.

    Each family is solved at the seed's parameter, wherever its rows pass that.
    """
    problem = seed.problem
    here, sizes = list(_variants(problem, seed.z)), _sizes(problem, seed.z)
    for branch in branches:
        if branch.kind != "orbit" or branch.image_of is not None or branch.parameters != tuple(problem.parameters):
            continue
        away = branch.z[:, -1] - seed.z[-1]
        rows = np.flatnonzero(np.abs(away) <= SAME_PARAMETER * (bounds[1] - bounds[0]))
        across = np.flatnonzero(away[:-1] * away[1:] < 0.0)
        for row in dict.fromkeys([*rows.tolist(), *across.tolist(), *(across + 1).tolist()]):
            z = branch.z[row][~np.isnan(branch.z[row])]
            solved = branch.problem.at_parameter(z, float(seed.z[-1]), branch.problem.initial_scale(z, bounds))
            if solved is not None and any(_same(branch.problem.profile(solved), one, sizes) for one in here):
                return branch
    return None


def known_orbit(problem: Any, z: Array, known: Iterable[tuple[Any, Array]]) -> tuple[Any, Array] | None:
    """The one of the `known` orbits, at the same parameters, that z is, or is an image of."""
    here, sizes = list(_variants(problem, z)), _sizes(problem, z)
    for other, row in known:
        profile = other.profile(row)
        if any(_same(profile, one, sizes) for one in here):
            return other, row
    return None


def copies(problem: EquilibriumProblem, z: Array) -> int:
    """How many different orbits the declared symmetries make of one."""
    distinct: list[Profile] = []
    sizes = _sizes(problem, z)
    for profile in _variants(problem, z):
        if not any(_same(profile, one, sizes) for one in distinct):
            distinct.append(profile)
    return len(distinct)


def _birth(parent: Parent) -> tuple[str, str]:
    return parent.branch, parent.label


def _variants(problem: Any, z: Array) -> Iterator[Profile]:
    yield problem.profile(z)
    if hasattr(problem, "moved"):
        for name in every_symmetry(problem):
            yield problem.profile(apply_symmetry(problem, name, z)[0])


def _sizes(problem: Any, z: Array) -> Array:
    """Of the states (n,) along an orbit."""
    return sizes_among(problem, [problem.profile(z).u], float(z[-1]))


def _same(a: Profile, b: Profile, sizes: Array) -> bool:
    """One period and, as sets, one orbit; sizes (n,) of the states, in which distances are measured."""
    if abs(a.period - b.period) > SAME_PERIOD * b.period:
        return False
    u, v = _points(a, sizes), _points(b, sizes)
    size = max(float(np.ptp(u, axis=0).max()), float(np.ptp(v, axis=0).max()), SHRUNK)
    apart = np.linalg.norm(u[:, None, :] - v[None, :, :], axis=2)
    grain = 2.0 * float(np.linalg.norm(np.diff(v, axis=0), axis=1).max())
    return bool(max(apart.min(axis=0).max(), apart.min(axis=1).max()) <= grain + SAME_ORBIT * size)


def _points(profile: Profile, sizes: Array) -> Array:
    """Points of the orbit, in its sizes, at even distances: at even times a pulse may lie between two."""
    u = profile.u / sizes
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(u, axis=0), axis=1))])
    times = np.interp(np.linspace(0.0, along[-1], SAMPLES), along, profile.times)
    return np.asarray(profile.at(times) / sizes)


def mirrored_families(branch: Branch, branches: Iterable[Branch]) -> list[Branch]:
    """Images of a family under the symmetries that move the branch it was born on: those are born on the images."""
    if branch.parent is None or not hasattr(branch.problem, "moved"):
        return []
    found: list[Branch] = []
    for mirror in list(branches):
        if mirror.image_of is None or mirror.image_of.branch != branch.parent.branch:
            continue
        name = mirror.image_of.symmetry
        middle = branch.z[len(branch) // 2]
        orbit = branch.problem.profile(middle)
        moved = branch.problem.profile(apply_symmetry(branch.problem, name, middle)[0])
        known = any(b.image_of and b.name == f"{branch.name}~{name}" for b in branches)
        if not known and not _same(orbit, moved, _sizes(branch.problem, middle)):
            found.append(image(branch, name))
    return found
