"""Exact null spaces of small rational matrices, and bases of them that people recognise."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Final

Row = list[Fraction]
EFFORT: Final = 400_000  # products of fractions that the look for a plain basis may take (half a second)


def left_kernel(columns: Sequence[dict[int, Fraction]], size: int) -> list[Row]:
    """All c (size,) with sum_i c_i a_i = 0 for every column {i: a_i}, as a basis in reduced row echelon form."""
    pivots: dict[int, dict[int, Fraction]] = {}  # row i -> a relation c_i = - sum others
    for column in columns:
        left = dict(column)
        for i in sorted(set(left) & set(pivots)):
            factor = left.pop(i, Fraction(0))
            for j, a in pivots[i].items():
                left[j] = left.get(j, Fraction(0)) + factor * a
        left = {i: a for i, a in left.items() if a}
        if not left:
            continue
        chosen = max(left)
        scale = -left.pop(chosen)
        relation = {j: a / scale for j, a in left.items()}
        for known in pivots.values():
            factor = known.pop(chosen, Fraction(0))
            if factor:
                for j, a in relation.items():
                    known[j] = known.get(j, Fraction(0)) + factor * a
        pivots[chosen] = relation
    basis = []
    for free in (i for i in range(size) if i not in pivots):
        row = [Fraction(0)] * size
        row[free] = Fraction(1)
        for i, relation in pivots.items():
            row[i] = relation.get(free, Fraction(0))
        basis.append(row)
    return basis


def plain_basis(basis: Sequence[Row]) -> list[Row]:
    """Vectors of the same space with whole coefficients: without a minus sign where there are such, and short.

    Echelon forms with every unknown eliminated last in turn give the candidates (for chemistry: moieties; Schuster and
    Hoefer, J. Chem. Soc. Faraday Trans. 87, 1991, compute all of them).
    """
    if not basis:
        return []
    size = len(basis[0])
    orders = [list(range(size)), list(range(size))[::-1]]
    used = [i for i in range(size) if any(row[i] for row in basis)]
    for i in used[: EFFORT // (2 * size * len(basis) ** 2)]:
        others = [j for j in range(size) if j != i]
        orders += [[*others, i], [i, *others]]
    candidates: dict[tuple[Fraction, ...], None] = {}
    for order in orders:
        for row in _echelon(basis, order):
            candidates[tuple(_whole(row))] = None
    ranked = sorted(candidates, key=lambda row: (any(a < 0 for a in row), sum(a != 0 for a in row), _position(row)))
    chosen: list[Row] = []
    reduced: list[tuple[int, Row]] = []
    for candidate in ranked:
        rest = _remainder(list(candidate), reduced)
        if any(rest):
            lead = next(i for i, a in enumerate(rest) if a)
            reduced.append((lead, [a / rest[lead] for a in rest]))
            chosen.append(list(candidate))
        if len(chosen) == len(basis):
            break
    return sorted(chosen, key=_position)


def _remainder(row: Row, reduced: Sequence[tuple[int, Row]]) -> Row:
    for lead, known in reduced:
        factor = row[lead]
        if factor:
            row = [a - factor * b for a, b in zip(row, known, strict=True)]
    return row


def _position(row: Sequence[Fraction]) -> tuple[int, ...]:
    return tuple(i for i, a in enumerate(row) if a)


def _echelon(basis: Sequence[Row], order: Sequence[int]) -> list[Row]:
    """Reduced row echelon form, pivots looked for in this order of the unknowns."""
    rows = [list(row) for row in basis]
    done = 0
    for column in order:
        pivot = next((k for k in range(done, len(rows)) if rows[k][column]), None)
        if pivot is None:
            continue
        rows[done], rows[pivot] = rows[pivot], rows[done]
        scale = rows[done][column]
        rows[done] = [a / scale for a in rows[done]]
        for k, row in enumerate(rows):
            factor = row[column]
            if k != done and factor:
                rows[k] = [a - factor * b for a, b in zip(row, rows[done], strict=True)]
        done += 1
        if done == len(rows):
            break
    return rows


def _whole(row: Row) -> Row:
    """The smallest whole multiple, with more positive coefficients than negative ones."""
    factor = Fraction(math.lcm(*(a.denominator for a in row)))
    divisor = math.gcd(*(int(a * factor) for a in row)) or 1
    sign = -1 if sum(a < 0 for a in row) > sum(a > 0 for a in row) else 1
    return [sign * a * factor / divisor for a in row]
