"""Codimension-two points of maps: normal forms hidden by changes of coordinates, and iterates against flows."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from contin.normalforms.map_resonances import (
    chenciner,
    generalised_flip,
    resonance_1_1,
    resonance_1_2,
    resonance_1_3,
    resonance_1_4,
)

from .polynomials import PolynomialJet, hide, rotation_field
from .test_hopf import length
from .test_static import residual, signed


def complex_map(f, degree):
    """Series in (x, y) of w -> f given as {(j, k): coefficient of w^j conj(w)^k}."""
    real, imag = {}, {}
    from .polynomials import add, multiply, scale, variable

    x, y = variable(0, 2), variable(1, 2)
    for (j, k), c in f.items():
        re, im = {(0, 0): 1.0}, {(0, 0): 0.0}
        for sign in [1.0] * j + [-1.0] * k:
            re, im = (
                add(multiply(re, x, degree), scale(multiply(im, y, degree), -sign)),
                add(multiply(im, x, degree), scale(multiply(re, y, degree), sign)),
            )
        c = complex(c)
        real = add(real, scale(re, c.real), scale(im, -c.imag))
        imag = add(imag, scale(re, c.imag), scale(im, c.real))
    return [real, imag]


@pytest.mark.parametrize("seed", range(3))
def test_generalised_flip_coefficient_survives(seed):
    rng = np.random.default_rng(seed)
    e = rng.normal()
    jet, T = hide([{(1,): -1.0, (5,): e}], [0.4], rng, 5, kind="map")
    assert generalised_flip(jet).coefficients["e"] == pytest.approx(e / signed(T[:, 0]) ** 4, rel=1e-5)


@pytest.mark.parametrize("seed", range(2))
def test_chenciner_coefficient_survives(seed):
    rng = np.random.default_rng(seed)
    value, d, d2 = np.exp(1.1j), 0.8j, complex(*rng.normal(size=2))
    jet, T = hide(rotation_field(value, {1: value * d, 2: value * d2}), [0.3], rng, 5, kind="map")
    expected = (d2.real + d.imag**2 / 2) / length(T) ** 4
    assert chenciner(jet).coefficients["l2"] == pytest.approx(expected, rel=1e-5)


def test_chenciner_l2_is_the_change_of_the_radius():
    value, d, d2 = np.exp(1.1j), 0.8j, -0.5 + 0.3j
    form = chenciner(PolynomialJet(rotation_field(value, {1: value * d, 2: value * d2}), kind="map")).coefficients
    r = 0.05
    grown = r * abs(1 + d * r**2 + d2 * r**4)
    assert (grown - r) / r**5 * 4 == pytest.approx(form["l2"], rel=1e-2)  # q = (1, -i)/sqrt(2): |w| = r/sqrt(2)


@pytest.mark.parametrize("seed", range(3))
def test_resonance_1_1_coefficients_survive(seed):
    rng = np.random.default_rng(seed)
    a, b = rng.normal(size=2)
    field = [{(1, 0): 1.0, (0, 1): 1.0}, {(0, 1): 1.0, (2, 0): a, (1, 1): b}]
    jet, T = hide(field, [0.4], rng, 2, kind="map")
    form = resonance_1_1(jet).coefficients
    assert form["a"] == pytest.approx(a / signed(T[:, 0]), rel=1e-6)
    # x -> x + c y changes the map's own b (not b - 2 a): b is fixed up to the part of q1 along q0, which q0.q1 = 0 sets
    assert form["b"] - 2 * form["a"] == pytest.approx((b - 2 * a) / signed(T[:, 0]), rel=1e-5)


@pytest.mark.parametrize("seed", range(3))
def test_resonance_1_2_coefficients_survive(seed):
    rng = np.random.default_rng(seed)
    C, D = rng.normal(size=2)
    field = [{(1, 0): -1.0, (0, 1): 1.0}, {(0, 1): -1.0, (3, 0): C, (2, 1): D}]
    jet, T = hide(field, [0.4], rng, 3, kind="map")
    form = resonance_1_2(jet).coefficients
    size = signed(T[:, 0]) ** 2
    assert form["C"] == pytest.approx(C / size, rel=1e-5)
    assert form["D1"] == pytest.approx((-2 * D - 6 * C) / size, rel=1e-5)


def iterate(jet, z, times):
    for _ in range(times):
        z = residual(jet, z)
    return z


def unit_time(field, z):
    run = solve_ivp(lambda t, u: field(u), (0, 1), z, method="DOP853", rtol=1e-13, atol=1e-16)
    return run.y[:, -1]


@pytest.mark.parametrize(
    ("order", "terms"), [(3, {(0, 2): 0.7 - 0.3j, (2, 1): -0.4 + 0.5j}), (4, {(0, 3): 0.6, (2, 1): 0.2j - 0.5})]
)
def test_iterate_at_a_strong_resonance_is_the_flow_of_the_reported_field(order, terms):
    jet = PolynomialJet(complex_map({(1, 0): np.exp(2j * np.pi / order), **terms}, 3), kind="map")
    form = (resonance_1_3 if order == 3 else resonance_1_4)(jet).coefficients
    c1 = complex(*form["C1"]) / 2  # |w|^2 = |x + i y|^2/2 ... z = x + i y = sqrt(2) w
    b1 = complex(*form["B1"]) / np.sqrt(2) if order == 3 else complex(*form["D1"]) / 2
    # field in z = sqrt(2) w: coefficients of |z|^2 z divide by 2, of conj(z)^2 by sqrt(2)
    misses = []
    sizes = 0.1 / 2.0 ** np.arange(4)
    for size in sizes:
        z0 = size * np.exp(0.7j)

        def field(u):
            z = u[0] + 1j * u[1]
            dz = b1 * np.conj(z) ** (order - 1) + c1 * z * abs(z) ** 2
            return [dz.real, dz.imag]

        end = unit_time(field, [z0.real, z0.imag])
        misses.append(np.linalg.norm(end - iterate(jet, np.array([z0.real, z0.imag]), order)))
    assert np.polyfit(np.log(sizes), np.log(misses), 1)[0] > (3.8 if order == 3 else 4.8)


@pytest.mark.parametrize("seed", range(2))
def test_strong_resonance_coefficients_survive(seed):
    rng = np.random.default_rng(seed)
    B, C = rng.normal(size=(2, 2)) @ [1, 1j]
    jet, T = hide(complex_map({(1, 0): np.exp(2j * np.pi / 3), (0, 2): B, (2, 1): C}, 3), [0.4], rng, 3, kind="map")
    form = resonance_1_3(jet).coefficients
    C1 = 3 * np.exp(-2j * np.pi / 3) * C - 3 * abs(B) ** 2
    assert form["a"] == pytest.approx(C1.real / (9 * abs(B) ** 2), rel=1e-6)
    jet, T = hide(complex_map({(1, 0): 1j, (0, 3): B, (2, 1): C}, 3), [0.4], rng, 3, kind="map")
    assert complex(*resonance_1_4(jet).coefficients["A0"]) == pytest.approx(-1j * C / abs(B), rel=1e-6)
    assert complex(*resonance_1_4(jet).coefficients["C"]) == pytest.approx(C / length(T) ** 2, rel=1e-6)


@pytest.mark.parametrize("seed", range(6))
def test_area_preserving_maps_have_no_sign_that_rounding_decides(seed):
    """A generating function makes (x, y) -> (y, -x + f(y)) of area 1: Re C1 of R3, Re A0 of R4, s of R1 and D1 of R2.

    Each is a rate of expansion, which such a map has not; what does not vanish keeps its sign under a change of
    coordinates.
    """
    rng = np.random.default_rng(seed)
    quadratic, cubic = rng.uniform(0.5, 2.0, 2)
    forms = {}
    for trace, name in ((2.0, "R1"), (-2.0, "R2"), (-1.0, "R3"), (0.0, "R4")):
        field = [{(0, 1): 1.0}, {(1, 0): -1.0, (0, 1): trace, (0, 2): quadratic, (0, 3): cubic}]
        forms[name] = {
            "R1": resonance_1_1, "R2": resonance_1_2, "R3": resonance_1_3, "R4": resonance_1_4,
        }[name](hide(field, [], rng, 4, kind="map")[0])  # fmt: skip
    assert forms["R1"].coefficients["s"] == 0
    assert forms["R1"].coefficients["case"] == "degenerate"
    assert forms["R2"].coefficients["case"].startswith("degenerate: D1 zero to its error, C1 ")
    assert forms["R3"].coefficients["case"].startswith("degenerate: a ")
    assert "Re A0 zero" in forms["R4"].coefficients["case"]
    for form in forms.values():
        assert form.errors
        assert all(error > 0.0 for error in form.errors.values())
