"""The table of special point types: the rows of `types/`, then those that plugins bring.

A plugin's entry point of the group `contin.special` names an object `TYPE`, a `SpecialType`. What other rooms need to
know of a type (words, markers, tests, normal form, curves) they read here, so that a new type is a new row.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from difflib import get_close_matches
from functools import cache
from importlib import import_module
from importlib.metadata import entry_points
from pkgutil import iter_modules
from typing import Any, Final

import contin.special.types
from contin.errors import InputError
from contin.special.special_type import Sign, SpecialType

GROUP: Final = "contin.special"
UNKNOWN: Final = SpecialType(code="", words="special point", codimension=1, on=(), condition="")


@cache
def table() -> Mapping[str, SpecialType]:
    """Every type by its code: those of one parameter, then those of two, as readers expect them."""
    own = [import_module(f"{contin.special.types.__name__}.{m.name}").TYPE for m in iter_modules(_folder())]
    rows = {row.code: row for row in sorted(own, key=lambda row: row.codimension)}
    for row in _of_plugins():
        if row.code in rows:
            raise InputError(f"the special point type {row.code} is defined twice: {rows[row.code].words}, {row.words}")
        rows[row.code] = row
    return rows


def special_type(code: str) -> SpecialType:
    """The row of a code; types that later versions add are special points too, without words of their own."""
    return table().get(code, UNKNOWN)


def checked_codes(where: str, given: Iterable[str]) -> tuple[str, ...]:
    """The codes as they are; InputError for one that no type has, or that carries a number (LP1)."""
    codes_given = tuple(given)
    for code in codes_given:
        if code not in table():
            near = get_close_matches(code.rstrip("0123456789").upper(), table(), n=1, cutoff=0.5)
            advice = f"did you mean {near[0]!r}? " if near else ""
            raise InputError(f"{where}: {code!r} is no type of special point: {advice}known: {', '.join(table())}")
    return codes_given


@cache
def with_own_test(kind: str, locus: str | None) -> tuple[SpecialType, ...]:
    """The types that are found by a function of their own, on a kind of branch or a type of curve."""
    return tuple(row for row in table().values() if row.test is not None and (kind in row.on or locus in row.on))


def function(name: str) -> Any:
    """The function that a row names as 'module:function'."""
    module, _, attribute = name.partition(":")
    return getattr(import_module(module), attribute)


@cache
def codes(kind: str) -> tuple[str, ...]:
    """The types of codimension one on a kind of branch (equilibrium, fixed-point, orbit)."""
    return tuple(row.code for row in table().values() if row.codimension == 1 and kind in row.on)


def test_on_branch(code: str) -> int:
    """Place of the test of a type on branches in one parameter, which have those of folds, branch points, pairs, flips.

    A pair that is no Hopf or Neimark-Sacker point is `neutral`.
    """
    found = special_type("HB" if code == "neutral" else code).branch
    if found is None:
        raise KeyError(code)
    return found


@cache
def tests_of_points(locus: str) -> Mapping[str, int]:
    """Code -> place of its test, on a curve of equilibria or fixed points of this type."""
    return {row.code: row.points[locus].test for row in table().values() if locus in row.points}


@cache
def signs_of_points(locus: str, is_map: bool) -> Mapping[int, tuple[str, int]]:
    """Place of a test -> (code, eigenvalues that change sides), on such a curve of flows or maps."""
    rows = [row for row in table().values() if locus in row.points and (row.maps if is_map else row.flows)]
    found = {row.points[locus].test: (row.code, row.points[locus].moved) for row in rows}
    return dict(sorted(found.items()))


@cache
def tests_of_orbits(locus: str) -> tuple[str, ...]:
    """The codes of the tests on a curve of cycles of this type, in their order from index 2 on."""
    rows = [row for row in table().values() if locus in row.orbits]
    return tuple(row.code for row in sorted(rows, key=lambda row: row.orbits[locus]))


@cache
def tests_of_connections() -> tuple[str, ...]:
    """The codes of the tests on curves of connecting orbits, in their order from index 2 on."""
    known = {row.connections: row.code for row in table().values() if row.connections is not None}
    return tuple(known[k] for k in sorted(known))


@cache
def crossings() -> tuple[str, ...]:
    """Points of codimension two from which other curves are followed than the one that they lie on."""
    rows = [row for row in table().values() if row.codimension == 2 and "HOM" not in row.on]
    return tuple(row.code for row in rows if any(map(_in_a_plane, row.births)) or len(row.curves) > 1)


def _in_a_plane(birth: str) -> bool:
    """False for what needs a third parameter."""
    return not birth.endswith("_in_three_parameters")


def curves_of_points(code: str, own: str) -> tuple[str, ...]:
    """The types of the curves of equilibria through a point of codimension two on a curve of type `own`."""
    return special_type(code).curves or (own,)


def curves_of_orbits(code: str) -> tuple[str, ...]:
    """The types of the curves of cycles through a point of codimension two."""
    row = special_type(code)
    return tuple(special_type(c).cycle or c for c in row.curves) if row.orbits else ()


def of_cycle(code: str) -> str:
    """The code of the same point of a cycle: LPC for LP."""
    return special_type(code).cycle or code


def _folder() -> list[str]:
    return list(contin.special.types.__path__)


def _of_plugins() -> Iterator[SpecialType]:
    if os.environ.get("CONTIN_PLUGINS") == "0":
        return
    for entry in entry_points(group=GROUP):
        row = entry.load()
        if not isinstance(row, SpecialType):
            raise InputError(f"entry point {entry.name!r} of {GROUP} must name a SpecialType; got {type(row).__name__}")
        yield row


__all__ = ["Sign", "SpecialType"]
