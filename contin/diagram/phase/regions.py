"""The regions of a surveyed box: named by the states that were found in them, and checked."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

from contin.abi import Array
from contin.diagram.phase.checks import Check, Plane, alike, checked, equilibria_of, stable_equilibria
from contin.diagram.phase.orbit_checks import orbits_checked
from contin.diagram.phase.phase_data import Region
from contin.diagram.phase.survey import Survey

NOTHING_STABLE: Final = "no stable state was found in the regions"
MISSING: Final = 1e-3  # of the box: less than this in no region is not worth a note


@dataclass(eq=False)
class _Letters:
    """Names of regions: one for each set of states, told by their numbers and by continuing the stable equilibria."""

    plane: Plane
    known: list[tuple[Any, Array, list[Array], str]] = field(default_factory=list)

    def name(self, key: object, point: Array, vectors: list[Array]) -> str:
        """That of a region with the same states, else a new one."""
        for other, at, states, letter in self.known:
            if other == key and len(states) == len(vectors) and alike(self.plane, point, at, vectors, states):
                return letter
        used = len({letter for *_, letter in self.known})
        letter = _letter(used)
        self.known.append((key, point, vectors, letter))
        return letter


def regions_of(survey: Survey) -> tuple[tuple[Region, ...], dict[tuple[int, int], frozenset[str]], Check]:
    """The regions that were visited, the names of the curves between each two of them, and what checks found.

    Notes say which parts of the box are in no region.
    """
    if survey.plane is None:
        return (), {}, Check()
    search = survey.search
    low = np.array([b[0] for b in search.box])
    width = np.array([b[1] - b[0] for b in search.box])
    kind = "map" if search.problem.system.kind == "map" else "flow"
    plane = Plane(search.problem, search.parameters, low, width)
    letters, found = _Letters(plane), Check()
    regions: list[Region] = []
    number: dict[int, int] = {}
    for k, (face, visit) in enumerate(zip(survey.plane.faces, survey.visits, strict=True)):
        where = (low + width * (face.point if visit is None else visit.point)).tolist()
        values = dict(zip(search.parameters, where, strict=True))
        if visit is None:
            place = ", ".join(f"{name} = {value:.6g}" for name, value in values.items())
            search.notes.add(f"{face.area:.2%} of the box, around {place}, was not looked at and is in no region")
            continue
        number[k] = len(regions)
        states = visit.states
        rests = tuple(sorted((state.unstable, state.copies) for state in states if not state.is_orbit))
        cycles = tuple(sorted(state.copies for state in states if state.is_orbit and state.unstable == 0))
        vectors = stable_equilibria(states, visit.rests)
        name = letters.name((rests, cycles, visit.aperiodic), visit.point, vectors)
        label = f"{name}{len(regions) + 1}"
        found += checked(plane, face, visit.point, equilibria_of(states, visit.rests), label)
        if kind == "flow":
            found += orbits_checked(plane, face, visit.point, states, label)
        outline, *holes = (low + width * ring for ring in (face.outline, *face.holes))
        regions.append(Region(name, number[k], values, states, face.area, outline, tuple(holes), visit.aperiodic, kind))
    missing = 1.0 - sum(face.area for face in survey.plane.faces)
    if abs(missing) > MISSING:
        why = "parts too thin for a point, or curves that overlap"
        search.notes.add(f"{missing:.2%} of the box is in no region: {why}")
    search.notes.extend(found.disagreed)
    bare = [r for r in regions if not (r.stable or r.stable_orbits or r.aperiodic)] if search.settle else []
    if bare:
        names = ", ".join(f"{r.name}{r.number + 1}" for r in bare)
        search.notes.add(f"{NOTHING_STABLE} {names}: trajectories escape, or none of those tried came to one")
    owners = [search.loci[k].name for k in survey.owners]
    borders = {
        (number[i], number[j]): frozenset(owners[c] for c in curves)
        for (i, j), curves in survey.plane.borders.items()
        if i in number and j in number
    }
    return tuple(regions), borders, found


def _letter(k: int) -> str:
    """A, B, ..., Z, AA, AB, ..."""
    letter = chr(ord("A") + k % 26)
    return letter if k < 26 else _letter(k // 26 - 1) + letter
