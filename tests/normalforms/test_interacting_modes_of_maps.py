"""LPPD, LPNS, PDNS and NSNS of maps: normal forms hidden by changes of coordinates, and what they say is born there."""

import numpy as np
import pytest
from scipy.optimize import brentq

from contin.normalforms.fold_flip import fold_flip
from contin.normalforms.fold_neimark_sacker import fold_neimark_sacker
from contin.normalforms.maps import neimark_sacker
from contin.normalforms.modes_of_maps import NearResonantError
from contin.normalforms.two_amplitudes import double_neimark_sacker, flip_neimark_sacker, subtype_within

from .polynomials import PolynomialJet, Series, add, compose, hide, multiply, scale, variable

UNITS = [None, [1e3, 1.0, 1e-3, 1e2, 1.0]]


def within(form, exact, least=1e-6):
    """Each coefficient is what it should be to its stated error, which is a small part of it."""
    for key, value in exact.items():
        found, error = np.asarray(form.coefficients[key], float), form.errors[key]
        away = np.linalg.norm(found - np.asarray(value, float))
        assert away <= error <= least * (1 + np.linalg.norm(value)), (key, found, value, error)


def sign(value):
    return "<" if value < 0 else ">"


def pair(c):
    return [complex(c).real, complex(c).imag]


def fold_flip_map(a, b, c, d) -> list[Series]:
    return [{(1, 0): 1.0, (2, 0): a, (0, 2): b, (3, 0): c, (1, 2): d}, {(0, 1): -1.0, (1, 1): 1.0}]


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize("seed", range(4))
def test_fold_flip_survives_changes_of_coordinates(seed, units):
    rng = np.random.default_rng(seed)
    a, b, c, d = rng.normal(size=4)
    jet, T = hide(fold_flip_map(a, b, c, d), [0.4, -0.7], rng, 3, kind="map", units=units and units[:4])
    form = fold_flip(jet)
    size = np.linalg.norm(T[:, 1]) ** 2
    exact = {"a": a, "b": b / size, "c": c, "d": d / size, "L_NS": (3 * b * c - a * (2 * a * b + 3 * b + d)) / size}
    within(form, exact)
    assert abs(form.coefficients["e"]) == pytest.approx(1 / np.linalg.norm(T[:, 0]), rel=1e-8)
    assert form.coefficients["case"].startswith(f"a {sign(a)} 0, b {sign(b)} 0")


def shifted(field: list[Series], u) -> list[Series]:
    """F(u + x) as polynomials of x."""
    moved = []
    for f in field:
        total: Series = {}
        for (i, j), c in f.items():
            term: Series = {(0, 0): c}
            for power, k in ((i, 0), (j, 1)):
                for _ in range(power):
                    term = multiply(term, add({(0, 0): u[k]}, variable(k, 2)), 9)
            total = add(total, term)
        moved.append(total)
    return moved


def at_the_origin(field: list[Series]) -> PolynomialJet:
    return PolynomialJet([{e: c for e, c in f.items() if any(e)} for f in field], kind="map")


@pytest.mark.parametrize("seed", range(6))
def test_invariant_curves_of_the_doubled_orbit_of_a_fold_flip_are_stable_where_it_says_so(seed):
    """A doubled orbit (0, +-r) close to the point, e1 = -b r^2 and e2 where the second iterate's determinant is 1."""
    rng = np.random.default_rng(seed)
    a, b, c, d = rng.normal(size=4)
    b, r = abs(b), 0.02

    def second(e2):
        field = add_to(fold_flip_map(a, b, c, d), {(0, 0): -b * r * r, (1, 0): e2})
        return both_ways(field, [0.0, r])

    e2 = brentq(lambda e: np.linalg.det(second(e).A) - 1, -0.3, 0.3)
    curve = neimark_sacker(second(e2)).coefficients["d"][0]
    words = "stable" if curve < 0 else "unstable"
    case = fold_flip(at_the_origin(fold_flip_map(a, b, c, d))).coefficients["case"]
    assert case.endswith(f"invariant curve of the doubled orbit {words}")


