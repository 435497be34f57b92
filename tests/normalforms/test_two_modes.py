"""Zero-Hopf and Hopf-Hopf points: normal forms hidden by changes of coordinates and units; their torus curves."""

import numpy as np
import pytest

from contin.normalforms.hopf_hopf import hopf_hopf, subtype, torus_predictors
from contin.normalforms.zero_hopf import torus_predictor, zero_hopf

from .polynomials import PolynomialJet, add, hide, multiply, scale, variable
from .test_static import signed


def modes(total):
    """(x, y, x^2 + y^2) of w1 = x + i y in variables 1, 2 (zero-Hopf) or 0, 1."""

    def block(first):
        x, y = variable(first, total), variable(first + 1, total)
        return x, y, add(multiply(x, x, 9), multiply(y, y, 9))

    return block


def rotate(c, x, y, factor):
    """(Re, Im) of c w factor for w = x + i y."""
    c = complex(c)
    real = multiply(add(scale(x, c.real), scale(y, -c.imag)), factor, 9)
    imag = multiply(add(scale(x, c.imag), scale(y, c.real)), factor, 9)
    return real, imag


def zero_hopf_field(omega, f200, f011, f300, f111, f110, f210, f021, unfolding=()):
    """Taylor coefficients f; unfolding: one (drift of w0, rate of w1) a parameter."""
    total = 3 + len(unfolding)
    one = {(0,) * total: 1.0}
    u = variable(0, total)
    x, y, r2 = modes(total)(1)
    u2 = multiply(u, u, 9)
    w0 = add(scale(u2, f200), scale(r2, f011), scale(multiply(u2, u, 9), f300), scale(multiply(u, r2, 9), f111))
    terms = [rotate(1j * omega, x, y, one), rotate(f110, x, y, u), rotate(f210, x, y, u2), rotate(f021, x, y, r2)]
    for i, (drift, rate) in enumerate(unfolding):
        p = variable(3 + i, total)
        w0 = add(w0, scale(p, drift))
        terms.append(rotate(rate, x, y, p))
    return [w0, add(*(t[0] for t in terms)), add(*(t[1] for t in terms))]


@pytest.mark.parametrize("units", [None, [1e3, 1.0, 1e-3, 1e2]])
@pytest.mark.parametrize("seed", range(3))
def test_zero_hopf_coefficients_that_determine_the_case_are_invariant(seed, units):
    # G200, G011, G110 scale with the eigenvectors; s and theta do not; E divides by |q0|^2 only. The single cubic
    # coefficients depend on the choice of coordinates (Kuznetsov, sec. 8.5.2), E does not.
    rng = np.random.default_rng(seed)
    f200, f011, f300, f111 = rng.normal(size=4)
    f110, f210, f021 = rng.normal(size=(3, 2)) @ [1, 1j]
    jet, T = hide(zero_hopf_field(1.3, f200, f011, f300, f111, f110, f210, f021), [-0.9], rng, 3, units=units)
    form = zero_hopf(jet).coefficients
    l0 = signed(T[:, 0])
    l1 = np.linalg.norm(T[:, 1] - 1j * T[:, 2]) / 2
    assert form["G200"] == pytest.approx(2 * f200 / l0, rel=1e-7)
    assert form["G011"] == pytest.approx(f011 * l0 / l1**2, rel=1e-7)
    assert form["G110"][0] == pytest.approx(f110.real / l0, rel=1e-7)
    assert form["s"] == np.sign(f200 * f011)
    assert form["theta"] == pytest.approx(f110.real / f200, rel=1e-7)
    E = f210.real + f110.real * (f021.real / f011 - 1.5 * f300 / f200 + 0.5 * f111 / f011) - f021.real * f200 / f011
    assert form["E"] == pytest.approx(E / l0**2, rel=1e-5)


