"""Labelled points as they were computed, to be followed in another session: texts, read when one is asked for."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

from contin import lazy
from contin.errors import InputError

if TYPE_CHECKING:
    from contin.continuation.branch import Branch, SpecialPoint


@dataclass(frozen=True, repr=False)
class Solutions:
    """`points`: by branch and label, texts; `equations`: the text of the models that they refer to.

    `missing`: why a point is not kept, in words, by branch and label.
    """

    points: Mapping[tuple[str, str], str]
    equations: str
    missing: Mapping[tuple[str, str], str] = field(default_factory=dict)

    @cached_property
    def _read(self) -> Any:
        return lazy.module("stored points").Reader(self.equations)

    def point(self, branch: str, label: str, where: str) -> SpecialPoint:
        """The point as it was computed; `where` is for messages. InputError where the file does not hold it."""
        text = self.points.get((branch, label))
        if text is None:
            why = self.missing.get((branch, label)) or "the file holds no solutions: compute it again with this contin"
            raise InputError(f"{where} cannot be followed from the file: {why}")
        found: SpecialPoint = self._read.point(text, where)
        return found

    def of(self, names: Collection[str]) -> Solutions:
        """Those of the branches with these names."""
        kept = [{key: text for key, text in texts.items() if key[0] in names} for texts in (self.points, self.missing)]
        return Solutions(kept[0], self.equations, kept[1])


def solutions_of(branches: Iterable[Branch]) -> Solutions:
    """What a file keeps of the labelled points of branches."""
    return Solutions(*lazy.module("stored points").texts_of(branches))