def add_to(field: list[Series], drift: Series) -> list[Series]:
    return [add(field[0], drift), *field[1:]]


def both_ways(field: list[Series], u) -> PolynomialJet:
    """The second iterate at a point u of a doubled orbit (u0, +-u1)."""
    there, back = shifted(field, u), shifted(field, [u[0], -u[1]])
    there, back = ([{e: c for e, c in f.items() if any(e)} for f in g] for g in (there, back))
    return PolynomialJet([compose(f, there, 5) for f in back], kind="map")


def test_fold_flip_of_the_generalised_henon_map():
    """(x, y) -> (y, alpha - beta x - y^2 + R x y) has one at alpha = 0, beta = -1: a/e = (1 - R)/2, b e = (1 + R)/4."""
    for R in (-0.1, 0.3, 1.7):
        form = fold_flip(PolynomialJet([{(0, 1): 1.0}, {(1, 0): 1.0, (0, 2): -1.0, (1, 1): R}], kind="map"))
        within(form, {"a": (1 - R) / 2, "b": (1 + R) / 4})


def test_reflections_and_vanishing_terms_of_a_fold_flip_have_no_signs():
    mirrored = PolynomialJet([{(1, 0): 1.0, (3, 0): 0.3, (1, 2): 0.5}, {(0, 1): -1.0, (0, 3): 0.4}], kind="map")
    assert "reflection" in fold_flip(mirrored).coefficients["case"]
    uncoupled = PolynomialJet([{(1, 0): 1.0, (2, 0): 0.3, (0, 2): 0.5}, {(0, 1): -1.0, (0, 3): 0.4}], kind="map")
    form = fold_flip(uncoupled)
    assert form.coefficients["case"].startswith("degenerate: e ")
    assert "a" not in form.coefficients
    form = fold_flip(PolynomialJet(fold_flip_map(0.0, 0.5, 0.2, 0.1), kind="map"))
    assert form.coefficients["case"] == "degenerate: a is zero to its estimated error, b > 0"


def turned(factor, x, y, series: Series) -> tuple[Series, Series]:
    """(Re, Im) of factor (x + i y) series."""
    real = multiply(add(scale(x, factor.real), scale(y, -factor.imag)), series, 9)
    imag = multiply(add(scale(x, factor.imag), scale(y, factor.real)), series, 9)
    return real, imag


def square(x, y):
    return add(multiply(x, x, 9), multiply(y, y, 9))


def fold_circle_map(s, a, b, c, angle) -> list[Series]:
    """w0 -> w0 + w0^2 + s |w1|^2 + c w0^3, w1 -> e^{i angle} w1 (1 + a w0 + b w0^2)."""
    u, x, y = (variable(k, 3) for k in range(3))
    u2, one = multiply(u, u, 9), {(0, 0, 0): 1.0}
    w0 = add(u, u2, scale(square(x, y), s), scale(multiply(u2, u, 9), c))
    turn = np.exp(1j * angle)
    terms = [turned(turn * k, x, y, power) for k, power in ((1.0, one), (a, u), (b, u2))]
    return [w0, add(*(t[0] for t in terms)), add(*(t[1] for t in terms))]


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize("seed", range(4))
def test_fold_neimark_sacker_survives_changes_of_coordinates(seed, units):
    rng = np.random.default_rng(seed)
    s, c, angle = float(rng.choice([-1, 1])), rng.normal(), rng.uniform(0.4, 1.2)
    a, b = rng.normal(size=(2, 2)) @ [1, 1j]
    jet, T = hide(fold_circle_map(s, a, b, c, angle), [0.4], rng, 3, kind="map", units=units and units[:4])
    form, turn = fold_neimark_sacker(jet), np.exp(1j * angle)
    E = (b - a * a / 2).real - a.real**2 + a.real * (1 - 1.5 * c)
    within(form, {"a": pair(turn * a), "b": pair(turn * b), "c": c, "theta": a.real, "E": E})
    assert form.coefficients["s"] == s
    assert form.coefficients["angle"] == pytest.approx(angle, rel=1e-9)
    length, ring = np.linalg.norm(T[:, 0]), np.linalg.norm(T[:, 1] - 1j * T[:, 2]) / 2
    assert abs(form.coefficients["f200"]) == pytest.approx(1 / length, rel=1e-8)
    assert abs(form.coefficients["f011"]) == pytest.approx(length / ring**2, rel=1e-8)
    assert form.coefficients["case"].startswith(f"s = {s:.0f}, theta {sign(a.real)} 0, ")


