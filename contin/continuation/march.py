"""The march in plain Python, for problems without a kernel: user functions, sparse and matrix-free systems.

What is decided after a step (the next one's length, guards, dips, coming back to the start) is asked of the same code
as in the compiled marches, `contin.kernels.steering`, with the numbers of `Decisions`; what costs time here is the
problem's own linear algebra, which it offers as a `Linearisation` at a point.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol, cast

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.corrector import (
    EQUILIBRIA,
    Again,
    Correctable,
    Corrected,
    Decisions,
    Forming,
    Linearisation,
    correct,
)
from contin.continuation.extrapolation import REACH, cubic
from contin.continuation.outcome import Failure
from contin.continuation.problem import InTwoParameters
from contin.continuation.sample import Chunk, Frame, Sample, Stop
from contin.continuation.settings import Settings
from contin.continuation.turning_off import Solved, Verdict, verdict_on
from contin.kernels import steering
from contin.kernels.special_orbits.sides import mixed_ratio
from contin.kernels.steering import AT_CORNER, RESCALE_AT, STRAYED, TURNED, is_dip
from contin.linalg.vectors import dot, norm
from contin.machine import elementary
from contin.offers import offers

LANDED = 1e-9


class Telling(Protocol):
    """A linearisation from which stability and tests at the point that it leads to are read, not from the point."""

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        """See `Marchable.stability`."""


class Marchable(Correctable, Protocol):
    """What the Python march needs of a problem."""

    @property
    def angle_periods(self) -> Array: ...

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        """Test functions from index 2 on, the number of unstable eigenvalues, and the eigenvalues."""


def with_one_fixed(
    problem: Correctable, index: int, guess: Array, value: float, scale: Array, tolerance: float
) -> Array | None:
    """The point at which unknown `index` has this value, by Newton from the guess; None where that fails."""
    fixed = np.zeros(guess.size)
    fixed[index] = 1.0
    z0 = guess.copy()
    z0[index] = value
    found = correct(problem, z0, fixed, 0.0, np.zeros(guess.size), scale, tolerance)
    if isinstance(found, Failure):
        return None
    z = found.z.copy()
    z[index] = value
    return z


def null_vector(problem: Correctable, z: Array, scale: Array, border: Array, rounds: int) -> Array | None:
    """The unit tangent t, J t = 0: the solution of [J; b^T] t = e_last takes the place of the border b, `rounds` times.

    None where the equations are not finite or the bordered matrix is singular.
    """
    for _ in range(rounds):
        here = problem.linearisation(z, border / norm(border), scale)
        if here is None or here.sign == 0:
            return None
        border = here.solve(np.append(np.zeros(z.size - 1), 1.0))
    return np.asarray(border / norm(border))


def measure(problem: Marchable, found: Corrected, reference: float | None) -> Sample:
    """Tangent, tests and eigenvalues at a corrected point; without a reference the curve's own tests are 1."""
    n = len(found.z) - 1
    t = found.last.solve(np.append(np.zeros(n), 1.0))
    length = norm(t)
    t = t / length
    own = (1.0, 1.0) if reference is None else (t[-1], _determinant(found.last, length, reference))
    look: Marchable | Telling = cast(Telling, found.last) if offers(type(found.last), "stability") else problem
    tests, unstable, eigenvalues = look.stability(found.z)
    return Sample(found.z, t, np.concatenate([own, tests]), unstable, eigenvalues)


def _determinant(here: Linearisation, length: float, reference: float) -> float:
    """That of M with the unit tangent for a border, over exp(reference)."""
    exponent = here.log_determinant + elementary.log(length) - reference
    return float(here.sign * elementary.exp(min(max(exponent, -700.0), 700.0)))


def probe(
    problem: Marchable, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings,
    turns: bool = True,
) -> Sample | None:  # fmt: skip
    """`Problem.probe` in terms of linearisations; without `turns` tests of the curve itself are not computed."""
    found = place(problem, base, length, guess, frame, settings)
    return None if found is None else measure(problem, found, frame.reference if turns else None)


