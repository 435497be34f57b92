"""ZH and HH beyond dense sizes: closed forms at 600 and 2000 states, the dense way at few, errors beside a pole."""

from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.sparse as sp

import contin
from contin.loci.sparse.curve import LargeCurve
from contin.loci.sparse.forced import is_forced
from contin.loci.sparse.large_forms import large_form
from contin.loci.sparse.large_manifold import pair_of
from contin.normalforms.hopf_hopf import hopf_hopf
from contin.normalforms.sources import compiled_jet
from contin.normalforms.zero_hopf import zero_hopf
from tests.loci.sparse import planted

G, PUSH = planted.STATIC, 1.4
WIDTHS = np.ones(2)


def at_origin(function, locus="HB", kappa=PUSH**2, known=()):
    """A curve of these points, its unknowns at u = 0 = p = q, and the eigenvectors nearly."""
    origin = contin.equilibrium(function).seed("p").problem
    curve = LargeCurve(locus, origin, 0, 1)
    z = np.concatenate([np.zeros(origin.n), [kappa] if locus == "HB" else [], np.zeros(2)])
    found = {"omegas": [], "pairs": []}
    values, vectors = nearly(curve.linear_at(z), known)
    for value, q in zip(values, vectors, strict=True):
        if value.imag > 0:
            found["omegas"].append(value.imag)
            found["pairs"].append(q)
        else:
            found["null"] = q.real
    return SimpleNamespace(curve=curve, n=origin.n, locus=locus), z, found


def nearly(linear, wanted):
    mass = None if linear.mass is None else linear.mass
    ones = np.ones(linear.matrix.shape[0])
    found = [sp.linalg.eigs(linear.matrix, 1, M=mass, sigma=w + 0.01, v0=ones) for w in wanted]
    return [complex(round(v[0].real, 9), round(v[0].imag, 9)) for v, _ in found], [q[:, 0] for _, q in found]


def form(function, type_, known, locus="HB", drift=0.0):
    problem, z, found = at_origin(function, locus, known=known)
    return large_form(problem, type_, z, found, WIDTHS, drift * np.ones(z.size))


def double(m, **options):
    return form(planted.double_hopf(m, **options), "HH", (1.0j, 2.3j))


def zero(m, **options):
    return form(planted.zero_hopf(m, **options), "ZH", (0.0, 1.4j), "LP")


@cache
def dense(kind, m):
    system = (planted.double_hopf if kind == "HH" else planted.zero_hopf)(m).system()
    jet = compiled_jet(system, np.zeros(system.n), np.zeros(2))
    return hopf_hopf(jet) if kind == "HH" else zero_hopf(jet, PUSH)


@pytest.mark.parametrize("m", [4, 20])
@pytest.mark.parametrize("kind", ["HH", "ZH"])
def test_both_ways_give_the_same_coefficients(kind, m):
    large, small = (double if kind == "HH" else zero)(m), dense(kind, m)
    assert set(large) == set(small.coefficients) | {"errors"}
    for key, value in small.coefficients.items():
        if not isinstance(value, str):
            np.testing.assert_allclose(large[key], value, rtol=1e-9, atol=1e-9)
    for key, error in large["errors"].items():
        assert abs(np.subtract(large[key], small.coefficients[key])).max() <= error < 1e-7


@pytest.mark.parametrize(("m", "mass"), [(596, False), (1996, True)])
@pytest.mark.seldom
def test_a_double_hopf_point_of_many_states_has_its_closed_form(m, mass):
    found = double(m, mass=mass)
    p11, p12, p21, p22 = -1.3 + G / 2, -0.6 + G, 0.4 + G / 4, -0.7 + G / 2  # for amplitudes in other units
    assert found["theta"] == pytest.approx(p12 / p22, rel=1e-9)
    assert found["delta"] == pytest.approx(p21 / p11, rel=1e-9)
    assert found["G2100"][1] / found["p11"] == pytest.approx(2 * 0.3 / p11, rel=1e-9)
    assert found["case"] == "simple case III"


@pytest.mark.parametrize(("m", "mass"), [(597, True), (1997, False)])
def test_a_zero_hopf_point_of_many_states_has_its_closed_form(m, mass):
    """x = G (|z|^2 + 2 w^2) gives w' the terms G |z|^2 w/2 + G w^3, z' those 0.7 G (|z|^2 + 2 w^2) z."""
    found = zero(m, mass=mass)
    c, squared = found["G200"] / 2, -found["G011"]  # units of w, squares of those of z in them
    assert found["theta"] == pytest.approx(0.8, rel=1e-9)
    assert found["G110"][0] == pytest.approx(0.8 * c, rel=1e-9)
    assert found["G300"] == pytest.approx(6 * G * c * c, rel=1e-8)
    assert found["G111"] == pytest.approx(G / 2 * squared * c, rel=1e-8)
    assert found["G210"][0] == pytest.approx(2 * (1 + 1.4 * G) * c * c, rel=1e-8)
    assert found["G021"][0] == pytest.approx(2 * 0.7 * G * squared * c, rel=1e-8)
    assert found["s"] == -1


