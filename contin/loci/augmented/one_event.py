"""What happened between two points of a curve on which events are told apart by the signs of their tests alone."""

from __future__ import annotations

from collections.abc import Sequence

from contin.continuation.sample import Sample, opposite

FIRST = 2  # place of the first test among those of a sample


def test_of(types: Sequence[str], type_: str) -> int | None:
    """Place of the test of a type among those of a sample, which are of these types in turn."""
    return FIRST + types.index(type_) if type_ in types else None


def one_event(types: Sequence[str], moves: Sequence[int], a: Sample, b: Sample) -> tuple[str, ...] | None:
    """The one event that explains what changed; () where nothing did, None where no one event explains it.

    moves : how many eigenvalues change sides at each; where they belong to the curve, none does.
    """
    changed = opposite(a.tests[FIRST:], b.tests[FIRST:])
    crossed = [k for k, there in enumerate(changed) if there]
    moved = abs(a.unstable - b.unstable)
    if not crossed:
        return () if moved == 0 else None
    return (types[crossed[0]],) if len(crossed) == 1 and moved in (0, moves[crossed[0]]) else None
