"""Hopf and generalised Hopf points: normal forms hidden by changes of coordinates, closed forms, published numbers."""

import mpmath
import numpy as np
import pytest
from scipy.optimize import brentq

from contin.normalforms.hopf import generalised_hopf, hopf, hopf_predictor, lpc_predictor

from .formulas import taylor_jet
from .polynomials import PolynomialJet, hide, rotation_field

UNITS = [None, [1e5, 1.0, 1e-5], [1e-4, 1e2, 1.0]]


def length(T):
    """|q0| of u = 2 Re(q0 w), w = x + i y: the factor from w to the unit eigenvector's coordinate."""
    return np.linalg.norm(T[:, 0] - 1j * T[:, 1]) / 2


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize("seed", range(3))
def test_c1_and_l1_survive_a_change_of_coordinates_and_units(seed, units):
    rng = np.random.default_rng(seed)
    omega, c1 = 1.7, complex(*rng.normal(size=2))
    jet, T = hide(rotation_field(1j * omega, {1: c1}), [-0.8], rng, 3, units=units)
    form = hopf(jet).coefficients
    expected = c1 / length(T) ** 2
    assert form["omega"] == pytest.approx(omega, rel=1e-12)
    assert complex(*form["c1"]) == pytest.approx(expected, rel=1e-7)
    assert form["l1"] == pytest.approx(expected.real / omega, rel=1e-7)
    assert form["criticality"] == ("supercritical" if c1.real < 0 else "subcritical")


def test_eigenvector_has_unit_length_and_a_real_positive_largest_component():
    jet, _ = hide(rotation_field(2j, {1: -1.0}), [-0.8, 0.3], np.random.default_rng(5), 3)
    form = hopf(jet)
    q, p = form.vectors["q"], form.vectors["p"]
    lead = q[np.argmax(np.abs(q))]
    assert abs(np.linalg.norm(q) - 1.0) < 1e-14
    assert lead.real > 0
    assert abs(lead.imag) < 1e-15
    assert abs(np.vdot(p, q) - 1.0) < 1e-13
    np.testing.assert_allclose(jet.A @ q, 2j * q, atol=1e-12)


def test_brusselator_in_closed_form():
    A = 1.3
    formulas = ["A - (B + 1)*x + x**2*y", "B*x - x**2*y"]
    jet = taylor_jet(["x", "y"], ["B"], formulas, {"x": A, "y": (1 + A**2) / A, "B": 1 + A**2}, A=A)
    form = hopf(jet).coefficients
    assert form["omega"] == pytest.approx(A, rel=1e-12)
    assert form["criticality"] == "supercritical"
    x, y = A, (1 + A**2) / A
    expected = planar_l1(lambda u, v: A - (2 + A**2) * u + u**2 * v, lambda u, v: (1 + A**2) * u - u**2 * v, x, y)
    assert form["l1"] == pytest.approx(expected, rel=1e-9)


def planar_l1(f, g, x, y):
    """l1 of a planar Hopf point by the Guckenheimer-Holmes formula (3.4.11) in FORMATS' scale, by mpmath.

    In Jordan coordinates u = T (a, b) with A T = T [[0, -w], [w, 0]], r' = r^3 s; the unit eigenvector multiplies s by
    4/|t1 - i t2|^2 and l1 = that/w. Independent of the multilinear forms.
    """
    mpmath.mp.dps = 40
    J = [[mpmath.diff(h, (x, y), order) for order in ((1, 0), (0, 1))] for h in (f, g)]
    w = mpmath.sqrt(J[0][0] * J[1][1] - J[0][1] * J[1][0])
    # A t1 = w t2 for t1 = (1, 0): columns of T
    t1, t2 = (mpmath.mpf(1), mpmath.mpf(0)), (J[0][0] / w, J[1][0] / w)
    det = t1[0] * t2[1] - t1[1] * t2[0]

    def component(row):
        def h(a, b):
            u, v = x + t1[0] * a + t2[0] * b, y + t1[1] * a + t2[1] * b
            F, G = f(u, v), g(u, v)
            return (t2[1] * F - t2[0] * G) / det if row == 0 else (-t1[1] * F + t1[0] * G) / det

        return h

    F, G = component(0), component(1)

    def D(h, i, j):
        return mpmath.diff(h, (mpmath.mpf(0), mpmath.mpf(0)), (i, j))

    s = (D(F, 3, 0) + D(F, 1, 2) + D(G, 2, 1) + D(G, 0, 3)) / 16 + (
        D(F, 1, 1) * (D(F, 2, 0) + D(F, 0, 2))
        - D(G, 1, 1) * (D(G, 2, 0) + D(G, 0, 2))
        - D(F, 2, 0) * D(G, 2, 0)
        + D(F, 0, 2) * D(G, 0, 2)
    ) / (16 * w)
    size = (t1[0] ** 2 + t1[1] ** 2 + t2[0] ** 2 + t2[1] ** 2) / 4
    return float(s / size / w)


