"""Value, Jacobian and forms of discretised equations against differences; eigenvalues against closed forms."""

import numpy as np
import pytest
from scipy.linalg import eigvals

import contin

ENDS = {"x.start": ["dx(u) = a*u*v - 1", "v = b"], "x.end": ["u = a", "2*dx(v) + b*v = a"]}
SYSTEMS = {
    "differences": {
        "domain": {"x": {"from": 0, "to": 2, "points": 9}},
        "equations": {"u": "dx(u^2*dx(u)) + v*sin(x) + b", "v": "a*dxx(v) - u*v^2 + dx(v)*dx(u)"},
        "boundary": ENDS,
    },
    "chebyshev": {
        "domain": {"x": {"from": -1, "to": 2, "points": 8, "method": "chebyshev"}},
        "equations": {"u": "dxx(u) + exp(a*u)*v", "v": "b*lap(v) - u*v^2 + dx(v)"},
        "boundary": {"x.start": ["dx(u) + 2*u = a*x", "v = b"], "x.end": ["u = a", "dn(v) = b"]},
    },
    "rectangle": {
        "domain": {"x": {"points": 5}, "y": {"to": 2, "points": 6, "method": "chebyshev"}},
        "equations": {"u": "lap(u) + a*v*y", "v": "lap(u*v) - b*v^3 + u if x > 0.3 else lap(v) + u*v"},
        "boundary": {"x.start": ["dn(u) = u*v", "v = 1"], "x.end": ["u = y", "dx(v) = a*u^2"],
                     "y.start": ["u = x", "dy(v) = 1"], "y.end": ["dn(u) + u = b", "v = a*x"]},
    },
    "torus": {
        "domain": {"x": {"to": "2*pi", "points": 6, "method": "fourier"}, "y": {"points": 5, "periodic": True}},
        "equations": {"u": "lap(u) + dxy(u)*v + a*dxx(dxx(v))", "v": "dyyy(u) + sin(u*v) + b"},
    },
}  # fmt: skip


def made(name, **more):
    document = {"name": name, "kind": "pde", "fields": {"u": "0.3", "v": "0.5"}, "parameters": {"a": 0.7, "b": 1.3}}
    return contin.load({**document, **SYSTEMS[name], **more})


@pytest.mark.parametrize("name", SYSTEMS)
def test_jacobian_and_forms_are_the_derivatives_of_the_value(name):
    problem = made(name)
    d, p = problem.discretised, dict(problem.values)
    rng = np.random.default_rng(3)
    u = rng.normal(size=d.n) + 1.0
    v, w, x = rng.normal(size=(3, d.n))
    rates = [{"a": 0.3, "b": -0.8}, {"a": 1.1}, {"b": 0.4}]

    def moved(step, direction, rate):
        return u + step * direction, {k: p[k] + step * rate.get(k, 0.0) for k in p}

    h = 1e-30
    slope = d.value(u + 1j * h * v, p).imag / h
    np.testing.assert_allclose(d.jacobian(u, p) @ v, slope, rtol=1e-10, atol=1e-9 * np.abs(slope).max())
    first = d.value(*moved(1j * h, v, rates[0])).imag / h
    np.testing.assert_allclose(d.forms(u, p, [(v, rates[0])]), first, rtol=1e-10, atol=1e-9 * np.abs(first).max())
    for pairs in ([(v, rates[0]), (w, rates[1])], [(v, rates[0]), (w, rates[1]), (x, rates[2])]):
        *rest, (last, rate) = pairs
        step = 1e-4
        stencil = [(1, 8.0), (-1, -8.0), (2, -1.0), (-2, 1.0)]
        found = sum(k * d.forms(*moved(s * step, last, rate), rest) for s, k in stencil) / (12 * step)
        np.testing.assert_allclose(d.forms(u, p, pairs), found, atol=1e-7 * np.abs(found).max())


def heat(points, boundary, **axis):
    return contin.load({
        "name": "heat", "kind": "pde", "domain": {"x": {"points": points, **axis}}, "fields": {"u": 0},
        "parameters": {"D": 1}, "equations": {"u": "D*dxx(u)"}, "boundary": boundary,
    }).discretised  # fmt: skip


@pytest.mark.parametrize(
    ("boundary", "frequency"),
    [
        ({"all": "u = 0"}, lambda k: k * np.pi),
        ({"all": "dn(u) = 0"}, lambda k: (k - 1) * np.pi),
        ({"x.start": "u = 0", "x.end": "dx(u) = 0"}, lambda k: (k - 0.5) * np.pi),
    ],
)
def test_eigenvalues_of_heat_conduction(boundary, frequency):
    exact = -np.array([frequency(k) for k in range(1, 5)]) ** 2
    spectral = heat(24, boundary, method="chebyshev")
    found = np.sort(eigvals(spectral.jacobian(np.zeros(spectral.n), {"D": 1.0}).toarray()).real)[::-1][:4]
    np.testing.assert_allclose(found, exact, atol=1e-9)
    errors = []
    for points in (41, 81):
        mesh = heat(points, boundary)
        found = np.sort(eigvals(mesh.jacobian(np.zeros(mesh.n), {"D": 1.0}).toarray()).real)[::-1]
        errors.append(abs(found[3] - exact[3]))
        h = 1.0 / (points - 1)  # of the discrete problem
        np.testing.assert_allclose(found[:4], -(2 - 2 * np.cos(np.sqrt(-exact) * h)) / h**2, rtol=1e-9, atol=1e-8)
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.02)


def test_condition_with_own_value_robin_in_both_methods():
    # u'' on (0, 1), u(0) = 0, u'(1) + 2 u(1) = 0: tan(w) = -w/2
    from scipy.optimize import brentq

    w = brentq(lambda w: np.sin(w) + 0.5 * w * np.cos(w), 1.6, 3.1)
    boundary = {"x.start": "u = 0", "x.end": "dx(u) + 2*u = 0"}
    spectral = heat(20, boundary, method="chebyshev")
    assert eigvals(spectral.jacobian(np.zeros(spectral.n), {"D": 1.0}).toarray()).real.max() == pytest.approx(-(w**2))
    errors = []
    for points in (21, 41):
        mesh = heat(points, boundary)
        errors.append(eigvals(mesh.jacobian(np.zeros(mesh.n), {"D": 1.0}).toarray()).real.max() + w**2)
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.05)
