"""What a circle says of its torus: extremes and norms of the states on it, and how well it solves its equations.

Between the nodes the equations are not asked for: phi(u(s)) - u(s + rho) there, in units of the circle's size, says how
well they are solved. A circle that turns slowly answers it with an error that is larger by 1/|exp(2 pi i rho) - 1|.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from contin.abi import Array
from contin.errors import NoSolutionError
from contin.machine import elementary
from contin.tori import fourier
from contin.tori.equations import Circle, Metric
from contin.tori.strobe import Strobe

FEWEST: Final = 49  # points of the circle from which trajectories are looked at
CLOSER: Final = 8  # so many times more points by interpolation
TIMES: Final = 128  # in a return


@dataclass(frozen=True, eq=False)
class Look:
    """(n,) least, greatest, root mean square over the torus (its natural measure); relative error of the circle."""

    least: Array
    greatest: Array
    norm: Array
    error: float


def residual_between(strobe: Strobe, metric: Metric, circle: Circle) -> float:
    """Largest residual of phi(u(s)) = u(s + rho) midway between the nodes, relative to the circle's size."""
    places = fourier.nodes(circle.count) + 0.5 / circle.count
    points = fourier.at(circle.count, places) @ circle.values
    aims = fourier.at(circle.count, places + circle.rho) @ circle.values
    images = np.array([strobe.image(u, circle.time, circle.value) for u in points])
    size = float(np.abs(circle.deviation / metric.sizes).max())
    if size == 0.0:
        return 0.0
    return float(np.abs(strobe.difference(images, aims) / metric.sizes).max()) / size


def error_of(circle: Circle, residual: float) -> float:
    """Relative error of a circle whose equations hold up to the residual."""
    return residual * max(1.0, 0.5 / max(abs(float(elementary.sin(np.pi * circle.rho))), np.finfo(float).tiny))


def look(strobe: Strobe, metric: Metric, circle: Circle) -> Look:
    """Over a net of points of the torus: trajectories from many points of the circle, through one return."""
    count = max(circle.count, FEWEST)
    starts = circle.resampled(count).values if count > circle.count else circle.values
    error = error_of(circle, residual_between(strobe, metric, circle))
    if strobe.is_map:
        nets = strobe.circles(circle.resampled(CLOSER * count).values, circle.value)[:, :, None, :]
        least, greatest = (np.max([_peaks(sign * net) for net in nets], axis=0) for sign in (-1.0, 1.0))
        return Look(-least, greatest, np.sqrt(np.mean(nets * nets, axis=(0, 1, 2))), error)
    step = circle.time / TIMES
    times = np.asarray(
        step * np.arange(TIMES + 2), dtype=float
    )  # a little further, so that every inner time has two neighbours
    net = np.array([strobe.path(u, float(times[-1]), circle.value, times)[0] for u in starts])
    if net.shape[1] != len(times):
        raise NoSolutionError("a trajectory on the torus ends early")
    inner = net[:, :TIMES]
    closer = np.tensordot(fourier.at(count, fourier.nodes(CLOSER * count)), net, axes=1)
    return Look(-_peaks(-closer), _peaks(closer), np.sqrt(np.mean(inner * inner, axis=(0, 1))), error)


def _peaks(net: Array) -> Array:
    """The greatest values (n,) of a net (points, times, n), closed over the points: a parabola through 3 x 3 of it."""
    count, times, n = net.shape
    peaks = np.empty(n)
    for i in range(n):
        inner = net[:, 1:-1, i] if times > 2 else net[:, :, i]
        j, k = np.unravel_index(int(np.argmax(inner)), inner.shape)
        k += times > 2
        rows = [(j - 1) % count, j, (j + 1) % count]
        patch = net[rows][:, k - 1 : k + 2, i] if times > 2 else net[rows][:, [k], i]
        peaks[i] = _top(patch)
    return peaks


def _top(patch: Array) -> float:
    """The greatest value of the parabola through (3, 3) or (3, 1) values with the greatest in the middle."""
    if patch.shape[1] == 1:
        slope, bend = 0.5 * (patch[2] - patch[0]), patch[2] - 2.0 * patch[1] + patch[0]
        return float(patch[1, 0] - 0.5 * slope[0] * slope[0] / bend[0]) if bend[0] < 0.0 else float(patch[1, 0])
    middle = patch[1, 1]
    gradient = 0.5 * np.array([patch[2, 1] - patch[0, 1], patch[1, 2] - patch[1, 0]])
    mixed = 0.25 * (patch[2, 2] - patch[2, 0] - patch[0, 2] + patch[0, 0])
    first, second = patch[2, 1] - 2.0 * middle + patch[0, 1], patch[1, 2] - 2.0 * middle + patch[1, 0]
    bends, axes = np.linalg.eigh(np.array([[first, mixed], [mixed, second]]))
    slopes = axes.T @ gradient
    inside = (bends < 0.0) & (np.abs(slopes) < np.abs(bends))  # the top lies within a step of the net
    return float(middle - 0.5 * np.sum(slopes[inside] * slopes[inside] / bends[inside]))
