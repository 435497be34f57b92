"""Coefficients of points of codimension two of cycles by shooting: those of the return map.

They are those of `contin.problems.orbits.normal_forms.codimension_two`, from the derivatives of `ReturnMap`, which are
differences: with two steps, whose distance is one part of the errors, and the noise of the trajectories another.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Vector
from contin.continuation.outcome import Verified
from contin.normalforms.jet import Disturbed, Jet, Real
from contin.normalforms.linear import normalise, singular_vectors
from contin.normalforms.result import NO_FORM
from contin.problems.no_derivatives import NoDerivatives
from contin.problems.orbits.normal_forms.of_return_maps import MeasuredMap, coefficients_of
from contin.problems.shooting.normal_form import length_across_fold
from contin.problems.shooting.return_map import HIGHEST, ReturnMap, lengths_of_steps
from contin.special.table import special_type

if TYPE_CHECKING:
    from contin.abi import Array
    from contin.problems.shooting.shot_family import ShotFamily

SIGNS: Final = 2  # patterns of signs in which the trajectories' noise is added


def has_coefficients(type_: str) -> bool:
    """Whether points of this type have coefficients up to the order of the differences."""
    row = special_type(type_)
    return bool(row.powers) and row.order <= HIGHEST


def with_coefficients(point: Verified, theta: float, problem: ShotFamily, z: Array, sizes: Array) -> Verified:
    """The point with coefficients and their errors, or the remark why they could not be computed.

    theta : the angle of the critical multiplier.  z : the orbit in the problem's unknowns.
    """
    returns = ReturnMap(problem, z, lengths_of_steps(problem, z, sizes))
    try:
        maps = _measured(returns, 1), _measured(returns, 2)
        form = coefficients_of(point.type, theta, maps, lambda jet: _with_noise(jet, returns))
    except (NoDerivatives, *NO_FORM) as reason:
        return replace(point, remark=f"{point.type}: its normal form could not be computed ({reason})")
    return replace(point, normal_form=form)


def _measured(returns: ReturnMap, factor: int) -> MeasuredMap:
    def length(rho: complex, jet: Jet) -> float:
        real = abs(rho.imag) < 8.0 * np.finfo(float).eps
        value = float(np.sign(rho.real)) if real else rho
        q = normalise(singular_vectors(jet.A - value * np.eye(jet.n), 1, jet.scale)[0][:, 0])
        return length_across_fold(returns, q.real) if value == 1.0 else float(np.sqrt(returns.unit(q)))

    return MeasuredMap(returns.jet(factor), returns.nodes.period, length)


def _with_noise(jet: Jet, returns: ReturnMap) -> Sequence[Jet]:
    """The jet with the errors that differences have from trajectories."""
    return [NoisyJet(jet, returns.noise_of, number) for number in range(SIGNS)]


@dataclass(frozen=True, eq=False)
class NoisyJet(Disturbed):
    """A jet whose derivatives are off by the noise of their order, in a pattern of signs."""

    jet: Jet
    noise: Callable[[int], float]
    number: int

    @cached_property
    def _patterns(self) -> tuple[Real, Real]:
        random = np.random.default_rng(self.number)
        return random.choice([-1.0, 1.0], self.n), random.choice([-1.0, 1.0], self.n)

    @property
    def A(self) -> Real:
        return self.jet.A

    def form(self, *directions: Vector) -> Vector:
        signs, weights = self._patterns
        off = self.noise(len(directions)) * np.prod([weights @ d for d in directions]) / np.sqrt(self.n)
        return np.asarray(self.jet.form(*directions) + off * signs)
