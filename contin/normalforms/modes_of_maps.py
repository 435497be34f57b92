"""Centre manifolds of maps with several critical multipliers, 1, -1 and pairs exp(+-i theta), and their resonances.

Products of powers of the multipliers equal one of them for every theta (|w1|^2 w1), which makes the terms of the normal
form, or for single values of the angles (conj(w1)^2 at theta = 2 pi/3). Near such a value a homological equation is
nearly singular: with a product of two coordinates, cubic coefficients have a pole there; with three, a further term
belongs in the form.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Final

import numpy as np

from contin.machine import elementary
from contin.normalforms.homological import CentreManifold
from contin.normalforms.hopf import conjugate
from contin.normalforms.jet import Jet
from contin.normalforms.linear import EigenPair, eigenvalues, null_pair
from contin.normalforms.result import NotThisTypeError

NEAR: Final = 1e-3  # distance of a product of multipliers from one of them at which the form without its term is no use
ORDER: Final = 3

Turn = tuple[int, ...]  # of a coordinate: half turns, then turns by each angle


class NearResonantError(np.linalg.LinAlgError):
    """A homological equation of second order is nearly singular."""


@dataclass(frozen=True, eq=False)
class Modes:
    """A centre manifold with coordinates for `real` multipliers (1, -1), then pairs (w, conj w) for each angle.

    resonance : the one of third order that the angles are near to, in words.
    """

    manifold: CentreManifold
    angles: tuple[float, ...]
    resonance: str = ""


def modes(jet: Jet, real: Sequence[float], pairs: int) -> Modes:
    """The centre manifold; `NearResonantError` near a resonance of second order."""
    angles = critical_angles(jet, pairs)
    known: list[EigenPair] = [null_pair(jet.A - value * np.eye(jet.n), value, jet.scale) for value in real]
    turns: list[Turn] = [(int(value < 0.0), *(0,) * pairs) for value in real]
    for k, theta in enumerate(angles):
        value = complex(elementary.exp(1j * theta))
        pair = null_pair(jet.A - value * np.eye(jet.n), value, jet.scale)
        known += [pair, conjugate(pair)]
        turns += [(0, *(sign if k == i else 0 for i in range(pairs))) for sign in (1, -1)]
    found = sorted(_near(turns, angles), key=lambda one: one[0])
    if found and found[0][0] < ORDER:
        raise NearResonantError(f"near-resonant: {found[0][1]} to {found[0][2]:.1e}")
    return Modes(CentreManifold(jet, known), angles, found[0][1] if found else "")


def critical_angles(jet: Jet, pairs: int) -> tuple[float, ...]:
    """Angles of the complex pairs of multipliers nearest to the unit circle, the largest first."""
    upper = [value for value in eigenvalues(jet.A) if value.imag > 0.0]
    if len(upper) < pairs:
        raise NotThisTypeError(f"there are fewer than {pairs} pairs of complex multipliers")
    nearest = sorted(upper, key=lambda value: abs(abs(value) - 1.0))[:pairs]
    return tuple(sorted((float(elementary.angle(value)) for value in nearest), reverse=True))


def _near(turns: Sequence[Turn], angles: tuple[float, ...]) -> Iterator[tuple[int, str, float]]:
    """(order, in words, distance) of the resonances that the angles are near to."""
    for powers in product(range(ORDER + 1), repeat=len(turns)):
        order = sum(powers)
        if not 1 <= order <= ORDER:
            continue
        whole = np.array(powers) @ np.array(turns)
        for own in turns:
            halves, *times = (whole - own).tolist()
            if not any(times):
                continue  # a term for every angle, or never one
            distance = abs(complex(elementary.exp(1j * (np.pi * halves + np.dot(times, angles)))) - 1.0)
            if distance <= NEAR:
                yield order, _words(times, angles), distance


def _words(times: Sequence[int], angles: tuple[float, ...]) -> str:
    """As `3 theta = 2 pi`."""
    first = next(k for k in times if k)
    times = [k if first > 0 else -k for k in times]
    names = ("theta",) if len(angles) == 1 else tuple(f"theta{i + 1}" for i in range(len(angles)))
    terms = [(k, name) for k, name in zip(times, names, strict=True) if k]
    text = " ".join(f"{'-' if k < 0 else '+'} {'' if abs(k) == 1 else f'{abs(k)} '}{name}" for k, name in terms)
    halves = round(float(np.dot(times, angles)) / np.pi)
    right = "0" if halves == 0 else f"{'-' if halves < 0 else ''}{'' if abs(halves) == 1 else f'{abs(halves)} '}pi"
    return f"{text.removeprefix('+ ')} = {right}"
