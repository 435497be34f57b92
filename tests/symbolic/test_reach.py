"""How far averages hold: quadratures against mpmath and Bessel forms, closed forms beyond the order they presume.

A branch of an averaged model is right to rounding or ends in words; both are asserted at every row, from outside.
"""

import mpmath
import numpy as np
import pytest
from scipy.special import i0e, i1e

import contin
from contin.model.model import Model
from contin.model.yaml_loader import load_model_text


def oscillator(force, parameters, x=1.2):
    return Model(
        "oscillator", states={"x": x, "y": 0}, parameters={"eps": 0.01, **parameters},
        equations={"x": "y", "y": f"-x + eps*({force})"},
        averaging={"small": "eps", "oscillators": [{"position": "x", "velocity": "y"}]},
    )  # fmt: skip


GAUSSIAN = oscillator("a*y - y*exp(-x^2) - 1e-4*y^3", {"a": 0.6})


def gaussian_damping(r):
    """The a of an equilibrium: <exp(-r^2 cos^2) sin^2> = e^(-M)(I0 + I1)(M)/2, M = r^2/2."""
    half = np.asarray(r) ** 2 / 2
    return i0e(half) + i1e(half) + 0.75e-4 * np.asarray(r) ** 2


def line(model, parameter, bounds, **options):
    """The branch of amplitudes through r = 1.2 (or the start)."""
    start = options.pop("start", {"r": 1.2})
    return contin.continuation(contin.equilibrium(model, start=start, **options), parameter, bounds)


@pytest.mark.parametrize("reach", [None, 40.0])
@pytest.mark.seldom
def test_every_row_of_a_quadrature_satisfies_the_bessel_form(reach):
    branch = line(contin.average(GAUSSIAN, reach=reach), "a", (0.01, 0.9))
    np.testing.assert_allclose(branch.columns["a"], gaussian_damping(branch.columns["r"]), rtol=1e-9)
    far = max(branch.ends, key=lambda end: "quadrature" in end.text)
    assert far.reason == "bound"
    assert "reach" in far.text


def test_the_fold_lies_where_the_bessel_form_turns():
    branch = line(contin.average(GAUSSIAN, reach=40), "a", (0.01, 0.9))
    r = float(mpmath.findroot(lambda s: mpmath.diff(_bessel, s), 19.5))
    assert branch["LP1"].values["r"] == pytest.approx(r, rel=1e-7)
    assert branch["LP1"].values["a"] == pytest.approx(float(_bessel(r)), rel=1e-12)


def _bessel(r):
    half = mpmath.mpf(r) ** 2 / 2
    return mpmath.exp(-half) * (mpmath.besseli(0, half) + mpmath.besseli(1, half)) + mpmath.mpf("0.75e-4") * r**2


def tanh_amplitude(k):
    def gap(r):
        cuts = [0, mpmath.pi / 64, mpmath.pi / 16, mpmath.pi / 4, mpmath.pi / 2]
        mean = mpmath.quad(lambda s: mpmath.tanh(k * r * mpmath.sin(s)) * mpmath.sin(s), cuts)
        return r / 4 - 2 / mpmath.pi * mean

    return float(mpmath.findroot(gap, 2.54))


@pytest.mark.seldom
def test_ranges_of_parameters_count_for_a_quadrature():
    narrow = oscillator("a*y - tanh(k*y)", {"a": 0.5, "k": 1})
    wide = oscillator("a*y - tanh(k*y)", {"a": 0.5, "k": {"value": 1, "range": [1, 16]}})
    short = line(contin.average(narrow), "k", (1, 16), start={"r": 2})
    whole = line(contin.average(wide), "k", (1, 16), start={"r": 2})
    assert "quadrature" in short.ends[1].text
    assert whole.columns["k"][-1] == 16.0
    for branch in (short, whole):
        k, r = (float(branch.columns[name][-1]) for name in ("k", "r"))
        assert r == pytest.approx(tanh_amplitude(k), rel=1e-10)


@pytest.mark.parametrize(("h", "a", "last"), [(0.5, 0.23, 1.5), (0.0, 0.3, 0.0)])
def test_closed_forms_end_where_the_order_of_thresholds_changes(h, a, last):
    model = oscillator("a*y - y*(0.2 if x < h else 0.6 if x < g else 0.3)", {"a": a, "h": h, "g": 1.5}, x=3)
    branch = line(contin.average(model), "h", (0, 3), start={"r": 0.8 if h else 5})
    assert "presume" in branch.ends[1].text
    assert branch.ends[1].reason == "bound"
    rows = branch.columns["r"] > 0.01
    h, r = branch.columns["h"][rows], branch.columns["r"][rows]
    assert last - 0.2 <= h.max() <= last
    upper, strip = above(1.5, r), above(h, r) - above(1.5, r)
    np.testing.assert_allclose(0.1 + 0.4 * strip + 0.1 * upper, a / 2, atol=1e-9)


