"""The account of a branch: every change of the number of unstable eigenvalues is explained by the labels between."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.continuation.outcome import Verified
from contin.special.table import special_type

ANY: Final = 1_000_000
TURNS: Final = 1e-5  # scaled slope of the parameter at a pitchfork: so small along the branch that turns there,
STEEP: Final = 1e-2  # ... and larger along the one that is crossed
BESIDE: Final = 3  # rows about a corner that the corrector may put on either of its arms
TURNED: Final = 1e-6  # scaled slope of the parameter beyond which its sign is no rounding error
SEEN: Final = ("UZ", "EX")  # what tells of no event
TWICE: Final = ("BP", "BPC")  # points that a branch may pass twice
ELSEWHERE: Final = 2  # a branch comes back to a label only if more rows lie between
BEYOND, ROUNDED = 0.2, 1e-12  # of two rows' distance, for what bends between them; of values
MET: Final = ("joined", "hopf", "homoclinic", "heteroclinic", "surface")  # ends whose last row is a special point


def _critical(code: str) -> int:
    """Most critical values of a point of this type; any number where the table names none."""
    known = special_type(code).critical
    return ANY if known is None else known


def moved(point: Verified) -> int:
    """How many eigenvalues (multipliers) may change sides at a labelled point."""
    if point.normal_form.get("kind") == "nonsmooth":
        return ANY
    kernel = max(int(point.vectors.get("kernel", 1)), int(point.normal_form.get("kernel", 1)))
    return _critical(point.type) * kernel + 2 * len(point.also)


def certainly(point: Verified, slope: float) -> int | None:
    """How many eigenvalues change sides there: all in one sense, and one set of them; None where that is not certain.

    slope : of the parameter along the branch, scaled. Along a branch that turns at a pitchfork the critical eigenvalue
    touches zero; along the one that is crossed it changes sides.
    """
    several = int(point.vectors.get("kernel", 1)) != 1 or bool(point.also) or point.touches
    kind = point.normal_form.get("kind")
    if several or kind in ("nonsmooth", "tangency", "degenerate") or _critical(point.type) >= ANY:
        return None
    if kind == "pitchfork" and abs(slope) < STEEP:
        return 0 if abs(slope) <= TURNS else None
    return moved(point)


def _is_sum(change: int, parts: Iterable[int], slack: int) -> bool:
    """True where change is a sum of all `parts` with any signs, up to `slack`."""
    sums = {0}
    for part in parts:
        sums = {total + sign * part for total in sums for sign in (-1, 1)}
    return any(abs(change - total) <= slack for total in sums)


def unexplained(
    unstable: NDArray[np.int64], labels: Iterable[tuple[int, Verified, float]], born: Iterable[int] = (),
    jumps: Iterable[int] = (), exact: bool = True,
) -> list[int]:  # fmt: skip
    """Rows before which `unstable` does not change by what the labels since the last unlabelled row explain.

    unstable (rows,) : critical values not counted at labelled rows.  labels : (row, point, slope of the parameter along
    the branch there, scaled).  born : rows at special points of other branches, whose critical values are not counted
    either.  jumps : rows before which the equations are not smooth and any number of values changes.  exact : a simple
    label changes `unstable` by its number, not less; not so where the unknowns are others than the states, as along
    folds under a condition.
    """
    allowed: dict[int, int] = dict.fromkeys(born, ANY)
    exactly: dict[int, list[int]] = {}
    corners = list(jumps)
    for row, point, slope in labels:
        sure = certainly(point, slope) if exact else None
        if sure is not None:
            exactly.setdefault(row, []).append(sure)
            allowed.setdefault(row, 0)
        else:
            allowed[row] = allowed.get(row, 0) + moved(point)
        if point.normal_form.get("kind") == "nonsmooth":
            corners.append(row)
    counted = np.ones(len(unstable), dtype=bool)
    counted[[row for row in allowed if 0 <= row < len(unstable)]] = False
    rows = np.flatnonzero(counted)
    known = {row: value + sum(exactly.get(row, ())) for row, value in allowed.items()}
    excused = _of_arms(unstable, rows, corners, known)
    changes = np.diff(unstable[rows])
    found = []
    for place in np.flatnonzero((changes != 0) | (np.diff(rows) > 1)).tolist():  # from one counted row to the next one
        first, row = int(rows[place]), int(rows[place + 1])
        slack = sum(allowed[between] for between in range(first + 1, row))
        parts = [part for between in range(first + 1, row) for part in exactly.get(between, ())]
        if not _is_sum(int(changes[place]), parts, slack) and not (first in excused and row in excused):
            found.append(row)
    return found


def untold_turns(
    slopes: NDArray[np.float64], labels: Iterable[tuple[int, Verified, float]], jumps: Iterable[int]
) -> list[int]:  # fmt: skip
    """Rows before which the parameter turns, where no label lies between and no note tells of a corner.

    slopes (rows,) : of the parameter along the branch, scaled.  A smooth fold changes `unstable`; a corner need not.
    """
    told = {row for row, point, _ in labels if point.type not in SEEN} | set(jumps)
    sure = np.abs(slopes) > TURNED
    turning = np.flatnonzero(sure[1:] & sure[:-1] & (slopes[1:] * slopes[:-1] < 0.0)) + 1
    return [int(row) for row in turning if row not in told and row - 1 not in told]


def needs_no_label(
    row: int, unstable: NDArray[np.int64], columns: Mapping[str, NDArray[np.float64]],
    labels: Iterable[tuple[int, Verified, float]],
) -> bool:  # fmt: skip
    """True where `unstable` changes before a row at no point of a type of its own.

    Among neutral saddles, beside which further eigenvalues may pass the stability boundary, or at a label elsewhere.
    """
    neutral = columns.get("neutral")
    if neutral is not None and bool(neutral[row]) and bool(neutral[row - 1]):
        return True
    return passed_again(row, unstable, columns, labels)


def passed_again(
    row: int, unstable: NDArray[np.int64], columns: Mapping[str, NDArray[np.float64]],
    labels: Iterable[tuple[int, Verified, float]],
) -> bool:  # fmt: skip
    """True where the branch passes, just before a row, a branch point that is one of its own labels elsewhere.

    As in the middle of a figure of eight: the point is labelled once. All columns have its values between two rows.
    """
    change = abs(int(unstable[row]) - int(unstable[row - 1]))
    for place, point, _ in labels:
        if point.type not in TWICE or change != moved(point) or abs(place - row) <= ELSEWHERE:
            continue
        if all(_between(values[row - 1], values[row], values[place]) for values in columns.values()):
            return True
    return False


def turns_again(
    row: int, columns: Mapping[str, NDArray[np.float64]], labels: Iterable[tuple[int, Verified, float]]
) -> bool:  # fmt: skip
    """True where the parameter turns, just before a row, at a branch point that is one of its own labels elsewhere.

    As in the node of Descartes' folium, where the branch comes back along the other arm. Values between two rows may
    lie beyond both by as much as they change in the steps beside; so a label within these steps is no second passage,
    and a turn beside it is one that nobody has seen.
    """
    for place, point, _ in labels:
        if point.type not in TWICE or abs(place - row) <= ELSEWHERE:
            continue
        if all(_bent(values, row, float(values[place])) for values in columns.values()):
            return True
    return False


def _bent(values: NDArray[np.float64], row: int, value: float) -> bool:
    """True where value lies between those of a row and the one before, or beyond as far as the curve may bend."""
    beside = np.abs(np.diff(values[max(row - 2, 0) : row + 2]))
    a, b = float(values[row - 1]), float(values[row])
    slack = float(beside.max()) + ROUNDED * max(abs(a), abs(b), abs(value))
    return min(a, b) - slack <= value <= max(a, b) + slack


def _between(a: float, b: float, value: float) -> bool:
    """True where value lies between two others, or beyond by a part of their distance."""
    slack = BEYOND * abs(b - a) + ROUNDED * max(abs(a), abs(b), abs(value))
    return bool(min(a, b) - slack <= value <= max(a, b) + slack)


def _of_arms(
    unstable: NDArray[np.int64], rows: NDArray[np.intp], corners: Iterable[int], allowed: Mapping[int, int]
) -> set[int]:
    """Counted rows about corners whose `unstable` is that of one of the two arms that meet there.

    Next to a corner two solutions of the equations' two formulas are closer than a step, and the corrector may end on
    either, whatever its row's place: so a row within `BESIDE` of a corner says nothing about where the change is, but
    it is one arm's or the other's, and these are known from the first rows beyond. A row with a third number is none
    of them, and its change stays without explanation.
    """
    excused: set[int] = set()
    for corner in corners:
        window = rows[np.abs(rows - corner) <= BESIDE]
        before, after = rows[rows < corner - BESIDE], rows[rows > corner + BESIDE]
        ends = [int(before[-1])] if len(before) else []
        ends += [int(after[0])] if len(after) else []
        others = sum(v for row, v in allowed.items() if 0 < abs(row - corner) <= BESIDE)
        arms = unstable[ends] if len(ends) == 2 else unstable[[*ends, *window]]  # an arm that ends in the window
        near = [int(r) for r in window if len(arms) and int(np.abs(arms - unstable[r]).min()) <= others]
        excused.update(near, ends)
    return excused
