"""The series of the homoclinic orbit at a Bogdanov-Takens point, beside orbits that are solved for."""

import numpy as np
import pytest

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


def test_orbits_that_grow_beside_states_much_larger_than_they_are_do_not_shrink_to_their_point():
    """x' = v, v' = p + q v + x^2 + x v + x^3/2, moved by 400: the orbits' extent is 0.1 % of the states to begin with.

    Those are the same orbits. The moved ones ended `bt` after 7 rows, though they grew.
    """
    ends = [_at_bound(moved) for moved in (0.0, 400.0)]
    assert ends[1] == pytest.approx(ends[0], rel=1e-5)


def _at_bound(moved: float) -> float:
    """p of the homoclinic orbit at q = 0.4."""
    model = contin.Model(
        "moved", states={"x": moved - 0.5, "y": moved}, parameters={"p": -0.25, "q": -0.5},
        definitions={"u": f"x - {moved}", "v": f"y - {moved}"},
        equations={"x": "v", "y": "p + q*v + u^2 + u*v + u^3/2"},
    )  # fmt: skip
    names, box = ("p", "q"), {"p": (-0.6, 0.5), "q": (-1, 0.4)}
    line = contin.continuation(contin.equilibrium(model), "p", (-0.26, 0.5))
    folds = contin.continuation(line["LP1"].locus(), names, box)
    (seed,) = (s for s in folds["BT1"].locus(names) if s.problem.locus == "HOM")
    loops = contin.continuation(seed, names, box)
    assert [end.reason for end in loops.ends] == ["start", "bound"]
    assert np.all(np.diff(loops.columns["x.max"] - loops.columns["x.min"]) > 0.0)
    return float(loops.columns["p"][-1])