def above(c, r):
    """<sin^2> over the part of the turn with r cos(phi) > c."""
    phi = np.arccos(np.clip(c / r, -1, 1))
    return (phi - 0.5 * np.sin(2 * phi)) / (2 * np.pi)


def test_thresholds_of_different_terms_too():
    model = oscillator("a*y - 0.3*(y if x > h else 0) - 0.2*(y if x > g else 0)", {"a": 0.2, "h": 0.5, "g": 1.5}, x=3)
    slow = contin.average(model)
    assert any("h < g" in limit.beyond for limit in slow.limits)
    branch = line(slow, "h", (0.1, 4), start={"r": 3})
    assert "presume" in branch.ends[1].text
    assert branch.columns["h"].max() <= 1.5


@pytest.mark.seldom
def test_two_oscillators_and_all_forms_carry_their_limits():
    model = Model(
        "two", states={"x1": 1, "y1": 0, "x2": 1, "y2": 0}, parameters={"eps": 0.1, "c": 0.3},
        equations={"x1": "y1", "y1": "-x1 + eps*(y1 - y1^3 + c*sin(x2 - x1))",
                   "x2": "y2", "y2": "-x2 + eps*(y2 - y2^3 + c*sin(x1 - x2))"},
        averaging={"small": "eps", "oscillators": [{"position": "x1", "velocity": "y1"},
                                                   {"position": "x2", "velocity": "y2"}]},
    )  # fmt: skip
    for form in ("polar", "cartesian", "stokes"):
        slow = contin.average(model, form)
        assert slow.limits
        u, p = slow.start_point({s: 0.8 + 0.1 * k for k, s in enumerate(slow.state_names)})
        from contin.lowering import compile_system

        system = compile_system(slow)
        assert np.all(system.margins(u[None], p[None]) >= 0.0)
        assert np.any(system.margins(60.0 * u[None], p[None]) < 0.0)


def test_simulations_stop_there_and_files_keep_the_limits():
    slow = contin.average(oscillator("a*y - y*exp(-x^2) - 1e-7*y^3", {"a": 0.6}))
    again = load_model_text(slow.text(), "again")
    assert again.limits == slow.limits
    for model in (slow, again):
        run = contin.simulate(model, {"r": 3.0}, time=60.0)
        assert run.outcome == "stopped"
        assert "quadrature" in run.why
        assert run.columns["r"].max() < 9.0
    swept = contin.sweep(slow, "a", (0.5, 0.7), steps=1, start={"r": 3.0}, down=False)
    assert set(swept.outcomes) == {"stopped"}


def test_exact_averages_have_no_limits():
    assert not contin.average(oscillator("a*y - y^3 + y*x^2", {"a": 0.5})).limits


def test_a_bad_reach_is_refused():
    with pytest.raises(contin.errors.InputError, match="reach"):
        contin.average(GAUSSIAN, reach=-1)


@pytest.mark.seldom
def test_a_function_that_changes_fast_is_averaged_as_far_as_a_rule_goes():
    """<atan(20 x)^2 sin^2>: no rule serves up to the amplitude 4, one up to 1.7 does, and the branch says so there."""
    model = oscillator("-a*y + y*atan(20*x)^2", {"a": 1.5}, x=0.4)
    branch = line(contin.average(model), "a", (1.2, 2.46), start={"r": 0.4})
    r, a = branch.columns["r"], branch.columns["a"]
    assert "not accurate any more" in max(branch.ends, key=lambda end: "quadrature" in end.text).text

    def damping(r):
        def mean(t):
            return (mpmath.atan(20 * r * mpmath.cos(t)) * mpmath.sin(t)) ** 2

        quarter = [0, mpmath.pi / 4, mpmath.pi / 2 - mpmath.mpf("0.1"), mpmath.pi / 2]
        return float(4 / mpmath.pi * mpmath.quad(mean, quarter))

    rows = np.linspace(0, len(r) - 1, 5).astype(int)
    np.testing.assert_allclose(a[rows], [damping(r[k]) for k in rows], rtol=1e-10)
