"""The coefficient that decides between super- and subcritical, along curves of PD and NS: it vanishes at GPD and CH.

c of PD or Re d of NS (`contin.problems.orbits.normal_forms.normal_form`) costs as much as some twenty steps. So it is
computed at the first and the last row of a chunk, and before a step in which it has a pole; where its sign changes,
bisection finds the two rows between which it does, and the chunk ends there. Where the values at the ends of this
chunk and of the one before have room for two zeros, or an event came before, rows in between are looked at, too, and
those next to which there may be two poles. The others have no value (NaN), which is no change of sign.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final, Protocol

import numpy as np

from contin.abi import Array
from contin.continuation.sample import Chunk, Sample, Stop
from contin.kernels.rest_of_step import are_straight
from contin.problems.no_derivatives import NoDerivatives
from contin.records import Fields

SLOTS: Final = {"PD": 5, "NS": 9}  # place among the tests
POLES: Final = {"PD": (3, 4), "NS": (4, 5, 6)}  # tests of R2, LPPD; LPNS, R1, R2: the coefficient is infinite there
AT_POLES: Final = {"PD": ("R2", "LPPD"), "NS": ("LPNS", "R1", "R2")}  # the types of these
ZERO: Final = 1e-5  # part of the values beside it that a zero must be below: at strong resonances there are poles
UNDECIDED: Final = 1e-7  # of the terms that it is made of: a coefficient this small has no sign
SAME: Final = 1e-9  # relative difference of parameters and period of a point that is known


class Periodic(Protocol):
    """An orbit."""

    @property
    def period(self) -> float: ...


class CriticalCurve(Protocol):
    """A curve of special orbits whose normal form may change its sign."""

    @property
    def type(self) -> str: ...
    @property
    def critical(self) -> Fields:
        """What the chunks before have told: `typical`, `last` and `failures`."""

    def further(self, z: Array) -> float:
        """cos(theta) of tori."""

    def profile(self, z: Array) -> Periodic:
        """The orbit."""

    def critical_coefficient(self, z: Array, scale: Array) -> tuple[float, float]:
        """c of PD or Re d of NS, and the size of the terms that it is made of."""


def coefficient(curve: CriticalCurve, z: Array, scale: Array, decided: bool = False) -> float:
    """c of PD, Re d of NS; NaN where it has no value (neutral saddles, singular systems).

    decided : NaN, too, where the terms cancel to rounding (a conservative flow).
    """
    if curve.type == "NS" and not abs(curve.further(z)) < 1.0:
        return float("nan")
    try:
        value, size = curve.critical_coefficient(z, scale)
    except (np.linalg.LinAlgError, ZeroDivisionError, NoDerivatives) as error:
        curve.critical.setdefault("failures", []).append(str(error))
        return float("nan")
    return float("nan") if decided and abs(value) <= UNDECIDED * size else float(value)


def remarks(curve: CriticalCurve) -> list[str]:
    """That the coefficient has no value at some places, where its zeros cannot be seen."""
    failures = curve.critical.get("failures", [])
    if not failures:
        return []
    name, label = ("c", "GPD") if curve.type == "PD" else ("Re d", "CH")
    return [
        f"{name} of the normal form could not be computed at {len(failures)} places ({failures[0]}); {label} there are "
        "not told"
    ]


def is_measured(curve: CriticalCurve, sample: Sample) -> bool:
    """True where the coefficient of a sample is known."""
    slot = SLOTS.get(curve.type)
    return slot is not None and sample.tests.size > slot and bool(np.isfinite(sample.tests[slot]))


def measured(curve: CriticalCurve, sample: Sample, scale: Array) -> Sample:
    """The sample with its coefficient."""
    return _with(curve, sample, coefficient(curve, sample.z, scale))


def beside_pole(curve: CriticalCurve, type_: str, sample: Sample, scale: Array) -> Sample:
    """The sample with its coefficient beside a point at which that is infinite: a step may hold a zero and a pole."""
    return measured(curve, sample, scale) if type_ in AT_POLES.get(curve.type, ()) else sample


def cut_at_change(curve: CriticalCurve, chunk: Chunk, scale: Array) -> Chunk:
    """The chunk up to where the sign changes, if it does."""
    if curve.type not in SLOTS or len(chunk) < 2:
        return chunk
    rows = [chunk.sample(row) for row in range(len(chunk))]
    last = len(rows) - 1
    values = {last: coefficient(curve, rows[-1].z, scale, True), 0: _known(curve, rows[0])}
    before = None if values[0] is None else curve.critical.get("before")  # not of the other arm
    if values[0] is None:
        values[0] = coefficient(curve, rows[0].z, scale, True)
    end = last - 1 if _passes_pole(curve, rows[-2], rows[-1]) else last
    if end not in values:
        values[end] = coefficient(curve, rows[end].z, scale, True)
    low, found = 0, values[0] * values[end] < 0.0
    for row in () if found else _beside_poles(curve, rows[: end + 1]):
        values[row] = coefficient(curve, rows[row].z, scale, True)
        if values[low] * values[row] < 0.0:
            found, end = True, row
            break
        low = row if np.isfinite(values[row]) else low
    low = low if found else 0
    lengths = np.cumsum(np.append(0.0, chunk.lengths[1:]))
    if not found and not _is_straight(before, (0.0, values[0]), (float(lengths[end]), values[end])):
        turned = _between(curve, rows, lengths, scale, values, 0, end)
        found, end = (turned is not None), (end if turned is None else turned)
    low, high = (low, end) if found else (last, last)
    while found and high - low > 1:
        middle = (low + high) // 2
        values[middle] = coefficient(curve, rows[middle].z, scale)
        if values[middle] * values[low] < 0.0:
            high = middle
        else:
            low = middle
    if found:
        rows[low], rows[high] = (_with(curve, rows[k], values[k]) for k in (low, high))
        curve.critical["typical"] = max(abs(values[low]), abs(values[high]))
        rows = rows[: high + 1]
    curve.critical["last"] = _place(curve, rows[-1].z), values[high]
    curve.critical["before"] = None if found else (-float(lengths[-1]), values[0])
    if not found:
        return chunk
    shorter = chunk.cut(len(rows), Stop.EVENT, float(chunk.lengths[len(rows) - 1]))
    return replace(shorter, tests=np.array([row.tests for row in rows]))


Place = tuple[float, float]  # arclength from the first row of a chunk, and the coefficient there


def _is_straight(a: Place | None, b: Place, c: Place) -> bool:
    """True where three values in order leave no room for two zeros, or say nothing."""
    if a is None:
        return False
    if not (np.isfinite([*a, *b, *c]).all() and a[0] < b[0] < c[0]):
        return True
    left, middle, right = np.array([[a[1]], [b[1]], [c[1]]])
    return bool(are_straight(left, middle, right, (b[0] - a[0]) / (c[0] - a[0])))


def _between(
    curve: CriticalCurve, rows: list[Sample], lengths: Array, scale: Array, values: dict[int, Any], low: int, high: int
) -> int | None:
    """A row between two of one sign that has the other; None where there is no room for it."""
    if high - low < 2:
        return None
    middle = (low + high) // 2
    values[middle] = coefficient(curve, rows[middle].z, scale)
    if values[middle] * values[low] < 0.0:
        return middle
    a, b, c = ((float(lengths[k]), values[k]) for k in (low, middle, high))
    if _is_straight(a, b, c):
        return None
    first = _between(curve, rows, lengths, scale, values, low, middle)
    return _between(curve, rows, lengths, scale, values, middle, high) if first is None else first


def _passes_pole(curve: CriticalCurve, a: Sample, b: Sample) -> bool:
    return bool(np.any(np.array([a.tests[k] * b.tests[k] for k in POLES[curve.type]]) < 0.0))


def _beside_poles(curve: CriticalCurve, rows: list[Sample]) -> list[int]:
    """Rows next to which the coefficient may have two poles, with other signs between them and other zeros beside them.

    There a test of them comes nearer to zero than it changes in a step, and turns round.
    """
    places = list(POLES[curve.type])
    tests = np.array([row.tests[places] for row in rows])
    if len(tests) < 3:
        return []
    before, here, after = tests[:-2], tests[1:-1], tests[2:]
    size = np.abs(here)
    turns = (size <= np.abs(before)) & (size <= np.abs(after)) & (before * after > 0.0)
    turns &= size <= np.maximum(np.abs(before - here), np.abs(after - here))
    return (1 + np.flatnonzero(turns.any(axis=1))).tolist()


def is_zero(curve: CriticalCurve, value: float) -> bool:
    """True for a zero, not a pole, of the coefficient that `cut_at_change` found."""
    return abs(value) <= ZERO * float(curve.critical.get("typical", np.inf))


def is_pole(curve: CriticalCurve, value: float) -> bool:
    """True where it is larger than beside the place at which it changes its sign."""
    return not abs(value) <= float(curve.critical.get("typical", np.inf))


def _with(curve: CriticalCurve, sample: Sample, value: float) -> Sample:
    tests = sample.tests.copy()
    tests[SLOTS[curve.type]] = value
    return replace(sample, tests=tests)


def _known(curve: CriticalCurve, sample: Sample) -> Any:
    """The value at the last row of the chunk before, if this is that row (perhaps on another mesh)."""
    place, value = curve.critical.get("last", (None, None))
    here = _place(curve, sample.z)
    return value if place is not None and bool(np.all(np.abs(here - place) <= SAME * np.abs(place))) else None


def _place(curve: CriticalCurve, z: Array) -> Array:
    return np.array([z[-1], z[-2], curve.profile(z).period])
