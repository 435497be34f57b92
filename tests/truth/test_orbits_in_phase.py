"""Equal piecewise-smooth oscillators in phase cross their surfaces together: the labels depend on no rounding.

Two and three oscillators x'' + x = eps (own(x, x') + coupling), own with an escapement that jumps where x' = 0, coupled
by diffusion or through a platform on which they all push. Every family is followed with trajectories of several
accuracies and from starts that differ by rounding; labels are the same, to their errors. By diffusion the oscillators
lose their synchrony where a variation across has the multiplier 1: that is found here with scipy, an oscillator alone.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import contin
from contin.machine import elementary
from contin.model.model import Model

ACCURACIES = (1e-8, 1e-11, 1e-13)


@dataclass(frozen=True)
class Cells:
    """`count` oscillators; k is the coupling, `stiff` a fixed one of the positions."""

    count: int
    coupling: str
    seed: int

    def __str__(self) -> str:
        return f"{self.count} by {self.coupling}, seed {self.seed}"

    @property
    def numbers(self) -> tuple[float, ...]:
        """Gain, its saturation, damping, eps, stiffness."""
        random = np.random.default_rng(self.seed)
        low, high = (3.0, 0.8, 0.2, 0.02, -0.3), (5.0, 1.2, 0.5, 0.08, 0.3)
        return tuple(random.uniform(low, high).tolist())

    @property
    def model(self) -> Model:
        a, b, beta, eps, stiff = self.numbers
        cells = range(self.count)
        own = [f"(-{beta}*y{j} + ({a}*x{j}^3 - {b}*x{j}^5 if x{j}*y{j} > 0 else 0))" for j in cells]
        x, y = ("(" + " + ".join(f"{name}{j}" for j in cells) + ")" for name in "xy")
        equations = {}
        for i in cells:
            if self.coupling == "diffusion":
                pushed = f"k*({y} - {self.count}*y{i}) + ({stiff})*({x} - {self.count}*x{i})"
            else:
                pushed = f"{eps}*k*({' + '.join(own)}) - k*{x}"
            equations |= {f"x{i}": f"y{i}", f"y{i}": f"-x{i} + {eps}*({own[i]} + {pushed})"}
        states = {name: 2.3 if name[0] == "x" else 0.0 for name in equations}
        swap = {"x0": "x1", "y0": "y1", "x1": "x0", "y1": "y0"}
        turn = {f"{name}{j}": f"{name}{(j + 1) % self.count}" for name in "xy" for j in cells}
        return Model("cells", states=states, parameters={"k": self.start}, equations=equations,
                     symmetries={"swap": swap, "turn": turn})  # fmt: skip

    @property
    def start(self) -> float:
        return 0.3 if self.coupling == "diffusion" else 24.0 / self.count

    def family(self, accuracy: float, nudge: float = 0.0) -> Any:
        first = {"x0": 2.3 * (1.0 + nudge), "y0": -nudge}
        seed = contin.periodic_orbit(self.model, first).seed("k")
        seed = replace(seed, problem=seed.problem.precise(accuracy))
        box = (-1.0, 0.5) if self.coupling == "diffusion" else (2.0, 16.0)
        return contin.continuation(seed, "k", box)


def synchrony_lost(cells: Cells, type_: str, guess: float) -> float:
    """k, next to a guess, at which the variation across of an oscillator in step with the others has a multiplier 1.

    At an NS its two multipliers are a pair of modulus 1: their product is 1.
    """
    a, b, beta, eps, stiff = cells.numbers

    def field(t: float, v: Any, k: float, on: bool) -> Any:
        x, y = v[:2]
        gain, slope = (a * x**3 - b * x**5, 3 * a * x**2 - 5 * b * x**4) if on else (0.0, 0.0)
        turned = np.array([y, -x + eps * (-beta * y + gain)])
        matrix = np.array([[0.0, 1.0], [-1.0 + eps * (slope - cells.count * stiff), -eps * (beta + cells.count * k)]])
        return np.concatenate([turned, (matrix @ v[2:].reshape(2, 2)).ravel()])

    def half(amplitude: float, k: float) -> Any:
        """Half a turn from (amplitude, 0): y falls through x = 0, the escapement acts until y = 0."""
        v, t = np.concatenate([[amplitude, 0.0], np.eye(2).ravel()]), 0.0
        for on, which in ((False, 0), (True, 1)):
            meets = lambda t, v, k, on, i=which: v[i] if t > 1.0 or i == 0 else -1.0  # noqa: E731
            meets.terminal, options = True, {"method": "DOP853", "rtol": 1e-12, "atol": 1e-13}
            found = solve_ivp(field, (t, t + 5.0), v, events=meets, args=(k, on), **options)
            v, t = found.y[:, -1], found.t[-1]
        x = v[0]  # y crosses zero, and the push ends
        v[4:] *= -x / (-x + eps * (a * x**3 - b * x**5))
        return v

    change = lambda r: half(r, 0.0)[0] + r  # noqa: E731
    radii = np.linspace(3.2, 1.0, 23).tolist()  # from the outermost, which attracts
    outer = next(r for r, inner in pairwise(radii) if change(r) * change(inner) < 0.0)
    amplitude = brentq(change, outer - 0.1, outer, xtol=1e-13)

    def excess(k: float) -> float:
        matrix = half(amplitude, k)[2:].reshape(2, 2)
        if type_ == "NS":
            return float(elementary.square(np.linalg.det(matrix)) - 1.0)
        return float(np.linalg.det(matrix @ matrix - np.eye(2)))

    return float(brentq(excess, guess - 0.03, guess + 0.03, xtol=1e-13))


def labels_of(cells: Cells) -> list[list[Any]]:
    runs = [cells.family(accuracy) for accuracy in ACCURACIES]
    runs += [cells.family(1e-11, nudge) for nudge in (1e-15, -3e-15)]
    for run in runs:
        assert not run.unexplained, (str(cells), run.notes)
        assert {end.reason for end in run.ends} == {"bound"}
    return [list(run.points) for run in runs]


SHORT = [Cells(3, "diffusion", 1)]
LONG = [
    pytest.param(cells, marks=pytest.mark.long)
    for cells in (Cells(n, c, s) for n in (2, 3) for c in ("diffusion", "platform") for s in range(8))
    if cells not in SHORT
]


@pytest.mark.parametrize("cells", [*SHORT, *LONG], ids=str)
@pytest.mark.seldom
def test_labels_of_orbits_in_phase_depend_on_no_tolerance_and_no_rounding(cells):
    first, *others = labels_of(cells)
    for points in others:
        assert [p.label for p in points] == [p.label for p in first]
        for one, other in zip(points, first, strict=True):
            assert abs(one.z[-1] - other.z[-1]) <= one.error + other.error
            assert one.error < 1e-8
            assert one.vectors.get("kernel", 1) == cells.count - 1
    if cells.coupling == "diffusion":
        for point in first:
            assert point.z[-1] == pytest.approx(synchrony_lost(cells, point.type, point.z[-1]), abs=point.error + 1e-9)


@pytest.mark.seldom
def test_two_against_one_branches_from_three_in_phase():
    """The multiplier that passes 1 is double, and a family keeps the exchange of two of the three."""
    family = Cells(3, "platform", 0).family(1e-11)
    note = next(note for note in family.notes if "families begin" in note)
    other = contin.continuation(family["BPC1"].switch("k"), "k", (2.0, 16.0), settings={"steps": 6})
    gaps = [np.abs(other.columns[f"x{i}.max"] - other.columns[f"x{j}.max"]) for i, j in ((0, 1), (1, 2), (0, 2))]
    equal, *apart = sorted(gaps, key=lambda gap: gap[-1])
    assert equal.max() < 1e-9
    assert all(gap[-1] > 1e-4 for gap in apart)
    upwards = np.argsort(other.columns["k"])  # which of the two halves comes first is the sign of a null vector
    k, gap = other.columns["k"][upwards], apart[0][upwards]
    below, above = (float(word) for word in re.findall(r"\d+\.\d+", note)[:2])  # the halves begin apart
    for rows, place in ((slice(None, 7), below), (slice(8, None), above)):
        nearest = np.argsort(gap[rows])[:3]
        towards = np.polyval(np.polyfit(gap[rows][nearest], k[rows][nearest], 2), 0.0)
        assert towards == pytest.approx(place, abs=2e-3)
