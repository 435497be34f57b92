"""Solutions of equations that vanish (kind: algebraic), as a continuation problem: no time, hence no stability.

Eigenvalues of the Jacobian mean nothing here: they depend on the order and the signs in which the equations are
written. Folds and branch points do not. So the sample's tests are those of the fold and of the determinant alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import Outcome, Verified
from contin.continuation.sample import Chunk, Frame, Sample, Stop
from contin.continuation.settings import Settings
from contin.kernels.steering import is_dip
from contin.problems.equilibria.equilibrium import EquilibriumProblem

CONSIDERED = 2  # test functions: dp/ds and the determinant
NONE = np.zeros(0, complex)


@dataclass(frozen=True, eq=False)
class AlgebraicProblem(EquilibriumProblem):
    """f(u, p) = 0 with one parameter varying, whatever the eigenvalues of f_u are."""

    @cached_property
    def kind(self) -> str:
        return "algebraic"

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        chunk = super().march(origin, before, length, frame, step, limit, bounds, settings, loop)
        tests = chunk.tests.copy()
        tests[:, CONSIDERED:] = 1.0
        crossed = len(chunk) > 1 and bool(np.any(tests[-1] * tests[-2] <= 0.0))
        stop, dipped = chunk.stop, chunk.dipped
        if (stop is Stop.EVENT and not crossed) or (stop is Stop.DIP and dipped >= CONSIDERED):
            dipped = _dip(chunk, before, length)  # what eigenvalues stop a march for may be two zeros of these
            stop = Stop.LIMIT if dipped < 0 else Stop.DIP
        count = len(chunk)
        still, none = np.zeros(count, np.int64), np.zeros((count, 0), complex)
        return replace(chunk, tests=tests, unstable=still, eigenvalues=none, stop=stop, dipped=dipped)

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        return _without_stability(super().probe(base, length, guess, frame, settings))

    def probes(
        self, base: Sample, lengths: Array, guesses: Array, frame: Frame, settings: Settings
    ) -> Sequence[Sample | None]:
        return [_without_stability(found) for found in super().probes(base, lengths, guesses, frame, settings)]

    def points_between(
        self, base: Sample, ends: tuple[Sample, Sample], lengths: tuple[float, float], fractions: Sequence[float],
        frame: Frame, settings: Settings,
    ) -> Sequence[Sample | None] | None:  # fmt: skip
        found = super().points_between(base, ends, lengths, fractions, frame, settings)
        return None if found is None else [_without_stability(sample) for sample in found]

    def tests_between(
        self, base: Sample, ends: tuple[Sample, Sample], lengths: tuple[float, float], fractions: Sequence[float],
        frame: Frame, settings: Settings,
    ) -> tuple[Array, Sequence[int]] | None:  # fmt: skip
        found = super().tests_between(base, ends, lengths, fractions, frame, settings)
        if found is None:
            return None
        tests, counts = found
        tests[:, CONSIDERED:] = 1.0
        return tests, [min(count, 0) for count in counts]

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        fold, determinant = (bool(x) for x in a.tests[:CONSIDERED] * b.tests[:CONSIDERED] < 0.0)
        if determinant:
            return ("BP",)
        return ("LP",) if fold else ()

    def verify(self, type_: str, near: Sample, frame: Frame) -> Outcome:
        return _still(super().verify(type_, near, frame))

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
        found = [_still(item) for item in super().verify_compound(a, b, frame)]
        return [item for item in found if not isinstance(item, Verified) or item.type in ("LP", "BP")]


def _dip(chunk: Chunk, before: Sample | None, length: float) -> int:
    """The test that comes close to zero at the last row but one without changing its sign; -1: none does.

    before : the sample before the chunk, at this length from its first row.
    """
    if len(chunk) < 2 or (len(chunk) == 2 and before is None):
        return -1
    tests, lengths = chunk.tests[-3:], chunk.lengths[-2:]
    if len(chunk) == 2:
        assert before is not None
        tests, lengths = np.vstack([before.tests, chunk.tests]), np.array([length, chunk.lengths[-1]])
    for k in range(CONSIDERED):
        if is_dip(*tests[:, k], *lengths):
            return k
    return -1


def _without_stability(found: Sample | None) -> Sample | None:
    if found is None:
        return None
    tests = np.append(found.tests[:CONSIDERED], np.ones(len(found.tests) - CONSIDERED))
    return replace(found, tests=tests, unstable=0, eigenvalues=NONE)


def _still(found: Outcome) -> Outcome:
    """Without eigenvalues, and without the word for whose stability the new branch takes over."""
    if not isinstance(found, Verified):
        return found
    form = {k: v for k, v in found.normal_form.items() if k != "criticality" or v == "degenerate"}
    return replace(found, eigenvalues=NONE, unstable=0, normal_form=form)
