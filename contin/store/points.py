"""Labelled points with all that belongs to them as texts, and back: solutions, metrics, vectors, equations."""

from __future__ import annotations

import json
from collections.abc import Iterable
from functools import cached_property
from typing import TYPE_CHECKING, Final

from contin.continuation.as_computed import as_computed
from contin.continuation.branch import SpecialPoint
from contin.continuation.defects import described
from contin.errors import ContinError, InputError
from contin.store.encoded import Table, decode, encode
from contin.store.sound import check

if TYPE_CHECKING:
    from contin.continuation.branch import Branch

FIELDS: Final = (
    "type", "label", "index", "z", "tangent", "values", "residual", "error", "eigenvalues", "normal_form", "vectors",
    "also", "branch", "scale", "problem",
)  # fmt: skip
_WRONG: Final = (
    ValueError, KeyError, TypeError, IndexError, AttributeError, RecursionError, OverflowError, ArithmeticError,
    AssertionError,
)  # fmt: skip

Texts = dict[tuple[str, str], str]


class Reader:
    """Points from the texts of one file; its models are compiled once."""

    def __init__(self, equations: str) -> None:
        self._equations = equations

    @cached_property
    def _table(self) -> Table:
        return Table.of(json.loads(self._equations))

    def point(self, text: str, where: str) -> SpecialPoint:
        """The point; InputError where the text is none, or does not fit its equations."""
        try:
            data = json.loads(text)
            found = SpecialPoint(**{name: decode(data[name], self._table) for name in FIELDS})
            check(found)
        except ContinError as error:
            raise InputError(f"{where} cannot be followed from the file, which is damaged: {error}") from None
        except _WRONG as error:
            why = f"damaged, or of a newer contin ({described(error)})"
            raise InputError(f"{where} cannot be followed from the file: {why}") from None
        return found


def texts_of(branches: Iterable[Branch]) -> tuple[Texts, str, Texts]:
    """By branch and label the texts of points; that of the models; and why a point has none."""
    table = Table()
    points: Texts = {}
    missing: Texts = {}
    for branch in branches:
        for point in branch.points:
            key = branch.name, point.label
            try:
                computed = as_computed(point)
                data = {name: encode(getattr(computed, name), table) for name in FIELDS}
            except InputError as error:
                missing[key] = str(error)
            else:
                points[key] = json.dumps(data, separators=(",", ":"), allow_nan=False)
    return points, json.dumps(table.document(), separators=(",", ":")), missing