@pytest.mark.parametrize("s", [-1.0, 1.0])
@pytest.mark.parametrize("seed", range(4))
def test_tori_of_a_fold_neimark_sacker_point_are_stable_where_it_says_so(seed, s):
    """The map of (w0, |w1|): a circle |w1| = r at w0 close to 0, and the growth of |w1| where its determinant is 1."""
    rng = np.random.default_rng(seed)
    a, b, c = -s * (0.3 + abs(rng.normal())), rng.normal(), rng.normal()
    full = fold_neimark_sacker(PolynomialJet(fold_circle_map(s, a, b, c, 0.7), kind="map"))
    r = 0.02

    def amplitudes(drift):
        place = -2 * drift / (a + np.copysign(np.sqrt(a * a - 4 * b * drift), a))  # drift + a w + b w^2 = 0
        field: list[Series] = [
            {(0, 0): -(place**2) - c * place**3 - s * r * r, (1, 0): 1.0, (2, 0): 1.0, (0, 2): s, (3, 0): c},
            {(0, 1): 1.0 + drift, (1, 1): a, (2, 1): b},
        ]
        return at_the_origin(shifted(field, [place, r]))

    drift = brentq(lambda x: np.linalg.det(amplitudes(x).A) - 1, -0.02, 0.02, xtol=1e-16)
    torus = neimark_sacker(amplitudes(drift)).coefficients["d"][0]
    assert full.coefficients["case"].endswith(f"torus {'stable' if torus < 0 else 'unstable'}")


