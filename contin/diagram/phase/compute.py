"""From equilibria to the phase diagram of a box: search for curves, cut the box, name its regions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.abi import NO_FUNCTION
from contin.continuation.branch import Branch
from contin.continuation.journal import Journal
from contin.continuation.settings import Settings
from contin.continuation.trace import Watcher
from contin.diagram.phase.checks import Check
from contin.diagram.phase.diagram import PhaseDiagram
from contin.diagram.phase.lines import Box
from contin.diagram.phase.phase_data import Region
from contin.diagram.phase.regions import regions_of
from contin.diagram.phase.search import LociSearch
from contin.diagram.phase.survey import Survey
from contin.errors import InputError
from contin.records import Record

if TYPE_CHECKING:
    from contin.search.equilibrium_from_guess import Equilibrium

DEFAULTS: Final = {"steps": 3000, "max_step": 0.03}


def phase(
    starts: Equilibrium | Sequence[Equilibrium],
    parameters: Sequence[str],
    box: Mapping[str, Sequence[float]] | Box,
    settings: Settings | Record | None = None,
    watch: Watcher | None = None,
    orbits: bool = True,
    journal: Journal | None = None,
) -> PhaseDiagram:
    """The phase diagram of the states connected with `starts` in a box of two parameters.

    Curves of folds, Hopf points and branch points, and with `orbits` those of LPC, PD, NS, BPC and of homoclinic
    orbits, are found on lines across the box and followed to its edges. The states of each region are those on all
    branches through its representative point that are connected with a start or with one of the curves, and those on
    which trajectories settle there, from beside unstable equilibria and from scattered points. Special points on those
    branches that lie on no known curve start new ones, and the box is cut again. Cost: about ten branches a line, and
    less than one line a region; `notes` say what budgets left out.

    Ctrl-C ends the search: the curves and regions so far are returned, and `stopped` is true.
    """
    listed: list[Any] = list(starts) if isinstance(starts, list | tuple) else [starts]
    first, second = _pair(parameters)
    bounds = _bounds(box, (first, second))
    chosen = Settings.of(DEFAULTS | dict(settings or {}) if not isinstance(settings, Settings) else settings)
    points = [(np.asarray(s.u), np.asarray(s.p)) for s in listed]
    system = listed[0].system
    followed = orbits and system.kind != "map" and system.jacobian_address != NO_FUNCTION
    settle = followed or (orbits and system.kind == "map")
    problem = listed[0].problem(first)
    search = LociSearch(problem, points, (first, second), bounds, chosen, watch, followed, settle, journal)
    survey = Survey(search)
    stopped = False
    try:
        search.run()
        with search.notes.surviving("the regions"):
            survey.run()
    except KeyboardInterrupt:
        stopped = True
        search.notes.add(_what_is_missing(survey))
    regions: tuple[Region, ...] = ()
    borders: dict[tuple[int, int], frozenset[str]] = {}
    check = Check()
    with search.notes.surviving("the names of the regions"):
        said = len(search.notes.texts)
        regions, borders, check = regions_of(survey)
        if check.places and not stopped:
            stopped, found = _looked_again(survey, check, said)
            regions, borders, check = regions_of(survey) if found else (regions, borders, check)
    loci = tuple(_without_parent(b, search.loci) for b in search.loci)
    return PhaseDiagram(
        (first, second), bounds, loci, regions, borders, tuple(search.branches),
        tuple(search.notes), search.notes.defects, stopped, check,
    )  # fmt: skip


def _looked_again(survey: Survey, check: Check, said: int) -> tuple[bool, bool]:
    """Whether Ctrl-C has ended it, and whether new curves were found where a check disagreed with the regions.

    said : notes before those of the regions, which are told anew where the box is cut again.
    """
    search = survey.search
    of_regions = search.notes.texts[said:]
    del search.notes.texts[said:]
    known = [branch for visit in survey.visits if visit is not None for branch in visit.line.branches]
    stopped = found = False
    try:
        found = search.look_again(check.places, known)
        if found:
            survey.run()
    except KeyboardInterrupt:
        stopped = True
        search.notes.add(_what_is_missing(survey))
    if not found:
        search.notes.extend(of_regions)
    return stopped, found


def _what_is_missing(survey: Survey) -> str:
    """After Ctrl-C."""
    if survey.plane is None:
        return "stopped by the user: there may be more curves, and the regions between them were not looked at"
    left = sum(visit is None for visit in survey.visits)
    if left:
        return f"stopped by the user: {left} of {len(survey.visits)} regions were not looked at"
    return "stopped by the user: stable states of one region were not looked for in all the others"


def _without_parent(branch: Branch, loci: Sequence[Branch]) -> Branch:
    """A curve; where it begins at a point of a branch that is not part of the diagram, as one with no parent."""
    named = branch.parent is not None and any(b.name == branch.parent.branch for b in loci)
    return branch if named else replace(branch, parent=None)


def _pair(parameters: Sequence[str]) -> tuple[str, str]:
    if isinstance(parameters, str) or len(parameters) != 2 or parameters[0] == parameters[1]:
        raise InputError(f"a phase diagram has two parameters; got {parameters!r}")
    return parameters[0], parameters[1]


def _bounds(box: Any, names: tuple[str, str]) -> Box:
    pairs = [box[name] for name in names] if isinstance(box, Mapping) else list(box)
    (a, b), (c, d) = ((float(lo), float(hi)) for lo, hi in pairs)
    if not (a < b and c < d):
        raise InputError(f"each range needs its lower bound below the upper one; got {pairs}")
    return (a, b), (c, d)
