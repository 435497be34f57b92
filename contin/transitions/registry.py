"""The table (kind of branch, label) -> what is born there, and what the explorer does about it.

A leaf registers itself with the decorator `born`. Leaves are files of this folder and modules that plugins name by
entry points of the group `contin.transitions`. A name tells when a leaf is needed, so that only that one is imported:

    KIND_LABEL_to_WHAT      equilibrium_HB_to_orbits, orbit_PD_to_doubled, orbit_BPC_to_crossing_by_shooting
    KIND_to_WHAT            at points of every type: equilibrium_to_locus, locus_to_equilibria
    LABEL_LABEL_to_WHAT     on branches of every kind: BT_to_homoclinic, HH_to_tori

KIND is one of those of `KINDS`, or none; labels are written in capitals. What starts in two parameters at a point of
codimension one is called `..._to_locus`, what needs three `..._in_three_parameters`.
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from importlib.metadata import entry_points
from pkgutil import iter_modules
from typing import TYPE_CHECKING, Any, Final, TypeVar

import contin.transitions
from contin.continuation.branch import SpecialPoint
from contin.continuation.seed import Seed
from contin.special.table import codes

if TYPE_CHECKING:
    from contin.continuation.problem import Problem

GROUP: Final = "contin.transitions"
KINDS: Final = {  # of branches, by the word of FORMATS, and how file names call them
    "equilibrium": ("equilibrium", "point"), "fixed-point": ("map", "equilibrium", "point"), "orbit": ("orbit",),
    "locus": ("locus",), "bvp": ("bvp",), "algebraic": ("algebraic", "equilibrium", "point"),
    "connection": ("connection",),
}  # fmt: skip

Maker = Callable[[Any, SpecialPoint, Any], list[Seed]]
_Maker = TypeVar("_Maker", bound=Maker)


@dataclass(frozen=True)
class Explored:
    """What the explorer does by itself where something is born.

    orbits : only where families of orbits are wanted.
    generation : it is a family of orbits born on another one, whose number in a row is limited.
    cascade : one such birth leads to the next without end, which has a limit of its own.
    crowded : there are infinitely many beside a homoclinic orbit to a saddle-focus.
    uncertain : that nothing is born is no news.
    when : a condition on the problem of the branch.
    """

    orbits: bool = False
    generation: bool = False
    cascade: bool = False
    crowded: bool = False
    uncertain: bool = False
    when: Callable[[Any], bool] | None = None


@dataclass(frozen=True)
class Transition:
    """One row: on branches of this class of problem, at points of these types (none: of every type), this is born."""

    problem: type
    labels: tuple[str, ...]
    born: str  # in words
    parameters: int  # that vary along what is born
    order: int  # among several that are born at one point; the first one is what a run means that names none
    explored: Explored | None
    make: Maker


_rows: list[Transition] = []


def born(
    on: type | tuple[type, ...], at: str = "", words: str = "", *, parameters: int = 1, order: int = 0,
    explored: Explored | None = None,
) -> Callable[[_Maker], _Maker]:  # fmt: skip
    """Register `make(problem, point, parameter or pair of them) -> seeds`.

    on : class(es) of the problem of the branch.  at : labels, separated by blanks; "" for points of every type.
    """

    def register(make: _Maker) -> _Maker:
        for problem in on if isinstance(on, tuple) else (on,):
            _rows.append(Transition(problem, tuple(at.split()), words, parameters, order, explored, make))
        return make

    return register


def at_point(problem: Problem, label: str, parameters: int) -> list[Transition]:
    """What is born at points of this type on the branches of a problem, in order.

    Of the classes of the problem the first one decides for which anything is registered; a row that names the label
    comes before those for every label.
    """
    for name in _leaves():
        if _needed(name, problem.kind, label, parameters):
            import_module(_leaves()[name])
    mine = [row for row in _rows if row.parameters == parameters]
    for one in type(problem).__mro__:
        here = [row for row in mine if row.problem is one]
        found = [row for row in here if label in row.labels] or [row for row in here if not row.labels]
        if found:
            return sorted(found, key=lambda row: row.order)
    return []


def known_labels(problem: Problem, parameters: int) -> tuple[str, ...]:
    """The types of points at which anything is registered for the branches of a problem."""
    rows = [row for row in everything() if row.parameters == parameters and isinstance(problem, row.problem)]
    return tuple(dict.fromkeys(label for row in rows for label in row.labels))


def families_at(problem: Problem) -> tuple[str, ...]:
    """The types of points at which another family of orbits is born on one of this problem."""
    found = {code: at_point(problem, code, 1) for code in codes(problem.kind)}
    return tuple(code for code, rows in found.items() if any(r.explored and r.explored.generation for r in rows))


def everything() -> list[Transition]:
    """The whole table."""
    for module in _leaves().values():
        import_module(module)
    return list(_rows)


@cache
def _leaves() -> dict[str, str]:
    """Names of leaves and their modules: the files of this folder, then those of plugins."""
    own = {m.name: f"{contin.transitions.__name__}.{m.name}" for m in iter_modules(contin.transitions.__path__)}
    return {name: module for name, module in own.items() if "_to_" in name} | dict(_of_plugins())


def _of_plugins() -> Iterator[tuple[str, str]]:
    if os.environ.get("CONTIN_PLUGINS") == "0":
        return
    for entry in entry_points(group=GROUP):
        if "_to_" in entry.name:
            yield entry.name, entry.module
        else:
            warnings.warn(f"entry point {entry.name!r} of {GROUP}: name it KIND_LABEL_to_WHAT", stacklevel=2)


def _needed(name: str, kind: str, label: str, parameters: int) -> bool:
    words = name.partition("_to_")[0].split("_")
    kinds, labels = [w for w in words if w.islower()], [w for w in words if w.isupper()]
    if (parameters == 1 and name.endswith("_to_locus")) or (parameters != 3 and name.endswith("_in_three_parameters")):
        return False
    return (not kinds or any(k in KINDS.get(kind, (kind,)) for k in kinds)) and (not labels or label in labels)
