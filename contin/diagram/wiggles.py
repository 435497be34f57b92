"""Beside a homoclinic orbit to a saddle-focus infinitely many families of orbits are born: which of them are followed.

A family oscillates in the parameter about the homoclinic value, ever more narrowly, while its period grows (Glendinning
and Sparrow, 1984), and between any two of these folds other families are born, each of which does so again.
"""

from __future__ import annotations

from itertools import takewhile
from typing import Final

from contin.continuation.branch import Branch, End, SpecialPoint

LONG: Final = 0.4  # part of the period at the end of a family from which its orbits are long
FOLLOWED: Final = 2  # families born between the folds of one family: the pair between the first two
EVEN: Final = 1e-6  # of the parameter's range: folds so near the homoclinic value are on either side of it


def beside_homoclinic(branch: Branch, point: SpecialPoint) -> bool:
    """True for a point at which one of the infinitely many families is born that are not followed.

    Where a family has been doubled before, none of those born on it is followed.
    """
    for row, end in ((0, branch.ends[0]), (-1, branch.ends[1])):
        if not end.data.get("spiral"):
            continue
        if "PD" in branch.born_at or point.values["period"] > LONG * float(branch.columns["period"][row]):
            return True
        among = _among_folds(branch, end, row)
        born = [p for p in among if p.type == point.type]
        if any(p.label == point.label for p in born[FOLLOWED:]):
            return True
    return False


def _among_folds(branch: Branch, end: End, row: int) -> list[SpecialPoint]:
    """The labelled points from the first of the folds about the homoclinic value to this end."""
    name = branch.parameters[0]
    at, values = float(end.data["at"][name]), branch.columns[name]
    even = EVEN * float(values.max() - values.min())
    outwards = sorted(branch.points, key=lambda p: p.index, reverse=row == -1)
    folds = [p for p in outwards if p.type == "LPC"]
    offsets = [p.values[name] - at for p in folds]

    def goes_on(k: int) -> bool:
        """Fold k is further out than the one before, on the other side."""
        if k == 0:
            return True
        last, here = offsets[k - 1], offsets[k]
        further = abs(here) + even >= abs(last) and (last * here < 0.0 or abs(last) <= even)
        return further and folds[k].values["period"] < folds[k - 1].values["period"]

    regular = list(takewhile(goes_on, range(len(folds))))
    if len(regular) < FOLLOWED:
        return []
    first = outwards.index(folds[regular[-1]])
    return outwards[:first][::-1]
