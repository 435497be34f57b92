"""The series of the homoclinic orbit at a Bogdanov-Takens point, beside orbits that are solved for."""

import numpy as np

import contin
from contin.lowering.system import compile_system
from contin.normalforms.homoclinic import bogdanov_takens_unfolding
from contin.normalforms.homoclinic_series import homoclinic_series
from contin.normalforms.sources import compiled_jet

MODEL = contin.Model(
    "unfolded", states={"x": 0, "y": 0}, parameters={"p": 0, "q": 0},
    equations={"x": "y", "y": "p + q*y + 0.9*x^2 - 0.7*x*y + 0.5*x^3 + 0.3*x^2*y + 0.4*x*q + 0.2*y^2"},
)  # fmt: skip


def test_predicted_parameters_and_orbits_are_right_to_the_fifth_order():
    """p solved for at the q predicted: off by O(eps^6), as is q's own error times the curve's slope."""
    system = compile_system(MODEL)
    jet = compiled_jet(system, np.zeros(2), np.zeros(2), (0, 1), "flow", np.ones(2))
    series = homoclinic_series(jet, bogdanov_takens_unfolding(jet))
    sizes, off, apart = np.array([0.25, 0.2, 0.15]), [], []
    for eps in sizes:
        p, q = series.at(eps)
        times = np.linspace(-8, 8, 401) / eps
        saddle = dict(zip("xy", map(float, series.saddle(eps)), strict=True))
        samples = (times - times[0], series.orbit(eps, times))
        start = contin.connection(MODEL, saddle, parameters={"p": p, "q": q}, samples=samples)
        seed = start.locus(("p", "q"))[0]
        off.append(abs(float(seed.z[-1]) - p))
        x = seed.problem.profile(seed.z).u[:, 0]
        apart.append(abs(x.min() - series.orbit(eps, np.array([0.0]))[0, 0]))
    assert np.polyfit(np.log(sizes), np.log(off), 1)[0] > 5.5
    assert np.polyfit(np.log(sizes), np.log(apart), 1)[0] > 5.0
    assert off[-1] < 1e-2 * 4 * sizes[-1] ** 4
