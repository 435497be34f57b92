"""The regions of a surveyed box: named by the states that were found in them."""

from __future__ import annotations

from typing import Any

import numpy as np

from contin.diagram.phase.diagram import Region
from contin.diagram.phase.survey import Survey


def regions_of(survey: Survey) -> tuple[tuple[Region, ...], dict[tuple[int, int], frozenset[str]]]:
    """The regions that were visited, and the names of the curves between each two of them."""
    if survey.plane is None:
        return (), {}
    search = survey.search
    low = np.array([b[0] for b in search.box])
    width = np.array([b[1] - b[0] for b in search.box])
    kind = "map" if search.problem.system.kind == "map" else "flow"
    names: dict[Any, str] = {}
    regions: list[Region] = []
    number: dict[int, int] = {}
    for k, (face, visit) in enumerate(zip(survey.plane.faces, survey.visits, strict=True)):
        if visit is None:
            continue
        number[k] = len(regions)
        states = visit.states
        rests = tuple(sorted((state.unstable, state.copies) for state in states if not state.is_orbit))
        cycles = tuple(sorted(state.copies for state in states if state.is_orbit and state.unstable == 0))
        name = names.setdefault((rests, cycles, visit.aperiodic), _letter(len(names)))
        values = dict(zip(search.parameters, (low + width * visit.point).tolist(), strict=True))
        outline, *holes = (low + width * ring for ring in (face.outline, *face.holes))
        regions.append(Region(name, number[k], values, states, face.area, outline, tuple(holes), visit.aperiodic, kind))
    owners = [search.loci[k].name for k in survey.owners]
    borders = {
        (number[i], number[j]): frozenset(owners[c] for c in curves)
        for (i, j), curves in survey.plane.borders.items()
        if i in number and j in number
    }
    return tuple(regions), borders


def _letter(k: int) -> str:
    """A, B, ..., Z, AA, AB, ..."""
    letter = chr(ord("A") + k % 26)
    return letter if k < 26 else _letter(k // 26 - 1) + letter