def amplitude_map(turns, powers) -> list[Series]:
    """w_j -> turn_j w_j (1 + sum_k powers[j][k] |w_k|^2), of a real state where the turn is real."""
    width = sum(2 if np.iscomplexobj(turn) else 1 for turn in turns)
    places, k = [], 0
    for turn in turns:
        wide = np.iscomplexobj(turn)
        places.append((variable(k, width), variable(k + 1, width) if wide else {}))
        k += 2 if wide else 1
    squares = [square(x, y) if y else multiply(x, x, 9) for x, y in places]
    field = []
    for turn, row, (x, y) in zip(turns, powers, places, strict=True):
        one = {(0,) * width: 1.0}
        terms = [turned(complex(turn) * p, x, y, power) for p, power in zip((1.0, *row), (one, *squares), strict=True)]
        field.append(add(*(t[0] for t in terms)))
        if y:
            field.append(add(*(t[1] for t in terms)))
    return field


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize("seed", range(4))
def test_flip_neimark_sacker_survives_changes_of_coordinates(seed, units):
    rng = np.random.default_rng(seed)
    angle, P = rng.uniform(0.3, 0.9), rng.normal(size=(2, 2)) + 1j * np.array([[0, 0], rng.normal(size=2)])
    field = amplitude_map((-1.0, np.exp(1j * angle)), P)
    jet, T = hide(field, [0.4], rng, 3, kind="map", units=units and units[:4])
    form = flip_neimark_sacker(jet)
    lengths = np.linalg.norm(T[:, 0]) ** 2, (np.linalg.norm(T[:, 1] - 1j * T[:, 2]) / 2) ** 2
    check_amplitudes(form, P.real, lengths)
    assert form.coefficients["angle"] == pytest.approx(angle, rel=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_double_neimark_sacker_survives_changes_of_coordinates(seed):
    rng = np.random.default_rng(seed)
    angles, P = (rng.uniform(1.7, 1.9), rng.uniform(0.3, 0.45)), rng.normal(size=(2, 2, 2)) @ [1, 1j]
    field = amplitude_map(tuple(np.exp(1j * np.array(angles))), P)
    jet, T = hide(field, [0.4] if seed else [], rng, 3, kind="map")
    form = double_neimark_sacker(jet)
    check_amplitudes(form, P.real, [(np.linalg.norm(T[:, k] - 1j * T[:, k + 1]) / 2) ** 2 for k in (0, 2)])
    assert [form.coefficients[key] for key in ("angle1", "angle2")] == pytest.approx(angles, rel=1e-9)


def check_amplitudes(form, P, lengths):
    within(form, {f"p{j + 1}{k + 1}": P[j, k] / lengths[k] for j in range(2) for k in range(2)})
    within(form, {"theta": P[0, 1] / P[1, 1], "delta": P[1, 0] / P[0, 0]})
    assert form.coefficients["case"].startswith("simple" if P[0, 0] * P[1, 1] > 0 else "difficult")


def test_states_that_decay_beside_the_others_change_nothing():
    P = np.array([[0.3, -0.2], [0.5 + 0.2j, -0.7 + 0.1j]])
    field = amplitude_map((-1.0, np.exp(0.6j)), P)
    beside = [{(*e, 0, 0): c for e, c in f.items()} for f in field]
    beside += [{(0, 0, 0, 1, 0): 0.5}, {(0, 0, 0, 0, 1): -0.2, (0, 0, 0, 2, 0): 1.0}]
    alone, wide = (flip_neimark_sacker(PolynomialJet(f, kind="map")).coefficients for f in (field, beside))
    assert wide.pop("case") == alone.pop("case")
    assert wide == pytest.approx(alone, rel=1e-12)


def test_the_third_iterate_has_three_times_the_rates():
    """p of w -> e^{3 i angle} w (1 + 3 P |w|^2 + ...); theta, delta and the case are those of the map itself."""
    P = np.array([[0.3, -0.2], [0.5 + 0.2j, -0.7 + 0.1j]])
    field = amplitude_map((-1.0, np.exp(0.3j)), P)
    third = compose_field(field, compose_field(field, field))
    one, three = (flip_neimark_sacker(PolynomialJet(f, kind="map")).coefficients for f in (field, third))
    for name in ("p11", "p12", "p21", "p22"):
        assert three[name] == pytest.approx(3 * one[name], rel=1e-9)
    assert three["case"] == one["case"]
    fold = fold_circle_map(-1.0, 0.4 + 0.3j, 0.2 - 0.5j, 0.7, 0.3)
    second = compose_field(fold, fold)
    one, two = (fold_neimark_sacker(PolynomialJet(f, kind="map")).coefficients for f in (fold, second))
    assert two["theta"] == pytest.approx(one["theta"], rel=1e-9)  # xi -> 2 xi makes xi' = 2 xi^2 that of one iterate
    assert two["E"] == pytest.approx(one["E"] / 2, rel=1e-9)
    assert two["case"] == one["case"]


def compose_field(outer, inner):
    return [compose(f, inner, 3) for f in outer]


@pytest.mark.parametrize(
    ("form", "turns", "angle"),
    [
        (flip_neimark_sacker, (-1.0,), np.pi / 2),  # w0 conj(w1) in w1, w1^2 in w0
        (flip_neimark_sacker, (-1.0,), 2 * np.pi / 3),  # conj(w1)^2 in w1
        (double_neimark_sacker, (np.exp(0.7j),), 1.4),  # w1^2 in w2
        (double_neimark_sacker, (np.exp(2.8j),), 2 * np.pi - 5.6),  # conj(w1)^2 in w2
    ],
)
def test_near_a_resonance_of_second_order_no_number_is_printed(form, turns, angle):
    P = [[0.3, -0.2], [0.5, -0.7]]
    for off in (0.0, 1e-7, -2e-4):
        jet = PolynomialJet(amplitude_map((*turns, np.exp(1j * (angle + off))), P), kind="map")
        with pytest.raises(NearResonantError, match=r"near-resonant: .*theta.* = "):
            form(jet)
    jet = PolynomialJet(amplitude_map((*turns, np.exp(1j * (angle + 0.01))), P), kind="map")
    assert "resonance" not in form(jet).coefficients


@pytest.mark.parametrize(
    ("form", "turns", "angle", "words"),
    [
        (flip_neimark_sacker, (-1.0,), np.pi / 3, "3 theta = pi"),  # w0 conj(w1)^2 in w1
        (double_neimark_sacker, (np.exp(0.6j),), 1.8, "theta1 - 3 theta2 = 0"),
        (double_neimark_sacker, (np.exp(2.5j),), np.pi / 2, "4 theta2 = 2 pi"),
    ],
)
def test_near_a_resonance_of_third_order_no_case_is_stated(form, turns, angle, words):
    P = [[0.3, -0.2], [0.5, -0.7]]
    for off in (0.0, 1e-7, -2e-4):
        jet = PolynomialJet(amplitude_map((*turns, np.exp(1j * (angle + off))), P), kind="map")
        found = form(jet).coefficients
        assert found["resonance"] == words
        assert found["case"] == f"near-resonant: {words}"
        assert {"p11", "p12", "p21", "p22"} <= set(found)


def test_a_fold_neimark_sacker_point_at_four_turns_has_its_coefficients_and_no_case():
    field = fold_circle_map(1.0, 0.4 + 0.3j, 0.2 - 0.5j, 0.7, np.pi / 2)
    found = fold_neimark_sacker(PolynomialJet(field, kind="map")).coefficients
    assert found["case"] == "near-resonant: 4 theta = 2 pi"
    assert found["c"] == pytest.approx(0.7, rel=1e-9)
    with pytest.raises(NearResonantError, match="3 theta = 2 pi"):
        fold_neimark_sacker(PolynomialJet(fold_circle_map(1.0, 0.4, 0.2, 0.7, 2 * np.pi / 3), kind="map"))


def test_no_subtype_is_stated_between_two():
    errors = {"theta": 1e-8, "delta": 1e-8}
    assert subtype_within({"theta": 2.0, "delta": 0.6}, errors, True) == "simple case I"
    assert subtype_within({"theta": 2.0, "delta": 0.5}, errors, True).startswith("simple case, degenerate")
    assert subtype_within({"theta": 2.0, "delta": 1e-9}, errors, False).startswith("difficult case, degenerate")


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize("seed", range(4))
def test_what_vanishes_has_no_sign_in_any_coordinates(seed, units):
    """b = 0 or L_NS = 0 of LPPD, theta = 0 or E = 0 of LPNS, p11 = 0 of PDNS: rounding decides no case."""
    rng, few = np.random.default_rng(seed), units and units[:4]
    a, b, c = rng.uniform(0.3, 1.5, 3)
    d = (3 * b * c - 2 * a * a * b - 3 * a * b) / a
    form = fold_flip(hide(fold_flip_map(a, b, c, d), [0.4, -0.7], rng, 3, kind="map", units=few)[0])
    assert form.coefficients["case"] == "a > 0, b > 0, degenerate: L_NS is zero to its estimated error"
    form = fold_flip(hide(fold_flip_map(-a, 0.0, c, d), [0.4, -0.7], rng, 3, kind="map", units=few)[0])
    assert form.coefficients["case"] == "degenerate: b is zero to its estimated error, a < 0"
    field = fold_circle_map(1.0, 1j * a, b + 0.3j, c, 0.7)
    form = fold_neimark_sacker(hide(field, [0.4], rng, 3, kind="map", units=few)[0])
    assert form.coefficients["case"] == "s = 1, degenerate: theta is zero to its estimated error"
    field = fold_circle_map(1.0, -a, 1.5 * a * a + a * (1 - 1.5 * c) + 0.3j, c, 0.7)
    form = fold_neimark_sacker(hide(field, [0.4], rng, 3, kind="map", units=few)[0])
    assert form.coefficients["case"] == "s = 1, theta < 0, degenerate: E is zero to its estimated error"
    field = amplitude_map((-1.0, np.exp(0.7j)), [[0.0, a], [b, c]])
    form = flip_neimark_sacker(hide(field, [0.4], rng, 3, kind="map", units=few)[0])
    assert form.coefficients["case"] == "degenerate: p11 zero to its error"
    assert "delta" not in form.coefficients