def test_zero_hopf_invariant_E_does_not_change_under_a_change_of_time_and_variables():
    # multiply the field by 1 + 0.4 w0 (a positive factor: same orbits) and substitute w0 -> w0 + 0.3 w0^2 - 0.2 |w1|^2
    from .polynomials import conjugate

    f = zero_hopf_field(1.0, 0.7, -0.5, 0.3, 0.2, 0.4 + 0.1j, -0.3, 0.6)
    base = zero_hopf(PolynomialJet(f)).coefficients
    u = variable(0, 3)
    slower = [add(s, scale(multiply(s, u, 9), 0.4)) for s in f]
    slower = [{e: c for e, c in s.items() if sum(e) <= 3} for s in slower]
    x, y = variable(1, 3), variable(2, 3)
    change = [
        add(u, scale(multiply(u, u, 9), 0.3), scale(add(multiply(x, x, 9), multiply(y, y, 9)), -0.2)),
        add(x, scale(multiply(x, u, 9), 0.25)),
        add(y, scale(multiply(y, u, 9), 0.25)),
    ]
    moved = zero_hopf(PolynomialJet(conjugate(slower, change, 0, 3))).coefficients
    assert moved["G300"] != pytest.approx(base["G300"], rel=1e-2)
    assert moved["E"] == pytest.approx(base["E"], rel=1e-10)


def test_zero_hopf_with_a_reflection_is_named_hopf_pitchfork():
    jet = PolynomialJet(zero_hopf_field(1.0, 0.0, 0.0, -1.0, 0.4, 0.0, 0.3, -0.2))
    assert zero_hopf(jet).coefficients["case"].startswith("Hopf-pitchfork")


def test_torus_curve_of_a_zero_hopf_point_has_a_cycle_with_neutral_slow_modulation():
    # planar system for (w0, rho) of the normal form itself: at the predicted parameters its equilibrium has trace 0
    f200, f011, f111, f110, f021 = 1.0, 0.8, 0.3, -0.6 + 0.2j, -0.4
    unfolding = [(1.0, 0.2), (0.1, 1.0 + 0.5j)]
    jet = PolynomialJet(zero_hopf_field(1.0, f200, f011, 0.0, f111, f110, 0.0, f021, unfolding), 2)
    cycle, slow = torus_predictor(jet)
    assert slow > 0
    scale_ = np.sqrt(2.0)  # q = (1, -i)/sqrt(2): |w1| = rho means |x + i y| = sqrt(2) rho

    def trace(rho):
        p = cycle.parameter_shift(rho)
        from scipy.optimize import fsolve

        def planar(z):
            u, r = z
            drift = p @ [1.0, 0.1] + f200 * u * u + f011 * r * r + f111 * u * r * r
            return [drift, r * (p @ [0.2, 1.0] + f110.real * u + f021 * r * r)]

        guess = [cycle.orbit(rho, np.array([0.0]))[0, 0], scale_ * rho]
        u, r = fsolve(planar, guess, xtol=1e-13)
        assert r == pytest.approx(guess[1], rel=0.05)
        return 2 * f200 * u + f111 * r * r + 2 * f021 * r * r

    sizes = 0.05 / 2.0 ** np.arange(4)
    values = np.abs([trace(rho) for rho in sizes])
    assert np.polyfit(np.log(sizes), np.log(values), 1)[0] > 3.5  # the trace itself is made of terms of order rho^2


def hopf_hopf_field(w1, w2, c11, c12, c21, c22, unfolding=()):
    total = 4 + len(unfolding)
    one = {(0,) * total: 1.0}
    x, y, r = modes(total)(0)
    u, v, s = modes(total)(2)
    first = [rotate(1j * w1, x, y, one), rotate(c11, x, y, r), rotate(c12, x, y, s)]
    second = [rotate(1j * w2, u, v, one), rotate(c21, u, v, r), rotate(c22, u, v, s)]
    for i, (a, b) in enumerate(unfolding):
        p = variable(4 + i, total)
        first.append(rotate(a, x, y, p))
        second.append(rotate(b, u, v, p))
    return [add(*(t[i] for t in mode)) for mode in (first, second) for i in (0, 1)]


