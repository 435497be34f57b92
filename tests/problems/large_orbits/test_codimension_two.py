"""Points of codimension two on curves of bifurcations of large orbits, where they were planted."""

import numpy as np
import pytest

import contin
from tests.problems.large_orbits.test_normal_forms import GAIN, M, family, function

INTERVALS, MESH = 6, 1e-3  # and the error of as many
LONG = {"step": 0.1, "max_step": 0.25}  # of the range: what is between the labels is looked at elsewhere


def folding(z, p):
    """r' = r (mu + a R + 1.5 R^2 - R^3), R = r^2: folds at a = 3 R^2 - 3 R, with a cusp at R = 1/2; a plane that turns
    by half an angle, with multipliers -exp(2 pi (-0.6 +- r))."""
    x, y, *plane = z.tolist()
    r2 = x * x + y * y
    growth = p["mu"] + p["a"] * r2 + 1.5 * r2 * r2 - r2**3
    circle = [growth * x - y, growth * y + x]
    if not plane:
        return np.array(circle)
    w1, w2 = plane
    return np.array([*circle, (x - 0.6) * w1 + (y - 0.5) * w2, (y + 0.5) * w1 - (x + 0.6) * w2])


def doubling_and_torus(z, p):
    """As in `test_normal_forms`, with the torus' frequency, K, the rate of the plane and a term of fifth order as
    parameters; of four states without the torus."""
    x, y, w1, w2, *torus = z.tolist()
    v1, v2 = torus or (0.0, 0.0)
    k, e = p["k"], 0.5 + p["e"]
    mu, r2, w, v = p["mu"], x * x + y * y, w1 * w1 + w2 * w2, v1 * v1 + v2 * v2
    growth, speed = mu - r2 + M * (w + v), 1.0 + 0.2 * v
    doubled = [
        growth * x - speed * y, growth * y + speed * x,
        (x - e - k * w) * w1 + (y - 0.5) * w2, (y + 0.5) * w1 - (x + e + k * w) * w2,
    ]  # fmt: skip
    if not torus:
        return np.array(doubled)
    gain = mu - 0.3 + GAIN * (r2 - mu) - k * v - p["q"] * v * v
    turn = p["omega"] - 0.4 * v
    return np.array([*doubled, gain * v1 - turn * v2, gain * v2 + turn * v1])


def found_on(curve, labels):
    assert [point.type for point in curve.points] == labels
    assert not any("its normal form" in note for note in curve.notes)
    return curve.points


def agrees(point, **planted):
    """Coefficients are those that were planted to their errors, which are small."""
    for name, value in planted.items():
        error = point.normal_form["errors"][name]
        assert abs(np.asarray(point.normal_form[name]) - value).max() <= error <= 3e-3 * max(1.0, abs(value))


@pytest.mark.parametrize("a", [-0.72, pytest.param(-0.6, marks=pytest.mark.long)])
@pytest.mark.seldom
def test_a_cusp_and_a_fold_flip_point_on_a_curve_of_folds(a):
    problem = function(folding, 2 if a < -0.7 else 4, {"mu": -0.5, "a": a})
    folds = family(problem, (-0.1, 0.3), stop_at=("LPC",), intervals=INTERVALS)
    span = {"mu": (-0.2, 0.3), "a": (-0.76, a + 0.01)}
    planted = {"CPC": 0.5} if a < -0.7 else {"LPPD": 0.36, "CPC": 0.5}
    settings = {**LONG, "stop_at": ("CPC",)}  # behind it the curve comes back
    curve = contin.continuation(folds["LPC1"].locus(), ("mu", "a"), span, settings=settings)
    for point in found_on(curve, list(planted)):
        r2 = planted[point.type]
        assert abs(point.values["a"] - (3 * r2 * r2 - 3 * r2)) < point.error < MESH
        assert abs(point.values["mu"] - (1.5 * r2 * r2 - 2 * r2**3)) < point.error
        if point.type == "CPC":  # r' = -r (R - 1/2)^3, R - 1/2 = 2 r xi
            agrees(point, c=-2.0)
        else:  # r' = r (3 - 6 R)/2 (R - .36)^2, for either sense of xi
            a = 0.42 * 4.0 * 0.36 * 0.6
            agrees(point, a=float(np.copysign(a, point.normal_form["a"])), b=0.0)
    assert not any("unstable changes" in note for note in curve.notes)


