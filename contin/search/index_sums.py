"""A necessary condition that all solutions are known: the sum of their indices does not depend on the parameter.

The index of a solution of F(u) = 0 is the sign of det(-F_u), (-1)^unstable. At folds and branch points the sum over the
solutions that meet does not change: over all of them (Brouwer's degree) it is the same at all values of a parameter
between which no solution tends to infinity or leaves the domain of F.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from contin.abi import Array


def index_between(unstable: Array | None, row: int) -> int:
    """The index of the solution between two rows of a branch; 0 where it is not known, or changes between them."""
    if unstable is None:
        return 0
    a, b = (float(unstable[k]) for k in (row, row + 1))
    return (1 - 2 * (int(a) % 2)) if a == b else 0  # NaN is unlike itself


def words(parameter: str, indices: Mapping[float, Sequence[int]]) -> str | None:
    """What differs, in words; None where the sums agree or are not known."""
    sums = {value: sum(each) for value, each in indices.items() if each and all(each)}
    if len(set(sums.values())) < 2:
        return None
    told = ", ".join(f"{total} at {value:.6g}" for value, total in sums.items())
    return (
        f"the indices (-1)^unstable of the solutions have different sums: {told}. Some solutions are not known, or "
        f"they tend to infinity or end between these values of {parameter}"
    )
