"""Linear systems whose coefficients are formulas: block by block, each block by Cramer's rule.

A pivot that is chosen once may vanish where the matrix is regular; a determinant does not. So nothing here divides by
anything but the determinants of the diagonal blocks of the matrix's block triangular form (Duff, Erisman and Reid,
Direct Methods for Sparse Matrices, ch. 6): the solution has a value wherever the matrix is regular.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from contin.errors import ContinError
from contin.model.expression import ONE, ZERO, Expression, add, div, mul, neg, sub

LARGEST_BLOCK: Final = 8  # unknowns that all depend on each other: a determinant of k takes about k 2^k products

Matrix = Sequence[Sequence[Expression]]


class StructureError(ContinError, ValueError):
    """The matrix is singular whatever its entries are; `rows` determine too few unknowns between them."""

    def __init__(self, rows: Sequence[int]) -> None:
        super().__init__("the matrix is structurally singular")
        self.rows = tuple(rows)


class BlockError(ContinError, ValueError):
    """More unknowns depend on each other than can be solved for by formulas."""

    def __init__(self, rows: Sequence[int]) -> None:
        super().__init__(f"{len(rows)} unknowns depend on each other; formulas solve for {LARGEST_BLOCK} at most")
        self.rows = tuple(rows)


@dataclass(frozen=True, eq=False)
class FormulaSolver:
    """A square matrix of formulas in block triangular form: `blocks` of (rows, columns), each after those it needs."""

    matrix: Matrix
    blocks: tuple[tuple[tuple[int, ...], tuple[int, ...]], ...]
    determinants: tuple[Expression, ...]

    @classmethod
    def of(cls, matrix: Matrix) -> FormulaSolver:
        """Raises StructureError, BlockError."""
        blocks = _blocks(matrix)
        for rows, _ in blocks:
            if len(rows) > LARGEST_BLOCK:
                raise BlockError(rows)
        determinants = [_determinant([[matrix[r][c] for c in columns] for r in rows]) for rows, columns in blocks]
        return cls(matrix, tuple(blocks), tuple(determinants))

    @property
    def determinant(self) -> Expression:
        """Of the matrix, but for its sign."""
        return mul(ONE, *self.determinants)

    def solve(self, right: Sequence[Expression]) -> list[Expression]:
        """x with matrix x = right."""
        x: list[Expression] = [ZERO] * len(right)
        for (rows, columns), determinant in zip(self.blocks, self.determinants, strict=True):
            b = []
            for r in rows:
                known = [mul(a, x[c]) for c, a in enumerate(self.matrix[r]) if c not in columns and a is not ZERO]
                b.append(sub(right[r], add(*known)) if known else right[r])
            block = [[self.matrix[r][c] for c in columns] for r in rows]
            for k, c in enumerate(columns):
                replaced = [[*row[:k], value, *row[k + 1 :]] for row, value in zip(block, b, strict=True)]
                top = _determinant(replaced)
                x[c] = ZERO if top is ZERO else div(top, determinant)
        return x


def _determinant(matrix: Matrix) -> Expression:
    """By rows, each minor once: k 2^k products."""
    known: dict[tuple[int, ...], Expression] = {(): ONE}

    def minor(columns: tuple[int, ...]) -> Expression:
        if columns not in known:
            row, terms = matrix[len(matrix) - len(columns)], []
            for k, c in enumerate(columns):
                if row[c] is not ZERO:
                    rest = minor(columns[:k] + columns[k + 1 :])
                    if rest is not ZERO:
                        terms.append(mul(row[c], rest) if k % 2 == 0 else neg(mul(row[c], rest)))
            known[columns] = add(*terms) if terms else ZERO
        return known[columns]

    return minor(tuple(range(len(matrix))))


def _blocks(matrix: Matrix) -> list[tuple[tuple[int, ...], tuple[int, ...]]]:
    """Rows and columns of the diagonal blocks, in an order in which each needs only earlier ones."""
    columns_of = [[c for c, a in enumerate(row) if a is not ZERO] for row in matrix]
    row_of = _matching(columns_of)
    column_of = {r: c for c, r in row_of.items()}
    needs = {r: [row_of[c] for c in columns_of[r] if row_of[c] != r] for r in range(len(matrix))}
    return [(rows, tuple(column_of[r] for r in rows)) for rows in _components(needs)]


def _matching(columns_of: Sequence[Sequence[int]]) -> dict[int, int]:
    """A row for every column (augmenting paths)."""
    row_of: dict[int, int] = {}
    for start in range(len(columns_of)):
        seen: dict[int, int] = {}  # column: the row that it was reached from
        queue, end = [start], -1
        for r in queue:
            for c in columns_of[r]:
                if c in seen:
                    continue
                seen[c] = r
                if c not in row_of:
                    end = c
                    break
                queue.append(row_of[c])
            if end >= 0:
                break
        if end < 0:
            raise StructureError(sorted(queue))
        while True:  # back along the path
            r = seen[end]
            before = next((c for c, other in row_of.items() if other == r), -1)
            row_of[end] = r
            if r == start:
                break
            end = before
    return row_of


def _components(needs: dict[int, list[int]]) -> list[tuple[int, ...]]:
    """Strongly connected components, each after those it needs (Tarjan 1972, without recursion)."""
    index: dict[int, int] = {}
    low: dict[int, int] = {}
    path: list[int] = []
    found: list[tuple[int, ...]] = []
    done: set[int] = set()
    for root in needs:
        if root in index:
            continue
        work = [(root, iter(needs[root]))]
        index[root] = low[root] = len(index)
        path.append(root)
        while work:
            node, rest = work[-1]
            following = next((m for m in rest if m not in done), None)
            if following is None:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[node])
                if low[node] == index[node]:
                    at = path.index(node)
                    found.append(tuple(sorted(path[at:])))
                    done.update(path[at:])
                    del path[at:]
            elif following in index:
                low[node] = min(low[node], index[following])
            else:
                index[following] = low[following] = len(index)
                path.append(following)
                work.append((following, iter(needs[following])))
    return found