def test_centre_is_degenerate():
    # Lotka-Volterra: every orbit around (1, 1) is closed, all Lyapunov coefficients vanish
    jet = taylor_jet(["x", "y"], ["m"], ["x*(1 - y)", "m*y*(x - 1)"], {"x": 1, "y": 1, "m": 1.7})
    assert hopf(jet).coefficients["criticality"] == "degenerate"


def test_no_complex_pair_is_an_error():
    with pytest.raises(ValueError, match="neutral saddle"):
        hopf(PolynomialJet([{(1, 0): 1.0}, {(0, 1): -1.0}]))


def test_lorenz_hopf_point_is_subcritical_with_the_coefficient_of_an_independent_calculation():
    s, b = mpmath.mpf(10), mpmath.mpf(8) / 3
    r = s * (s + b + 3) / (s - b - 1)
    x = mpmath.sqrt(b * (r - 1))
    formulas = ["s*(y - x)", "r*x - y - x*z", "x*y - b*z"]
    jet = taylor_jet(["x", "y", "z"], ["r"], formulas, {"x": x, "y": x, "z": r - 1, "r": r}, s=s, b=b)
    form = hopf(jet).coefficients
    assert form["criticality"] == "subcritical"
    assert form["omega"] == pytest.approx(float(mpmath.sqrt(b * (s + r))), rel=1e-12)
    # Lorenz has no cubic terms: G21 = <p, B(q*, h20) + 2 B(q, h11)>, written out in mpmath
    mpmath.mp.dps = 30
    A = mpmath.matrix([[-s, s, 0], [1, -1, -x], [x, x, -b]])
    w = mpmath.sqrt(b * (s + r))

    def B(u, v):
        return mpmath.matrix([0, -(u[0] * v[2] + u[2] * v[0]), u[0] * v[1] + u[1] * v[0]])

    def null(M):  # null vector by fixing the first component
        rest = mpmath.lu_solve(M[1:3, 1:3], -M[1:3, 0])
        return mpmath.matrix([1, rest[0], rest[1]])

    eye, i = mpmath.eye(3), mpmath.mpc(0, 1)
    q = null(A - i * w * eye)
    q = q / mpmath.norm(q)
    p = null((A - i * w * eye).T)  # bilinear left vector
    p = p / (p.T * q)[0]
    h20 = mpmath.lu_solve(2 * i * w * eye - A, B(q, q))
    h11 = -mpmath.lu_solve(A.copy(), B(q, q.apply(mpmath.conj)))
    G21 = (p.T * (B(q.apply(mpmath.conj), h20) + 2 * B(q, h11)))[0]
    assert complex(*form["c1"]) == pytest.approx(complex(G21 / 2), rel=1e-9)


def test_predictor_gives_amplitude_parameter_and_frequency_of_the_normal_form():
    rng = np.random.default_rng(8)
    omega, c1, gamma = 1.4, -0.6 + 0.9j, 0.8 - 0.5j
    jet, T = hide(rotation_field(1j * omega, {1: c1}, [{0: gamma}]), [-0.7], rng, 3, parameters=1)
    cycle = hopf_predictor(jet)
    size = length(T) ** 2
    p2 = -c1.real / gamma.real / size
    assert cycle.p2[0] == pytest.approx(p2, rel=1e-8)
    assert cycle.omega2 == pytest.approx(c1.imag / size + gamma.imag * p2, rel=1e-8)
    assert cycle.period(0.1) == pytest.approx(2 * np.pi / (omega + 0.01 * cycle.omega2))


def test_predicted_cycle_satisfies_the_equations_to_third_order():
    rng = np.random.default_rng(9)
    jet, _ = hide(rotation_field(1.4j, {1: -0.6 + 0.9j}, [{0: 0.8 - 0.5j}]), [-0.7], rng, 3, parameters=1)
    cycle = hopf_predictor(jet)
    phases = np.linspace(0, 2 * np.pi, 32, endpoint=False)
    amplitudes, misses = 1e-2 / 2.0 ** np.arange(4), []
    for rho in amplitudes:
        u = cycle.orbit(rho, phases)
        du = np.real(np.fft.ifft(1j * np.fft.fftfreq(32, 1 / 32)[:, None] * np.fft.fft(u, axis=0), axis=0))
        z = np.hstack([u, np.full((32, 1), cycle.parameter_shift(rho)[0])])
        F = np.array([[sum(c * np.prod(row ** np.array(e)) for e, c in f.items()) for f in jet.field] for row in z])
        misses.append(np.abs(du * 2 * np.pi / cycle.period(rho) - F).max())
    assert np.polyfit(np.log(amplitudes), np.log(misses), 1)[0] == pytest.approx(3.0, abs=0.1)