def place(
    problem: Marchable, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings
) -> Corrected | None:
    """Where `probe` looks, without its tests."""
    y = (guess - base.z) / frame.scale
    found = correct(problem, base.z, base.tangent, length, y, frame.scale, min(settings.tolerance, 1e-9))
    return None if isinstance(found, Failure) else found


def march(
    problem: Marchable, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
    bounds: tuple[float, float], settings: Settings, loop: Sample | None, again: Again | None = None,
    walled: InTwoParameters | None = None, decisions: Decisions = EQUILIBRIA,
) -> Chunk:  # fmt: skip
    """`Problem.march` in terms of linearisations; `again`: see `correct`; `walled` where a second parameter varies."""
    scale = frame.scale
    target_angle = np.radians(settings.max_angle) / 2.5
    evaluations = 1
    here = problem.linearisation(origin.z, origin.tangent, scale)
    reference = 0.0 if here is None else here.log_determinant
    rows: list[Sample] = [origin]
    lengths = [0.0]
    crossings: list[int] = []

    def chunk(stop: Stop, next_step: float, dipped: int = 0, detail: str = "") -> Chunk:
        width = max(len(r.eigenvalues) for r in rows)
        eigenvalues = np.full((len(rows), width), np.nan, complex)
        for k, r in enumerate(rows):
            eigenvalues[k, : len(r.eigenvalues)] = r.eigenvalues
        return Chunk(
            np.array([r.z for r in rows]), np.array([r.tangent for r in rows]), np.array([r.tests for r in rows]),
            np.array([r.unstable for r in rows]), eigenvalues, np.array(lengths), stop, next_step, reference, dipped,
            evaluations, detail, tuple(crossings),
        )  # fmt: skip

    if here is None:
        return chunk(Stop.NOT_FINITE, step)
    if here.sign == 0:
        return chunk(Stop.CORRECTOR, step)
    rows[0], reference = _first_row(problem, origin, here)
    h, h_previous = step, length if before is not None else 0.0
    old, nearest = before, here
    while len(rows) <= limit:
        last = rows[-1]
        taken = _step(
            problem, old, last, h_previous, h, scale, settings, reference, again, nearest, decisions, walled
        )
        evaluations += taken.evaluations
        h = taken.length
        if isinstance(taken, _Refused):
            return chunk(taken.stop, h)
        sample, found, corner = taken.sample, taken.found, taken.corner
        if taken.crossed:
            crossings.append(len(rows))
        rows.append(sample)
        lengths.append(h)
        angle = target_angle if corner else float(elementary.acos(min(taken.cosine, 1.0)))
        h_used, h = h, steering.next_step(
            h, angle, target_angle, found.first_correction, decisions.wanted, decisions.order, float(found.iterations),
            decisions.iterations, settings.min_step, min(settings.max_step, max(taken.most, settings.min_step)),
        )  # fmt: skip
        stop, dipped = _what_happened(
            problem, old, last, sample, h_previous, h_used, bounds, walled, loop, scale, corner, decisions.dips
        )
        if stop is not None:
            return chunk(stop, h, dipped)
        old, h_previous, nearest = last, h_used, found.last
    return chunk(Stop.LIMIT, h)


def _first_row(problem: Marchable, origin: Sample, here: Linearisation) -> tuple[Sample, float]:
    """Row 0 with the logarithm of a determinant that makes its own 1 or -1."""
    reference = here.log_determinant
    first = measure(problem, Corrected(origin.z, np.zeros(len(origin.z)), here, 0.0, 1), reference)
    if first.tests[1] != 0.0:
        reference += float(elementary.log(abs(first.tests[1])))
        first.tests[1] = np.sign(first.tests[1])
    return first, reference


@dataclass(frozen=True, eq=False)
class _Refused:
    """No step from the last row, however short."""

    stop: Stop
    length: float
    evaluations: int


@dataclass(frozen=True, eq=False)
class _Taken:
    """A step that is accepted; `corner`: the shortest that there is, although it turns too sharply.

    most : of the next step: the distance of another curve beside which this one turns off.  crossed : by another one.
    """

    sample: Sample
    found: Corrected
    cosine: float
    corner: bool
    length: float
    evaluations: int
    most: float = np.inf
    crossed: bool = False


