"""Orbits of large systems against closed forms: families, multipliers, observed order, every kind of bifurcation."""

import numpy as np
import pytest

import contin
from contin.problems.large_orbits.large_orbit import LargeOrbitProblem
from contin.problems.large_orbits.radau import A, C, Trajectory, extremes
from tests.problems.large_orbits.cycles import family, landau, planted

MESH = 1e-4  # error of eight intervals of order 5
LONG = {"step": 0.05, "max_step": 0.2}  # of the range: rows of curves that are smooth are few


@pytest.fixture(scope="module")
def supercritical():
    return family(planted(-1.0, 0.0, exact=True), (-0.1, 0.45))


@pytest.fixture(scope="module")
def subcritical():
    return family(planted(1.0, -1.0), (-0.4, 0.1))


def test_collocation_is_exact_for_polynomials_of_its_degree():
    for power in (1, 2, 3):
        np.testing.assert_allclose(A @ C ** (power - 1), C**power / power, atol=1e-15)
    assert A[2] @ C**4 == pytest.approx(0.2)  # order 5 at the end
    times = ((np.arange(4)[:, None] + C) / 4).ravel()
    wave = Trajectory(np.sin(2 * np.pi * times).reshape(4, 3, 1), 1.0)
    fine = Trajectory(np.sin(2 * np.pi * ((np.arange(8)[:, None] + C) / 8).ravel()).reshape(8, 3, 1), 1.0)
    t = np.linspace(0, 1, 50)
    gaps = [np.abs(w.at(t)[:, 0] - np.sin(2 * np.pi * t)).max() for w in (wave, fine)]
    assert gaps[0] / gaps[1] == pytest.approx(16, rel=0.3)


def test_extremes_of_a_wave_have_the_fourth_order():
    def off(intervals):
        times = ((np.arange(intervals)[:, None] + C) / intervals).ravel()
        waves = np.column_stack([np.sin(2 * np.pi * (times - 0.123)), np.full_like(times, 2.0)])
        found = extremes(waves.reshape(intervals, 3, 2))
        np.testing.assert_allclose(found[:, 1], [2.0, 2.0], rtol=1e-14)
        return np.abs(found[:, 0] - [-1.0, 1.0]).max()

    assert off(40) < off(10) / 4**3.3


@pytest.mark.seldom
def test_bifurcations_of_cycles_are_where_they_were_planted(supercritical):
    found = supercritical
    assert isinstance(found.problem, LargeOrbitProblem)
    at = {p.label: p.values["mu"] for p in found.points}
    assert at == pytest.approx({"PD1": 0.25, "NS1": 0.3, "BPC1": 0.4}, abs=MESH)
    np.testing.assert_allclose(found.columns["period"], 2 * np.pi, rtol=MESH)
    np.testing.assert_allclose(found.columns["x.max"] ** 2, found.columns["mu"], atol=MESH)  # 0.02 at the points
    assert found.columns["unstable"][-1] == 4
    for point in found.points:  # errors contain the mesh's part, 4e-5 at PD1, and not much more
        assert abs(point.values["mu"] - {"PD1": 0.25, "NS1": 0.3, "BPC1": 0.4}[point.label]) < point.error < MESH
    assert found["NS1"].normal_form["theta"] == pytest.approx(0.8 * np.pi, abs=1e-4)
    exactly = {"PD1": lambda a: (0.5 + a) ** 2 * (1 - a), "NS1": lambda a: 0.3 + a, "BPC1": lambda a: 0.4 + a}
    for label, exact in exactly.items():
        span = {"mu": (0.1, 0.6), "a": (-0.03, 0.03)}
        curve = contin.continuation(found[label].locus(), ("mu", "a"), span, settings=LONG)
        np.testing.assert_allclose(curve.columns["mu"], exact(curve.columns["a"]), atol=MESH)
        assert [end.reason for end in curve.ends] == ["bound", "bound"]
        assert np.ptp(curve.columns["a"]) == pytest.approx(0.06)
        assert curve.effort["evaluations"] <= 25  # measured 18, for 8 steps
    crossing = contin.continuation(found["BPC1"].switch(), "mu", (0.2, 0.6), settings={"steps": 2})
    np.testing.assert_allclose(
        np.maximum(np.abs(crossing.columns["s.max"]), np.abs(crossing.columns["s.min"])) ** 2,
        crossing.columns["mu"] - 0.4, atol=1e-3,
    )  # fmt: skip
    assert crossing.columns["mu"].max() > 0.4
    doubled = contin.continuation(found["PD1"].switch(), "mu", (0.2, 0.6), settings={"steps": 2})
    np.testing.assert_allclose(doubled.columns["period"], 4 * np.pi, rtol=MESH)
    np.testing.assert_allclose(doubled.columns["w1.max"] ** 2, np.sqrt(doubled.columns["mu"]) - 0.5, atol=MESH)


@pytest.mark.seldom
def test_fold_of_cycles_behind_a_subcritical_hopf_point(subcritical):
    found = subcritical
    folds = [p for p in found.points if p.type == "LPC"]
    assert [p.values["mu"] for p in folds] == pytest.approx([-0.25], abs=folds[0].error)
    assert folds[0].error < MESH
    assert found.columns["x.max"].max() > 0.8
    curve = contin.continuation(folds[0].locus(), ("mu", "a"), {"mu": (-0.6, 0.1), "a": (-0.2, 0.2)}, settings=LONG)
    a = curve.columns["a"]
    np.testing.assert_allclose(curve.columns["mu"], -((1 + a) ** 2) / 4, atol=2 * MESH)
    np.testing.assert_allclose(curve.columns["x.max"] ** 2, (1 + a) / 2, atol=2 * MESH)
    assert np.ptp(a) == pytest.approx(0.4)


