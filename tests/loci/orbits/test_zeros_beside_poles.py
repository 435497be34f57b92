"""Re d of a torus changes its sign next to poles: on a curve that passes R2, goes among real pairs, and comes back.

On the curve of Neimark-Sacker points of Lorenz' 84 model with a fourth mode, from its HH point to the mirror image of
that, CH lies at F = 2.57027, R2 at 2.57091 and 2.57643: one step led over both, and values before and after were alike.
"""

import math
from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np

from contin.continuation.sample import Chunk, Stop
from contin.loci.orbits import criticality


@dataclass(frozen=True)
class Curve:
    """s = z[-1]: cos(theta) + 1 = (s - .4)(s - .6), Re d = (s - .35)(s - .5)/((s - .4)(s - .6)): 1 far away."""

    type: str = "NS"
    critical: dict = field(default_factory=dict)

    def further(self, z):
        return (z[-1] - 0.4) * (z[-1] - 0.6) - 1.0

    def profile(self, z):
        return SimpleNamespace(period=1.0)

    def critical_coefficient(self, z, scale):
        s = float(z[-1])
        return (s - 0.35) * (s - 0.5) / ((s - 0.4) * (s - 0.6)), 1.0


def chunk(s: np.ndarray) -> Chunk:
    tests = np.full((len(s), 10), np.nan)
    tests[:, :9] = 1.0
    tests[:, 6] = (s - 0.4) * (s - 0.6)
    z = np.stack([np.zeros_like(s), s], axis=1)
    lengths, unstable, values = np.append(0.0, np.diff(s)), np.zeros(len(s), int), np.zeros((len(s), 0), complex)
    return Chunk(z, np.zeros_like(z), tests, unstable, values, lengths, Stop.LIMIT, 0.1, 1.0, 0, 0)


def test_a_zero_before_two_poles_in_one_step_cuts_the_chunk():
    """Between s = .39 and .61 lie both poles; Re d is .7 at the first row, 1 to 1.4 in the middle and at the last."""
    s = np.concatenate([[0.0, 0.1, 0.2, 0.3, 0.39, 0.61, 0.7], np.linspace(1.0, 3.0, 20)])
    found = criticality.cut_at_change(Curve(), chunk(s), np.ones(2))
    assert found.stop is Stop.EVENT
    assert found.z[-2:, -1].tolist() == [0.3, 0.39]
    assert found.tests[-2, 9] * found.tests[-1, 9] < 0.0


def test_rows_without_poles_beside_them_cost_no_more():
    asked = []

    class Counting(Curve):
        def critical_coefficient(self, z, scale):
            asked.append(float(z[-1]))
            return 1.0, 1.0

    far = chunk(np.linspace(0.61, 1.0, 9))
    criticality.cut_at_change(Counting(), far, np.ones(2))
    assert len(asked) <= 3


def test_the_other_arm_says_nothing_of_a_coefficient_that_dips_below_zero():
    """c = 1 - 2 exp(-(2 s - 3)^2) is 1 at the start, on the left, and at the end on the right."""

    class Dipping(Curve):
        def critical_coefficient(self, z, scale):
            return 1.0 - 2.0 * math.exp(-((2.0 * float(z[-1]) - 3.0) ** 2)), 1.0

    curve = Dipping(type="PD")
    criticality.cut_at_change(curve, chunk(np.linspace(0.0, -1.0, 11)), np.ones(2))
    found = criticality.cut_at_change(curve, chunk(np.linspace(0.0, 3.0, 31)), np.ones(2))
    assert found.stop is Stop.EVENT
    assert found.tests[-2, 5] * found.tests[-1, 5] < 0.0
