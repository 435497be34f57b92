"""How far the solution that a start from samples has led to is from them: Newton's method promises nothing.

Samples of two pulses may lead to one of them, those of a guess to a solution of another shape. Compared are values at
the same times; of orbits and connections, whose time has no origin, after the shift that brings them closest.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from contin.abi import Array
from contin.systems.described import states_in_words

FAR: Final = 0.5  # root mean square of the difference, as a part of the larger one of both extents: another solution
PLACES: Final = 512
CONSTANT: Final = 1e-3  # of a state's largest value: less change than this is none
REMNANT: Final = 1e-6  # of the largest state's: what samples hold at zero and a solution to no more is its mesh's error


def away(names: Sequence[str], samples: Array, solution: Array, shifted: str = "") -> str:
    """A note where two curves (K, n), at K even times, are not near each other; else empty.

    shifted : '' where times are what they are, 'closed' of orbits, 'open' of curves that rest at both ends.
    """
    low, high = samples.min(axis=0), samples.max(axis=0)
    least, most = solution.min(axis=0), solution.max(axis=0)
    size = np.maximum(np.maximum(np.abs(samples), np.abs(solution)).max(axis=0), np.finfo(float).tiny)
    extent = np.maximum(high - low, most - least)
    size = np.where((high == low) & (low == 0.0), np.maximum(size, REMNANT * size.max()), size)
    moving = extent > CONSTANT * size
    centre = np.where(moving, 0.5 * (low + high), 0.0)
    a, b = ((u - centre) / np.where(moving, extent, size) for u in (samples, solution))
    spread = [np.sqrt(np.mean((u - u.mean(axis=0)) ** 2)) if shifted else np.sqrt(np.mean(u * u)) for u in (a, b)]
    off = _distance(a, b, shifted) / max(*spread, float(np.finfo(float).tiny))
    if not off > FAR:
        return ""
    there = states_in_words(names, solution, lambda k: f"in [{least[k]:.4g}, {most[k]:.4g}]")
    here = states_in_words(names, samples, lambda k: f"in [{low[k]:.4g}, {high[k]:.4g}]")
    return (
        f"the solution that the samples led to is not near them: they differ by {off:.0%} of their variation (root "
        f"mean square). It has {there}; the samples have {here}"
    )


def on_even_times(times: Array, values: Array, span: float | None = None) -> Array:
    """Values (K, n) at `PLACES` even times from the first one on, over a span; the last ones remain beyond theirs."""
    wanted = times[0] + np.linspace(0.0, times[-1] - times[0] if span is None else span, PLACES)
    return np.column_stack([np.interp(wanted, times, v) for v in values.T])


def _distance(a: Array, b: Array, shifted: str) -> float:
    """Root of the mean square of a - b (K, n), the least over all shifts."""
    if not shifted:
        return float(np.sqrt(np.mean((a - b) ** 2)))
    count = a.size
    if shifted == "open":  # at rest before and after
        k = len(a)
        a, b = (np.vstack([np.tile(u[0], (k // 2, 1)), u, np.tile(u[-1], (k // 2, 1))]) for u in (a, b))
    spectra = [np.fft.rfft(u, axis=0) for u in (a, b)]
    products = np.fft.irfft(spectra[0] * np.conj(spectra[1]), len(a), axis=0).sum(axis=1)
    return float(np.sqrt(max(np.sum(a * a) + np.sum(b * b) - 2.0 * products.max(), 0.0) / count))