def test_curves_of_special_orbits_have_slopes_that_are_those_of_their_scalars(supercritical, subcritical):
    """Own derivatives of log |mu| and of dp/ds along any direction against central differences of the scalars."""
    generator = np.random.default_rng(5)
    for point in (supercritical["PD1"], supercritical["NS1"], subcritical["LPC1"]):
        seed = point.locus(["mu", "a"])[0]
        scale = seed.problem.initial_scale(seed.z, (-1.0, 1.0))
        scalars = seed.problem.near(seed.z, scale).scalars
        for _ in range(3):
            x = scale * generator.normal(size=seed.z.size)
            own = scalars.along(seed.z, x)
            step = 1e-5 / np.linalg.norm(x / scale)
            ends = [scalars(seed.z + sign * step * x) for sign in (1.0, -1.0)]
            np.testing.assert_allclose(own, (ends[0] - ends[1]) / (2 * step), rtol=1e-4, atol=1e-4 * abs(own).max())


@pytest.mark.parametrize(("points", "method"), [(6, "fourier"), (24, "differences")])
def test_uniform_oscillations_of_the_complex_ginzburg_landau_equation(points, method):
    problem = landau(points, method)
    line = contin.continuation(problem, "mu", (-0.2, 0.3))
    found = contin.continuation(line["HB1"].switch(), "mu", (-0.1, 1), settings={"steps": 8, "intervals": 10})
    mu = float(found.columns["mu"][-1])
    c1, c2 = 0.5, -0.8
    period = 2 * np.pi / (1 - c2 * mu)
    assert mu > 0.01
    assert found.columns["period"][-1] == pytest.approx(period, rel=MESH)
    # perturbations of wave number k: l = -mu - q +- sqrt(mu^2 - 2 c1 c2 mu q - c1^2 q^2), q = k^2 or its discrete image
    h = 2 * np.pi / points
    exact = [np.exp(-2 * mu * period)]
    for k in (1, 2):
        q = k * k if method == "fourier" else (2 - 2 * np.cos(k * h)) / h**2
        exact += 2 * [np.exp(period * (-mu - q + np.sqrt(complex(mu**2 - 2 * c1 * c2 * mu * q - c1**2 * q**2))))]
    largest = np.sort(np.abs(found.eigenvalues[-1][1:4]))[::-1]
    np.testing.assert_allclose(largest, np.sort(np.abs(exact))[::-1][:3], atol=2e-4)


@pytest.mark.long  # every day: folds with their curve, and uniform oscillations of a field, above
def test_folds_of_uniform_oscillations_of_a_subcritical_equation_lie_on_their_curve():
    """A_t = (mu + i) A + (1 + i/2) A_xx + (c + 0.3 i) |A|^2 A - |A|^4 A: folds where mu = -c^2/4."""
    square = "(u^2 + v^2)"
    problem = contin.load({
        "name": "quintic", "kind": "pde",
        "domain": {"x": {"to": "2*pi", "points": 8, "method": "differences", "periodic": True}},
        "fields": {"u": 0, "v": 0}, "parameters": {"mu": -0.5, "c": 1.0},
        "equations": {
            "u": f"mu*u - v + dxx(u) - 0.5*dxx(v) + {square}*(c*u - 0.3*v) - {square}^2*u",
            "v": f"mu*v + u + dxx(v) + 0.5*dxx(u) + {square}*(c*v + 0.3*u) - {square}^2*v",
        },
    })  # fmt: skip
    line = contin.continuation(problem, "mu", (-0.5, 0.2))
    to_fold = {"intervals": 10, "steps": 25, "stop_at": ("LPC",)}
    found = contin.continuation(line["HB1"].switch(), "mu", (-0.4, 0.1), settings=to_fold)
    span = {"mu": (-0.6, 0), "c": (0.9, 1.1)}
    curve = contin.continuation(found["LPC1"].locus(), ("mu", "c"), span, settings=LONG)
    c = curve.columns["c"]
    np.testing.assert_allclose(curve.columns["mu"], -(c**2) / 4, atol=MESH)
    np.testing.assert_allclose(curve.columns["period"], 2 * np.pi / (1 + 0.15 * c), rtol=MESH)  # |A|^2 = c/2
    assert np.ptp(c) == pytest.approx(0.2)


@pytest.mark.seldom
def test_the_period_converges_with_the_fifth_power():
    errors = []
    line = contin.continuation(landau(6, "fourier"), "mu", (-0.2, 0.3), settings={"stop_at": ("HB",)})
    for intervals in (6, 12):
        found = contin.continuation(
            line["HB1"].switch(), "mu", (-0.1, 1), settings={"steps": 3, "intervals": intervals}
        )
        errors.append(abs(found.columns["period"][-1] * (1 + 0.8 * found.columns["mu"][-1]) / (2 * np.pi) - 1))
    assert np.log2(errors[0] / errors[1]) > 3.5