@pytest.mark.parametrize(("m", "mass"), [(5, True), (597, False)])
def test_on_an_invariant_plane_the_amplitudes_have_their_closed_form(m, mass):
    found = form(planted.on_plane(m, mass=mass), "ZH", (0.0, 1.4j))
    assert found["case"] == "Hopf-transcritical (invariant plane): no torus"
    b, c, d, e = found["amplitudes"].values()
    assert d / b == pytest.approx(-0.5 / 0.6, rel=1e-9)
    answer = G if m > 100 else np.linalg.inv(-planted.chain(m).toarray())[0, 0]
    assert c / e == pytest.approx((-0.9 + answer / 2) / (-0.3 + answer / 4), rel=1e-8)


def test_whether_a_parameter_unfolds_a_zero_eigenvalue_does_not_depend_on_how_fine_a_mesh_is():
    """|A| grows with its square: a parameter that pushes one cell of 300 was taken for none."""
    n = 300
    line = sp.diags_array([np.ones(n - 1), -2 * np.ones(n), np.ones(n - 1)], offsets=[-1, 0, 1]) * (n + 1.0) ** 2
    ground = (2 * (n + 1) * np.sin(np.pi / 2 / (n + 1))) ** 2
    pushed = np.eye(1, n, n // 2)[0]
    for slope, forced in ((1.0, False), (0.0, True)):
        function = contin.FunctionProblem(
            lambda u, p, slope=slope: line @ u + ground * u - u**3 + slope * p["p"] * pushed + p["q"] * u,
            np.zeros(n), {"p": 0.0, "q": 0.0},
            jacobian=lambda u, p: (line + sp.diags_array(ground + p["q"] - 3 * u**2)).tocsc(),
        )  # fmt: skip
        problem, z, _ = at_origin(function)
        linear = problem.curve.linear_at(z)
        pair = pair_of(linear, 0.0, np.sin(np.pi * np.arange(1, n + 1) / (n + 1)))
        assert is_forced(problem, z, linear, pair, WIDTHS) == forced


@pytest.mark.seldom
def test_beside_a_resonance_errors_tell_how_far_the_matrix_is_known():
    """z1' = i z1 + ..., z2' = (-d + 2 i) z2: c1 has a pole 1/d, and digits go as those of 2 i in units of d."""
    n = 6

    def bautin(d):
        def residual(u, p):
            w, v, a, b = u[:4]
            s = w * w + v * v
            r, t = p["p"] + p["q"] * s - s * s + 0.3 * a, 1.0 + 0.2 * b
            pair = [r * w - t * v, r * v + t * w, -d * a - 2 * b + w * w - v * v, 2 * a - d * b + 2 * w * v]
            return np.concatenate([pair, -u[4:] * (1 + s)])

        def jacobian(u, p):
            columns = [np.imag(residual(u + 1e-30j * e, p)) / 1e-30 for e in np.eye(n)]
            return sp.csc_matrix(np.array(columns).T)

        return contin.FunctionProblem(residual, np.zeros(n), {"p": 0.0, "q": 0.0}, jacobian=jacobian)

    near, far = (form(bautin(d), "GH", (1j,), drift=1e-12) for d in (1e-4, 1.0))
    assert far["errors"]["l2"] < 1e-7 * max(abs(far["l2"]), 1.0)
    shifted = form(bautin(1e-4 + 1e-12), "GH", (1j,))
    assert near["errors"]["l2"] > abs(shifted["l2"] - near["l2"]) > 1e-9 * abs(near["l2"])


def test_the_error_of_a_first_coefficient_beside_a_resonance_counts_the_matrix():
    """z' = (p + i) z + 0.3 c z*, c' = (-d + 2 i) c + z^2: l1 = 0.6/d, and d is known to rounding."""

    def residual(u, p):
        w, v, a, b = u
        pair = [p["p"] * w - v + 0.3 * (a * w + b * v), p["p"] * v + w + 0.3 * (b * w - a * v)]
        return np.array([*pair, -p["d"] * a - 2 * b + w * w - v * v, 2 * a - p["d"] * b + 2 * w * v])

    def jacobian(u, p):
        return sp.csc_matrix(np.array([np.imag(residual(u + 1e-30j * e, p)) / 1e-30 for e in np.eye(4)]).T)

    for d, most in ((1.0, 1e-9), (1e-7, 0.1)):
        function = contin.FunctionProblem(residual, np.zeros(4), {"p": -0.1, "d": d}, jacobian=jacobian)
        form = contin.continuation(function, "p", (-0.1, 0.1))["HB1"].normal_form
        assert form["l1"] == pytest.approx(0.3 / d * 2, rel=1e-7)
        assert form["errors"]["l1"] > 0.3 / d * (2.2e-16 / d)  # was a tenth of that
        assert form["errors"]["l1"] < most