def _step(
    problem: Marchable, old: Sample | None, last: Sample, h_previous: float, h: float, scale: Array, settings: Settings,
    reference: float, again: Again | None, nearest: Linearisation, decisions: Decisions,
    walled: InTwoParameters | None,
) -> _Taken | _Refused:  # fmt: skip
    """A step of length h, or of what is left of it where the corrector fails or the path turns too sharply."""
    look, asks = Verdict(None), walled is not None
    cos_max = elementary.cos(np.radians(settings.max_angle))
    curved = old is not None and h_previous > 0
    evaluations = blocks = 0
    while True:
        guess = _predicted(old, last, h_previous, h, scale, decisions)
        found = correct(
            problem, last.z, last.tangent, h, guess, scale, settings.newton_tolerance, again, again and nearest,
            decisions,
        )  # fmt: skip
        if not isinstance(found, Failure) and steering.leaves(norm(found.y), h, cos_max, settings.newton_tolerance):
            found = Failure.ELSEWHERE
        if isinstance(found, Failure):
            evaluations += 1
            if h <= settings.min_step:
                return _Refused(Stop.NOT_FINITE if found is Failure.NOT_FINITE else Stop.CORRECTOR, h, evaluations)
            h = max(0.5 * h, settings.min_step)
            continue
        evaluations += found.iterations
        if found.off > decisions.off:
            found = replace(found, last=nearest)  # its factors are let go of before others are made
            there = problem.linearisation(found.z, last.tangent, scale)
            if there is None:
                return _Refused(Stop.NOT_FINITE, h, evaluations)
            found = replace(found, last=there, off=0.0)
        sample = measure(problem, found, reference)
        cosine = dot(last.tangent, sample.tangent)
        if not np.isfinite(cosine):  # what a tangent is solved with fails there, where the residual does not
            if h <= settings.min_step:
                return _Refused(Stop.NOT_FINITE, h, evaluations)
            h = max(0.5 * h, settings.min_step)
            continue
        verdict = steering.judged(
            sample.tests, last.tests[None], 0, (old or last).tests, decisions.guarded, decisions.signed, cosine,
            cos_max, h, settings.min_step, h_previous if curved else 0.0, blocks < 8,
        )  # fmt: skip
        if verdict in (TURNED, STRAYED):
            blocks += verdict == STRAYED
            h = steering.shortened(verdict, h, settings.min_step)
            continue
        if verdict == AT_CORNER:
            return _Taken(sample, found, cosine, True, h, evaluations)
        if asks and _solved(found, nearest).sign * last.tests[1] < 0.0:
            look = _where_it_turns_off(problem, old, last, h_previous, h, scale, settings, found, decisions)
            asks = look.length is not None
            h = h if look.length is None else look.length
            if asks:
                continue
        landed = np.any(np.abs(sample.tests) < LANDED * np.abs(last.tests))
        if landed and blocks < 8 and h > settings.min_step:
            blocks = 8
            h = max(0.9 * h, settings.min_step)
            continue
        return _Taken(sample, found, cosine, False, h, evaluations, look.most, look.tells(decisions.told))


def _where_it_turns_off(
    problem: Marchable, old: Sample | None, last: Sample, h_previous: float, h: float, scale: Array, settings: Settings,
    found: Corrected, decisions: Decisions,
) -> Verdict:  # fmt: skip
    """`contin.continuation.turning_off.verdict_on` a step from `last` to what was found."""
    here = problem.linearisation(last.z, last.tangent, scale)
    if here is None:
        return Verdict(None)
    cos_max = elementary.cos(np.radians(settings.max_angle))

    def at(length: float, here: Linearisation = here) -> Solved | None:
        guess = _predicted(old, last, h_previous, length, scale, decisions)
        there = correct(problem, last.z, last.tangent, length, guess, scale, settings.newton_tolerance)
        if isinstance(there, Failure) or steering.leaves(norm(there.y), length, cos_max, settings.newton_tolerance):
            return None
        return _solved(there, here)

    origin = Solved(np.zeros_like(found.y), here.sign, here.log_determinant)
    return verdict_on(at, origin, _solved(found, here), h, settings.min_step)


