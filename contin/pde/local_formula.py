"""A formula at many nodes: its value, its slopes and its multilinear forms in arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache, cached_property

import numpy as np

from contin.abi import Array, Vector
from contin.model.expression import ZERO, Expression, symbols_in
from contin.pde.arrays import ArrayFormulas
from contin.pde.unknowns import LinearMap
from contin.symbolic.calculus.derivatives import direction_symbols, directional, sparse_jacobian
from contin.symbolic.calculus.remove_singularities import remove_singularities

Jet = dict[frozenset[int], Vector]
"""Mixed derivatives along directions: the set of directions -> the derivative; the empty set is the value."""

Values = Mapping[str, float]
NOTHING: frozenset[int] = frozenset()


class LocalFormula:
    """`formula` in slots, parameters and coordinates, at `size` nodes, with the maps of its slots there."""

    def __init__(
        self, formula: Expression, maps: Mapping[str, LinearMap], coordinates: Mapping[str, Array], size: int
    ) -> None:
        self.formula = remove_singularities([formula])[0]
        used = symbols_in([self.formula])
        self.slots = [name for name in used if name in maps]
        self.maps = [maps[name] for name in self.slots]
        self.coordinates = {name: values for name, values in coordinates.items() if name in used}
        self.parameters = [name for name in used if name not in maps and name not in coordinates]
        self.size = size
        self._value = ArrayFormulas([self.formula])
        self._forms: dict[int, tuple[ArrayFormulas, list[list[str]]]] = {}  # with the names of the changes

    def slot_values(self, u: Vector, b: Vector, g: Vector | None) -> list[Vector]:
        """Each slot at the nodes."""
        return [m(u, b, g) for m in self.maps]

    def value(self, slots: Sequence[Vector], p: Values) -> Vector:
        """(size,), or (size, K) where the slots are given in K states."""
        return self._value(self._named(slots, p), self.shape(slots))[0]

    def shape(self, slots: Sequence[Vector]) -> tuple[int, ...]:
        """Of the values: as the slots are."""
        return (self.size, *slots[0].shape[1:]) if slots else (self.size,)

    def slopes(self, slots: Sequence[Vector], p: Values) -> list[Vector]:
        """The derivative in each slot."""
        return self._slopes(self._named(slots, p), self.shape(slots))

    def _named(self, slots: Sequence[Vector], p: Values) -> dict[str, object]:
        wide = bool(slots) and slots[0].ndim == 2
        places = {name: x[:, None] if wide else x for name, x in self.coordinates.items()}
        return {**p, **places, **dict(zip(self.slots, slots, strict=True))}

    @cached_property
    def _slopes(self) -> ArrayFormulas:
        entries = sparse_jacobian([self.formula], self.slots)
        return ArrayFormulas([entries.get((0, j), ZERO) for j in range(len(self.slots))])

    def jet(self, slots: Sequence[Jet], p: Values, rates: Sequence[Mapping[str, float]], wanted: frozenset[int]) -> Jet:
        """Derivatives along all subsets of `wanted`; rates[k] are those of the parameters along direction k."""
        here = [s[NOTHING] for s in slots]
        every = subsets(wanted)
        found = self._derivatives(every, slots, p, rates, wanted)
        return {NOTHING: self.value(here, p), **dict(zip(every, found, strict=True))}

    def along_all(
        self, slots: Sequence[Jet], p: Values, rates: Sequence[Mapping[str, float]], whole: frozenset[int]
    ) -> Vector:
        """What `jet` has for `whole`, the derivative along all of these directions; the value where there are none."""
        if not whole:
            return self.value([s[NOTHING] for s in slots], p)
        return self._derivatives((whole,), slots, p, rates, whole)[0]

    def _derivatives(
        self, of: Sequence[frozenset[int]], slots: Sequence[Jet], p: Values, rates: Sequence[Mapping[str, float]],
        wanted: frozenset[int],
    ) -> list[Vector]:  # fmt: skip
        """Those along some subsets of `wanted`."""
        here = [s[NOTHING] for s in slots]
        named, shape = self._named(here, p), self.shape(here)
        along = {block: self._along(block, slots, rates) for block in subsets(wanted)}
        moving = {block for block, changes in along.items() if any(np.any(x) for x in changes)}
        found = []
        for subset in of:
            total: Vector = np.zeros(shape)
            for blocks in partitions(subset):
                if moving.issuperset(blocks):
                    total = total + self._form([along[block] for block in blocks], named, shape)
            found.append(total)
        return found

    def _along(
        self, block: frozenset[int], slots: Sequence[Jet], rates: Sequence[Mapping[str, float]]
    ) -> list[Vector | float]:
        """The derivatives of slots and parameters along the directions of a block."""
        single = rates[next(iter(block))] if len(block) == 1 else {}
        return [*(s.get(block, 0.0) for s in slots), *(single.get(name, 0.0) for name in self.parameters)]

    def _form(
        self, along: Sequence[Sequence[Vector | float]], named: Mapping[str, object], shape: tuple[int, ...]
    ) -> Vector:
        """D^k f [q_1, ..., q_k], q_j changes of slots and parameters."""
        k = len(along)
        if k not in self._forms:
            names = [*self.slots, *self.parameters]
            directions = [direction_symbols(j + 1, len(names)) for j in range(k)]
            called = [[str(symbol.value) for symbol in direction] for direction in directions]
            self._forms[k] = ArrayFormulas(directional([self.formula], names, directions)), called
        form, called = self._forms[k]
        values = dict(named)
        for names, changes in zip(called, along, strict=True):
            values.update(zip(names, changes, strict=True))
        return form(values, shape)[0]


@cache
def subsets(whole: frozenset[int]) -> tuple[frozenset[int], ...]:
    """All but the empty one, smaller ones first."""
    members = sorted(whole)
    found = [frozenset(m for i, m in enumerate(members) if code >> i & 1) for code in range(1, 1 << len(members))]
    return tuple(sorted(found, key=lambda s: (len(s), sorted(s))))


@cache
def partitions(whole: frozenset[int]) -> tuple[tuple[frozenset[int], ...], ...]:
    """All ways to cut a set into blocks."""
    if not whole:
        return ((),)
    first = min(whole)
    found: list[tuple[frozenset[int], ...]] = []
    for blocks in partitions(whole - {first}):
        found.append((frozenset({first}), *blocks))
        for k, block in enumerate(blocks):
            found.append((*blocks[:k], block | {first}, *blocks[k + 1 :]))
    return tuple(found)
