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
from contin.continuation.sample import Chunk, Frame, Sample, opposite
from contin.continuation.settings import Settings
from contin.kernels.algebraic import BY_PLACE
from contin.problems.equilibria.equilibrium import EquilibriumProblem

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
        return replace(chunk, eigenvalues=np.zeros((len(chunk), 0), complex))

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
        tests[:, BY_PLACE:] = 1.0
        return tests, [min(count, 0) for count in counts]

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        fold, determinant = (bool(x) for x in opposite(a.tests[:BY_PLACE], b.tests[:BY_PLACE]))
        if determinant:
            return ("BP",)
        return ("LP",) if fold else ()

    def verify(self, type_: str, near: Sample, frame: Frame) -> Outcome:
        return _still(super().verify(type_, near, frame))

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
        found = [_still(item) for item in super().verify_compound(a, b, frame)]
        return [item for item in found if not isinstance(item, Verified) or item.type in ("LP", "BP")]


def _without_stability(found: Sample | None) -> Sample | None:
    if found is None:
        return None
    tests = np.append(found.tests[:BY_PLACE], np.ones(len(found.tests) - BY_PLACE))
    return replace(found, tests=tests, unstable=0, eigenvalues=NONE)


def _still(found: Outcome) -> Outcome:
    """Without eigenvalues, and without the word for whose stability the new branch takes over."""
    if not isinstance(found, Verified):
        return found
    form = {k: v for k, v in found.normal_form.items() if k != "criticality" or v == "degenerate"}
    return replace(found, eigenvalues=NONE, unstable=0, normal_form=form)