def _solved(found: Corrected, origin: Linearisation) -> Solved:
    """A corrected point with its determinant, that of branch points over their mixed coefficient: `mixed_ratio`."""
    sign, log = found.last.sign, found.last.log_determinant
    if offers(type(found.last), "form"):
        before, here = cast(Forming, origin).form, cast(Forming, found.last).form
        ratio = 1.0 if before is None or here is None else float(mixed_ratio(before, here, 0))
        if ratio != 0.0:
            sign, log = float(np.sign(ratio)) * sign, log + float(elementary.log(abs(ratio)))
    return Solved(found.y, sign, log)


def _predicted(
    old: Sample | None, last: Sample, h_previous: float, h: float, scale: Array, decisions: Decisions
) -> Array:
    """The scaled way from the last row to a guess of the next one, h along the last tangent."""
    if old is None or not h_previous > 0:
        return np.asarray(h * last.tangent)
    if decisions.cubic:
        curve = cubic(last.tangent, (old.z - last.z) / scale, old.tangent)
        if curve is not None and h <= REACH * abs(curve.back):
            return curve.at(h)
    return np.asarray(h * last.tangent + 0.5 * h * h / h_previous * (last.tangent - old.tangent))


def _what_happened(
    problem: Marchable, old: Sample | None, last: Sample, sample: Sample, h_previous: float, h: float,
    bounds: tuple[float, float], walled: InTwoParameters | None, loop: Sample | None, scale: Array, corner: bool,
    dips: int,
) -> tuple[Stop | None, int]:  # fmt: skip
    if corner:
        return Stop.CORNER, 0
    periods = problem.angle_periods
    grows = periods == 0 if walled is None else walled.growing[:-1]
    walls = [(-1, *bounds)] if walled is None else walled.walls
    if any(not lowest <= sample.z[index] <= highest for index, lowest, highest in walls):
        return Stop.BOUND, 0
    if sample.unstable != last.unstable or steering.crossed(sample.tests, last.tests[None], 0):
        return Stop.EVENT, 0
    if old is not None and h_previous > 0:
        dipped = steering.dipping(sample.tests, last.tests[None], 0, old.tests, dips, h_previous, h)
        if dipped >= 0:
            return Stop.DIP, dipped
    if loop is not None:
        every = np.ones(len(scale))
        if steering.passes_start(sample.z, last.z, loop.z, loop.tangent, every, periods, scale, h):
            return Stop.LOOP, 0
    n = len(scale) - 1
    if np.any((np.abs(sample.z[:-1]) > RESCALE_AT * scale[:-1] / np.sqrt(n)) & grows):
        return Stop.RESCALE, 0
    return None, 0


def until_dip(
    chunk: Chunk, before: Sample | None, length: float, first: int,
    counts: Callable[[int, int], bool] = lambda row, test: True,
) -> Chunk:  # fmt: skip
    """The chunk up to the row after the first at which a test from `first` on dips, as a march that looks has it.

    For marches whose kernels do not look. length : of the step from `before` to row 0.  counts : whether a dip of a
    test at a row may hide something.
    """
    tests, lengths = chunk.tests, chunk.lengths
    start = 1
    if before is not None and before.tests.shape == tests.shape[1:] and length > 0.0:
        tests, lengths = np.vstack([before.tests, tests]), np.concatenate([[0.0, length], lengths[1:]])
        start = 0
    sizes = np.abs(tests[:, first:])
    lowest = (sizes[1:-1] < sizes[:-2]) & (sizes[1:-1] <= sizes[2:])  # of every dip
    for row, i in np.argwhere(lowest).tolist():
        row, i = row + 1, i + first
        here = row - 1 + start
        if is_dip(*tests[row - 1 : row + 2, i].tolist(), *lengths[row : row + 2].tolist()) and counts(here, i):
            return replace(chunk.cut(here + 2, Stop.DIP, float(chunk.lengths[here + 1])), dipped=i)
    return chunk