def doubled_and_torus(states=6, **settings):
    problem = function(doubling_and_torus, states, {"mu": -0.5, "k": 0.65, "e": 0.0, "omega": 0.34, "q": 0.0})
    return family(problem, (-0.1, 0.32), intervals=INTERVALS, **settings)


@pytest.fixture(scope="module")
def planted():
    return doubled_and_torus(stop_at=("PD",))


@pytest.mark.seldom
def test_a_generalised_period_doubling():
    """c = M/(2 r) - k vanishes at r = 1/2; r = sqrt(mu + M w^2) has -M^2/(8 r^3) w^4."""
    doubling = doubled_and_torus(4, stop_at=("PD",))["PD1"]
    span = {"mu": (0.1, 0.5), "k": (0.645, 0.72)}
    curve = contin.continuation(doubling.locus(), ("mu", "k"), span, settings={**LONG, "stop_at": ("GPD",)})
    (point,) = found_on(curve, ["GPD"])
    assert abs(point.values["k"] - M) < point.error < MESH
    agrees(point, e=-M * M)


@pytest.mark.long
def test_a_1_to_3_resonance():
    torus = doubled_and_torus()["NS1"]
    curve = contin.continuation(torus.locus(), ("mu", "omega"), {"mu": (0.1, 0.5), "omega": (0.32, 0.35)})
    (point,) = found_on(curve, ["R3"])
    assert abs(point.values["omega"] - 1.0 / 3.0) < point.error < MESH
    agrees(point, B=0.0)  # it turns as it is


@pytest.mark.long
def test_a_torus_next_to_a_doubling(planted):
    """-exp(2 pi (-0.5 - e + r)) = -1 where mu = 0.3: e = sqrt(0.3) - 0.5."""
    curve = contin.continuation(planted["PD1"].locus(), ("mu", "e"), {"mu": (0.2, 0.32), "e": (-0.01, 0.06)})
    (point,) = found_on(curve, ["GPD", "PDNS"])[1:]
    assert abs(point.values["e"] - (np.sqrt(0.3) - 0.5)) < point.error < MESH
    k, r, period = 0.65, np.sqrt(0.3), 2.0 * np.pi  # with w = xi_1, |v| = sqrt(2) |xi_2|, r = sqrt(mu + M (w^2 + v^2))
    rates = {"p11": M / (2 * r) - k, "p12": M / r, "p21": GAIN * M, "p22": 2 * (GAIN * M - k)}
    agrees(point, **{name: period * rate for name, rate in rates.items()})


@pytest.mark.long
def test_a_chenciner_point():
    """Re d = 2 GAIN M - 2 k; |v|' = -q |v|^5 where that vanishes, |v| = sqrt(2) |xi|."""
    planted = family(
        function(doubling_and_torus, 6, {"mu": -0.5, "k": 0.2, "e": 0.0, "omega": 0.4, "q": 0.3}),
        (-0.1, 0.35),
        intervals=INTERVALS,
    )
    curve = contin.continuation(planted["NS1"].locus(), ("mu", "k"), {"mu": (0.1, 0.5), "k": (0.15, 0.25)})
    (point,) = found_on(curve, ["CH"])
    assert abs(point.values["k"] - GAIN * M) < point.error < MESH
    agrees(point, l2=-4.0 * 0.3)


@pytest.mark.long  # every day: that of R2 (test_resonances)
def test_more_states_than_a_matrix_is_made_of_have_a_remark(planted, monkeypatch):
    monkeypatch.setattr("contin.problems.large_orbits.codimension_two.MOST", 5)
    span = {"mu": (0.1, 0.5), "k": (0.64, 0.75)}
    curve = contin.continuation(planted["PD1"].locus(), ("mu", "k"), span, settings={**LONG, "stop_at": ("GPD",)})
    (point,) = curve.points
    assert point.type == "GPD"
    assert not point.normal_form
    assert any("GPD" in note and "not computed for orbits of large systems" in note for note in curve.notes)