@pytest.mark.parametrize("units", [None, [1e3, 1.0, 1e-3, 1e2, 1.0]])
@pytest.mark.parametrize("seed", range(2))
def test_hopf_hopf_coefficients_survive_a_change_of_coordinates_and_units(seed, units):
    rng = np.random.default_rng(seed)
    c = rng.normal(size=(4, 2)) @ [1, 1j]
    jet, T = hide(hopf_hopf_field(np.sqrt(3.0), 0.9, *c), [-0.8], rng, 3, units=units)
    form = hopf_hopf(jet).coefficients
    l1, l2 = (np.linalg.norm(T[:, i] - 1j * T[:, i + 1]) / 2 for i in (0, 2))
    for key, value in (
        ("G2100", 2 * c[0] / l1**2),
        ("G1011", c[1] / l2**2),
        ("G1110", c[2] / l1**2),
        ("G0021", 2 * c[3] / l2**2),
    ):
        assert complex(*form[key]) == pytest.approx(value, rel=1e-6)
    assert form["theta"] == pytest.approx(c[1].real / c[3].real, rel=1e-6)
    assert form["delta"] == pytest.approx(c[2].real / c[0].real, rel=1e-6)
    assert form["case"].startswith("simple" if c[0].real * c[3].real > 0 else "difficult")


@pytest.mark.parametrize(("omegas", "words"), [((1.00005, 1.0), "1:1"), ((3.0, 1.0), "1:3"), ((2.9, 1.0), None)])
def test_no_case_of_a_hopf_hopf_point_is_stated_where_frequencies_are_in_resonance(omegas, words):
    # the amplitudes of w1' = 3 i w1 + ... + w2^3 depend on the phases: the subtypes leave such terms out
    jet, _ = hide(hopf_hopf_field(*omegas, -1.0, -2.0, -2.0, -1.0), [-0.8], np.random.default_rng(4), 3)
    form = hopf_hopf(jet).coefficients
    assert form.get("resonance") == words
    assert form["case"] == ("simple case I" if words is None else f"near-resonant: {words}")


def test_interior_equilibrium_of_the_amplitude_equations_agrees_with_the_subtypes():
    # r_j'/r_j = mu_j + ...: in the difficult case the interior equilibrium can have a zero trace with positive
    # determinant (a Hopf point: a three-torus) only where theta delta > 1, that is in I, II and VI
    rng = np.random.default_rng(0)
    for theta, delta in rng.normal(size=(200, 2)) * 2:
        J = np.array([[1.0, -theta], [delta, -1.0]])  # at xi1 = xi2 = 1: trace 0
        assert (np.linalg.det(J) > 0) == (subtype(theta, delta, False).split()[-1] in ("I", "II", "VI"))
        assert subtype(theta, delta, False) == subtype(delta, theta, False)
        J = np.array([[-1.0, -theta], [-delta, -1.0]])
        assert (np.linalg.det(J) < 0) == (subtype(theta, delta, True).split()[-1] in ("I", "V"))


def test_torus_curves_of_a_hopf_hopf_point():
    c11, c12, c21, c22 = -1.0 + 0.3j, -0.6, 0.7, -0.8
    unfolding = [(1.0, 0.3), (0.2, 1.0 + 0.4j)]
    jet = PolynomialJet(hopf_hopf_field(np.sqrt(3.0), 0.9, c11, c12, c21, c22, unfolding), 2)
    (first, angle1), (second, angle2) = torus_predictors(jet)
    M = np.array([[1.0, 0.2], [0.3, 1.0]])
    np.testing.assert_allclose(M @ first.p2, [-2 * c11.real, -2 * c21], rtol=1e-10)  # |x + i y|^2 = 2 rho^2
    np.testing.assert_allclose(M @ second.p2, [-2 * c12, -2 * c22], rtol=1e-10)
    assert angle1 == pytest.approx(2 * np.pi * 0.9 / np.sqrt(3.0))
    assert angle2 == pytest.approx(2 * np.pi * np.sqrt(3.0) / 0.9)
