"""How well coefficients are known where derivatives have rounding errors, which eigenvectors and solutions amplify.

An entry of a derivative is a sum of terms, each rounded, at states that are rounded. The form is computed again with
entries that are off by as much, in fixed patterns of signs. Sums of moduli (`TRUST`) do not see that: terms that cancel
with the exact eigenvectors do not with slightly other ones.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Final

import numpy as np

from contin.abi import Vector
from contin.normalforms.jet import SPREAD, DerivativeJet, Disturbed, Jet, Real, along_units, contracted, otherwise
from contin.normalforms.result import NO_FORM, NormalForm

PATTERNS: Final = 3
ROUNDING: Final = 8.0 * float(np.finfo(float).eps)  # relative, of an entry, which is itself a sum
SAFETY: Final = 6.0  # times the largest of a few samples


def rounding_errors(
    form: NormalForm, form_at: Callable[[Jet], NormalForm], jet: Jet
) -> dict[str, float]:
    """By how much the coefficients of form_at(jet) = `form` may be off: the real ones, and complex ones with an error.

    Those that no sample has are left out.
    """
    found: dict[str, float] = {}
    for rounded in off_by_rounding(jet):
        try:
            other = form_at(rounded).coefficients
        except NO_FORM:  # as for a point more degenerate than its type; the errors it has stand
            continue
        for key, value in form.coefficients.items():
            change = change_of(value, other.get(key)) if isinstance(value, float) or key in form.errors else None
            if change is not None:
                found[key] = max(found.get(key, 0.0), SAFETY * change)
    return found


def difference_errors(form: NormalForm, form_at: Callable[[Jet], NormalForm], jet: Jet) -> dict[str, float]:
    """By how much the coefficients of form_at(jet) = `form` change with other differences; {} of exact derivatives."""
    found: dict[str, float] = {}
    for differenced in otherwise(jet):
        try:
            other = form_at(differenced).coefficients
        except NO_FORM:  # as for a point more degenerate than its type; the errors it has stand
            continue
        for key in form.errors:
            change = change_of(form.coefficients.get(key), other.get(key))
            if change is not None:
                found[key] = max(found.get(key, 0.0), SPREAD * change)
    return found


def off_by_rounding(jet: Jet) -> Iterator[Jet]:
    """The jet with other rounding errors: those that its system makes of its own, where it amplifies them."""
    if isinstance(jet, DerivativeJet) and jet.rounded is not None:
        yield from jet.rounded()
        return
    for number, pattern in enumerate(_patterns(jet.n)):
        yield RoundedJet(jet, pattern, number)


@dataclass(frozen=True, eq=False)
class RoundedJet(Disturbed):
    """A jet whose entries are off by rounding errors, with a pattern (n, n) of signs.

    Where the entries of a form are not at hand, its directions are off instead.
    """

    jet: Jet
    pattern: Real
    number: int  # of the pattern
    _terms: dict[int, Real | None] = field(default_factory=dict, repr=False)

    def _signs(self, shape: tuple[int, ...]) -> Real:
        return np.random.default_rng(self.number).choice([-1.0, 1.0], shape)

    @cached_property
    def A(self) -> Real:
        """That of a point whose states are off by rounding, too: an entry that vanishes with them is that only."""
        off = np.zeros(self.n + self.parameters)
        if self.jet.scale is not None:
            off[: self.n] = ROUNDING * self.jet.scale * self.pattern[0]
        moved = along_units(self.jet, off)[: self.n].T if off.any() else 0.0
        return np.asarray(self.jet.A * (1.0 + ROUNDING * self.pattern) + np.where(np.isfinite(moved), moved, 0.0))

    def form(self, *directions: Vector) -> Vector:
        order = len(directions)
        if order not in self._terms:
            terms = self.jet.terms(order) if isinstance(self.jet, DerivativeJet) else None
            self._terms[order] = None if terms is None else terms * (1.0 + ROUNDING * self._signs(terms.shape))
        known = self._terms[order]
        if known is not None:
            return contracted(known, directions)
        factors = np.ones((len(directions), self.n + self.parameters))
        for k, factor in enumerate(factors):
            factor[: self.n] += ROUNDING * self.pattern[k % self.n]
        return self.jet.form(*(d * factor for d, factor in zip(directions, factors, strict=True)))


def change_of(value: object, other: object) -> float | None:
    """The distance of two real coefficients, or complex ones as [re, im]; None of what is no number."""
    if isinstance(value, float) and isinstance(other, float):
        return apart(value, other)
    if isinstance(value, list) and isinstance(other, list) and len(value) == len(other) == 2:
        return apart(complex(*value), complex(*other))
    return None


def apart(value: complex, other: complex) -> float:
    """The distance of two coefficients whose sign depends on that of an eigenvector."""
    return min(abs(other - value), abs(other + value))


@lru_cache(maxsize=64)
def _patterns(n: int) -> tuple[Real, ...]:
    random = np.random.default_rng(1)
    return tuple(random.choice([-1.0, 1.0], (n, n)) for _ in range(PATTERNS))
