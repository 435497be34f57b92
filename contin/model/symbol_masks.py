"""One bit for each symbol, so that "does it depend on x" is one integer operation."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final

_bits: dict[str, int] = {}
_next = 0  # bit of the next symbol
_shared = 0  # bits that symbols of large models share
CROWD: Final = 2_000  # symbols of one model from which they share bits: masks with a bit for each cost n^2 memory
CROWD_BITS: Final = 1_024


def symbol_bit(name: str) -> int:
    """The bit that stands for the symbol `name` in every `mask`, assigned on first use for the life of the process."""
    global _next
    bit = _bits.get(name)
    if bit is None:
        bit = _bits[name] = 1 << _next
        _next += 1
    return bit


def crowd(names: Sequence[str]) -> None:
    """Let the symbols of a large model share `CROWD_BITS` bits, unless they have some: call it before they are made.

    Two of them may then have the same bit: what asks whether a node depends on *one* symbol takes a mask that says yes
    as "perhaps" (`depends_on` looks closer); unions over all states of a model are exact as before.
    """
    global _next, _shared
    if len(names) <= CROWD:
        return
    if not _shared:
        _shared = ((1 << CROWD_BITS) - 1) << _next
        _next += CROWD_BITS
    lowest = _shared & -_shared
    for k, name in enumerate(names):
        _bits.setdefault(name, lowest << (k % CROWD_BITS))


def mask_of(names: Iterable[str]) -> int:
    """Union of the bits of several symbols."""
    mask = 0
    for name in names:
        mask |= symbol_bit(name)
    return mask


def distinct(mask: int) -> int:
    """Of a mask, the bits that no two symbols share."""
    return mask & ~_shared
