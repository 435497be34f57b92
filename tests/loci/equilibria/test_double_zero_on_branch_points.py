"""Double zeros on curves of branch points, where curves of folds cross those and Hopf curves end on them."""

import pytest

import contin
from tests.loci.equilibria.planes import Plane
from tests.problems.follow import model

SEEDS = [None, 5, pytest.param(6, marks=pytest.mark.long)]
HARVEST = Plane(
    ("w0*(1 - w0) - w0*w1/(0.3 + w0) - p", "w1*(w0/(0.3 + w0) - 0.5 - q)"), (0.7, 0.0), {"p": 0.05, "q": 0.0}
)
ARNEODO = Plane(("w1", "w2", "-p*w0 - q*w1 - w2 - w0^2"), (0.0, 0.0, 0.0), {"p": 0.7, "q": 0.5})


@pytest.mark.parametrize("seed", SEEDS)
def test_folds_on_an_invariant_line_meet_the_curve_on_which_it_is_left_at_one_degenerate_point(seed):
    """Harvested prey alone has its fold at w0 = 1/2, p = 1/4; predators come in where q = w0/(.3 + w0) - .5 = 1/8."""
    line = HARVEST.line(seed)
    folds = contin.continuation(line["LP1"].locus(), ["p", "q"], {"p": (0.0, 0.3), "q": (-0.2, 0.4)})
    assert [point.type for point in folds.points] == ["BT"]
    assert not folds.notes  # "an error inside contin", and `unstable` changed without a label
    point = folds["BT1"]
    assert point.values["p"] == pytest.approx(0.25, abs=1e-12)
    assert abs(point.values["q"] - 0.125) <= max(point.error, 1e-13)
    assert point.normal_form["kind"] == "degenerate"  # a = 0: one eigenvalue vanishes on the line, one across


@pytest.mark.parametrize("seed", SEEDS)
def test_hopf_curves_end_at_the_double_zero_at_which_two_equilibria_pass_through_each_other(seed):
    """w0 = 0 and w0 = -p have theirs at q = p and q = -p. At p = q = 0: q0 = e0, p1 = (0, 1, 1), p0 = (1, 0, -1)."""
    line = ARNEODO.line(seed)
    box = {"p": (-1.0, 1.0), "q": (-1.0, 1.0)}
    curve = contin.continuation(line["HB1"].locus(), ["p", "q"], box)
    assert [point.type for point in curve.points] == ["BT"]
    assert not curve.notes
    point = curve["BT1"]
    assert abs(point.values["p"]) <= max(point.error, 1e-14)
    assert point.error < 1e-12
    if seed is None:
        assert point.normal_form["a"] == pytest.approx(-1.0, abs=1e-9)
        assert point.normal_form["b"] == pytest.approx(2.0, abs=1e-9)


@pytest.mark.parametrize("shift", [0.0, 1.0])
def test_tori_of_a_map_end_at_multiplier_one_twice_at_which_two_fixed_points_pass_through_each_other(shift):
    """X = x + y, Y = y - p x - x^2 - q y: det = 1 at q = p on x = 0."""
    x, y = f"(x - {shift})", f"(y - {shift})"
    kick = model(
        {"x": f"x + {y}", "y": f"y - p*{x} - {x}^2 - q*{y}"}, {"x": shift, "y": shift}, {"p": 0.7, "q": 0.5}, kind="map"
    )
    line = contin.continuation(contin.equilibrium(kick), "p", (0.2, 1.0))
    curve = contin.continuation(line["NS1"].locus(), ["p", "q"], {"p": (-1.0, 1.0), "q": (-1.0, 1.0)})
    assert [point.type for point in curve.points] == ["R1"]
    assert not curve.notes
    assert abs(curve["R11"].values["p"]) <= max(curve["R11"].error, 1e-14)
