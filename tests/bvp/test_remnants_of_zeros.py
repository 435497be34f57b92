"""Functions that Newton's method leaves 1e-60 from zero have the sizes of nothing, whatever stands beside them."""

import numpy as np
import pytest

import contin
from contin.bvp.from_guess import boundary_guess
from contin.continuation.seed import Seed
from contin.model.model import Model

BUCKLING = np.pi**2 / 4.0  # of a column that is clamped below and free above, without weight
WEIGHT = 7.83734743894349  # that buckles it: 9 j^2 / 4, j the first zero of the Bessel function J of order -1/3


def column(unit=1.0):
    """Euler's heavy column with its end's height, angles in `unit`s: th'' = -(w (1 - s) + P) sin th, x' = cos th."""
    return Model(
        "column", kind="bvp", time={"name": "s"},
        states={
            "th": {"value": f"{0.1 / unit}*s", "scale": 1 / unit},
            "k": {"value": 0.1 / unit, "scale": 1 / unit}, "x": "s",
        },
        parameters={"w": {"value": 1, "range": [0, 20]}, "P": 0},
        equations={"th": "k", "k": f"-(w*(1 - s) + P)*sin({unit}*th)/{unit}", "x": f"cos({unit}*th)"},
        conditions=["th(start) = 0", "k(end) = 0", "x(start) = 0"],
    )  # fmt: skip


@pytest.mark.parametrize("unit", [pytest.param(1.0, marks=pytest.mark.long), 1e-9, 1e9])
@pytest.mark.seldom
def test_buckling_loads_are_a_curve_and_a_branch_from_any_point(unit):
    line = contin.continuation(boundary_guess(column(unit), None, None, ()), "w", (0, 20), values={"w": [7.0]})
    point = line["BP1"]
    assert abs(point.values["w"] - WEIGHT) <= point.error < 1e-8
    curve = contin.continuation(point.locus(), ("w", "P"), {"w": (-5, 15), "P": (-10, 20)}, values={"w": [0.0]})
    assert curve["UZ1"].values["P"] == pytest.approx(BUCKLING, abs=1e-9)
    z = line.z[line["UZ1"].index]
    z = z[np.isfinite(z)]  # rows on longer meshes are longer
    across = contin.continuation(Seed(line.problem.with_active("P", z), z), "P", (-2, 20))
    load = across["BP1"]
    again = contin.continuation(point.locus(), ("w", "P"), {"w": (0, 15), "P": (-10, 20)}, values={"w": [7.0]})
    assert abs(load.values["P"] - again["UZ1"].values["P"]) <= load.error + again["UZ1"].error + 1e-10


@pytest.mark.parametrize("size", [1.0, 1e-12, 1e-30])
def test_small_functions_in_units_of_their_own_keep_their_sizes(size):
    """Bratu's problem in units of `size`, beside a function of 1 that does not see it: the fold stays."""
    parts = {
        "kind": "bvp", "states": {"u": 0, "v": 0, "y": "t"}, "parameters": {"lam": {"value": 1, "range": [0, 4]}},
        "equations": {"u": "v", "v": f"-{size}*lam*exp(u/{size})", "y": 1}, "time": {"name": "t"},
        "conditions": ["u(start) = 0", "u(end) = 0", "y(start) = 0"],
    }  # fmt: skip
    line = contin.continuation(boundary_guess(Model("m", **parts), None, None, ()), "lam", (0, 4), direction="up")
    fold = line["LP1"]
    assert abs(fold.values["lam"] - 3.513830719125162) <= fold.error < 1e-7

    assert fold.values["u.max"] / size == pytest.approx(1.1868421, abs=1e-6)


@pytest.mark.parametrize(("mean", "units"), [(0.3, 1.0), (-0.2, 1e6)])
def test_an_exact_start_whose_integral_in_a_condition_is_rounding_is_a_solution(mean, units):
    # Cahn and Hilliard's u'' = lam (u^3 - u - mu), mean m held: rests change at lam = (n pi)^2/(1 - 3 m^2)
    model = contin.load({
        "name": "rest", "kind": "bvp", "time": {"name": "t", "from": 0, "to": 1}, "states": {"u": mean * units, "v": 0},
        "parameters": {"lam": 5, "m": mean, "mu": mean**3 - mean, "U": units},
        "equations": {"u": "v", "v": "lam*U*((u/U)^3 - u/U - mu)"},
        "conditions": ["v(start) = 0", "v(end) = 0", "integral(u) = m*U"],
    })  # fmt: skip
    line = contin.continuation(contin.boundary_problem(model, free=["mu"]), "lam", (5, 60))
    exact = [np.square(n * np.pi) / (1 - 3 * mean**2) for n in (1, 2)]
    found = [p.values["lam"] for p in line.points if p.type == "BP"]
    np.testing.assert_allclose(found, exact, rtol=1e-7)
    assert all(abs(p.values["lam"] - e) <= p.error for p, e in zip(line.points, exact, strict=True))