@pytest.mark.parametrize("units", [None, [1e3, 1.0, 1e-3]])
@pytest.mark.parametrize("seed", range(2))
def test_second_lyapunov_coefficient_survives_a_change_of_coordinates(seed, units):
    rng = np.random.default_rng(seed)
    c2 = complex(*rng.normal(size=2))
    jet, T = hide(rotation_field(1.3j, {1: 0.7j, 2: c2}), [-0.9], rng, 5, units=units)
    form = generalised_hopf(jet).coefficients
    assert form["l2"] == pytest.approx(c2.real / length(T) ** 4, rel=1e-5)
    assert abs(form["c1"][0]) < 1e-8 * abs(form["c1"][1])
    assert "case" not in form


def test_a_generalised_hopf_point_without_a_fifth_order_coefficient_says_so():
    jet, _ = hide(rotation_field(1.3j, {1: 0.7j, 3: -1.0}), [-0.9], np.random.default_rng(1), 5)
    assert generalised_hopf(jet).coefficients["case"] == "degenerate"


def test_bautin_normal_form_and_its_curve_of_folds():
    # r' = r (b1 + b2 r^2 - r^4): folds of cycles on b1 = -b2^2/4, r^2 = b2/2; l2 = -1 for |w| = r, q = (1, -i)/2 scaled
    field = rotation_field(1j, {2: -1.0}, [{0: 1.0}, {1: 1.0}])
    jet = PolynomialJet(field, parameters=2)
    q0 = 1 / np.sqrt(2)  # |(1, -i)/2|
    assert generalised_hopf(jet).coefficients["l2"] == pytest.approx(-1 / q0**4, rel=1e-12)
    cycle = lpc_predictor(jet)
    rho = 0.1
    b1, b2 = cycle.parameter_shift(rho)
    r = np.abs(cycle.orbit(rho, np.array([0.0, 1.0])) @ [1, 1j])
    np.testing.assert_allclose(r**2, b2 / 2, rtol=1e-12)
    assert b1 == pytest.approx(0.0, abs=1e-15)  # -b2^2/4 is of the neglected order rho^4


CO = ["2*q1*z**2 - 2*q5*x**2 - q3*x*y", "q2*z - q6*y - q3*x*y", "q4*(z - k*s)"]
CO_VALUES = {"q1": 2.5, "q3": 10, "q4": 0.0675, "q5": 1, "q6": 0.1}


def co_oxidation(q2, k, order):
    """Jet of the CO oxidation model (Bykov, Yablonskii and Kim 1978; MatCont's tutorial) at its Hopf point for (q2, k).

    y and z = k s follow from x, so equilibria are zeros of one function of x; of them, the one nearest to Hopf.
    """
    v = CO_VALUES

    def rest(x):
        z = (1 - x) / (1 + 1 / k + q2 / (v["q6"] + v["q3"] * x))
        return z, q2 * z / (v["q6"] + v["q3"] * x)

    def balance(x):
        z, y = rest(x)
        return 2 * v["q1"] * z**2 - 2 * v["q5"] * x**2 - v["q3"] * x * y

    grid = np.linspace(1e-6, 1 - 1e-6, 2001)
    values = balance(grid)
    jets = []
    for i in np.flatnonzero(values[:-1] * values[1:] < 0):
        x = brentq(balance, grid[i], grid[i + 1], xtol=1e-16, rtol=1e-15)
        z, y = rest(x)
        formulas = [f.replace("z", "(1 - x - y - s)") for f in CO]
        at = {"x": x, "y": y, "s": z / k, "q2": q2, "k": k}
        jets.append(taylor_jet(["x", "y", "s"], ["q2", "k"], formulas, at, order=order, **v))

    def distance(jet):
        pairs = [e for e in np.linalg.eigvals(jet.A) if e.imag > 0]
        return min((abs(e.real) for e in pairs), default=np.inf)

    return min(jets, key=distance)


def test_co_oxidation_hopf_points():
    # acceptance values (equilibria.py), from an independent program; MatCont's tutorial prints 2.108977e+02
    jet = co_oxidation(1.051557462458, 0.4, 3)
    assert hopf(jet).coefficients["l1"] == pytest.approx(210.8976526711, rel=1e-8)
    jet = co_oxidation(1.040991569533, 0.4, 3)
    assert complex(*hopf(jet).coefficients["c1"]) == pytest.approx(4.331378978213 - 15.43562244926j, rel=1e-8)


@pytest.mark.parametrize(
    ("q2", "k", "l2"),
    [(0.8913189807743, 0.232487354203, -776.9003443443), (0.9242550152186, 0.3058792674779, -240.1233877076)],
)
def test_co_oxidation_second_lyapunov_coefficients(q2, k, l2):
    # acceptance values (loci.py), from an independent program
    assert generalised_hopf(co_oxidation(q2, k, 5)).coefficients["l2"] == pytest.approx(l2, rel=1e-6)
