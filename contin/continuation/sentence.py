"""What a branch notes, as data until the branch is whole: what is said, where, and of what kind it is."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from contin.abi import Array
from contin.continuation.position import elsewhere, position
from contin.continuation.problem import Problem


@dataclass(frozen=True)
class Sentence:
    """A note: sentences of one text are said once, with the first of their places and the number of the others.

    place : in words; empty where there is none, or the text has it.  defect : it tells of an error that contin did not
    foresee.  corner : it tells that unstable eigenvalues jump at a corner of the equations.
    """

    text: str
    place: str = ""
    defect: bool = False
    corner: bool = False

    @classmethod
    def near(cls, problem: Problem, z: Array, text: str, more: str = "", defect: bool = False) -> Sentence:
        """About a solution; `more` stands behind its place."""
        return cls(text, position(problem, z) + more, defect)

    def __str__(self) -> str:
        return f"{self.text} near {self.place}" if self.place else self.text


def distinct(sentences: Iterable[Sentence]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """One note of each text, with the number of other places; and those of them that tell of defects."""
    alike: dict[str, list[Sentence]] = {}
    for sentence in dict.fromkeys(sentences):
        alike.setdefault(sentence.text, []).append(sentence)
    notes = {f"{same[0]}{elsewhere(len(same) - 1)}": any(one.defect for one in same) for same in alike.values()}
    return tuple(notes), tuple(note for note, defect in notes.items() if defect)
