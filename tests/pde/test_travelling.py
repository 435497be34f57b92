"""Waves on circles in the frame that moves with them: velocity, eigenvalues, where they branch off."""

import numpy as np
import pytest

import contin

C1, C2 = 0.5, -0.8


def landau(points, wave=2, **more):
    """A_t = (mu + i) A + (1 + i c1) A_xx - (1 + i c2) |A|^2 A on a circle; A = a exp(i (k x - w t)), a^2 = mu - k^2."""
    square = "(u^2 + v^2)"
    return contin.load({
        "name": "waves", "kind": "pde", "domain": {"x": {"to": "2*pi", "points": points, "method": "fourier"}},
        "fields": {"u": f"2*cos({wave}*x)", "v": f"2*sin({wave}*x)"},
        "parameters": {"mu": {"value": 8, "range": [5, 12]}, "c1": C1, "c2": C2},
        "equations": {
            "u": f"mu*u - v + dxx(u) - c1*dxx(v) - {square}*(u - c2*v)",
            "v": f"mu*v + u + dxx(v) + c1*dxx(u) - {square}*(v + c2*u)",
        },
        "travelling": {"axis": "x", "velocity": "speed", "like": {"u": f"cos({wave}*x)", "v": f"sin({wave}*x)"}},
        **more,
    })  # fmt: skip


def test_plane_waves_have_their_velocity_and_eigenvalues():
    k, problem = 2, landau(16)
    line = contin.continuation(problem, "mu", (6, 11), settings={"steps": 20})
    mu = line.columns["mu"]
    frequency = -1 + C1 * k**2 + C2 * (mu - k**2)
    np.testing.assert_allclose(line.columns["speed"], frequency / k, rtol=1e-9)
    np.testing.assert_allclose(line.columns["u.norm"], np.sqrt((mu - k**2) / 2), rtol=1e-9)
    # perturbations a exp(i(kx - wt)) (1 + x exp(l t + i q x) + conj(y) exp(conj(l) t - i q x)), in the moving frame
    row, a2 = -1, mu[-1] - k**2
    jacobian = problem.jacobian(line.z[row, :-1], {"mu": mu[row], "c1": C1, "c2": C2}).toarray()
    found = np.linalg.eigvals(jacobian)
    exact = []
    for q in (-2, -1, 1, 2):
        own = [-(1 + 1j * C1) * ((k + q) ** 2 - k**2), -(1 - 1j * C1) * ((k - q) ** 2 - k**2)]
        reaction = (1 + 1j * C2) * a2
        matrix = np.array([[own[0] - reaction, -reaction], [-np.conj(reaction), own[1] - np.conj(reaction)]])
        exact += list(np.linalg.eigvals(matrix) + 1j * q * line.columns["speed"][row])
    gaps = [np.abs(found - value).min() for value in exact]
    assert max(gaps) < 1e-7
    assert np.abs(found + 1.0).min() < 1e-9  # translations, brought back to the given phase


def test_jacobian_in_the_moving_frame_is_the_derivative():
    problem = landau(8)
    d, p, rng = problem.discretised, dict(problem.values), np.random.default_rng(4)
    u, v = problem.u0 + 0.1 * rng.normal(size=d.n), rng.normal(size=d.n)
    slope = d.value(u + 1e-30j * v, p).imag / 1e-30
    np.testing.assert_allclose(d.jacobian(u, p) @ v, slope, rtol=1e-10, atol=1e-10 * np.abs(slope).max())
    by_parameter = d.value(u.astype(complex), {**p, "mu": p["mu"] + 1e-30j}).imag / 1e-30
    np.testing.assert_allclose(d.forms(u, p, [(0 * u, {"mu": 1.0})]), by_parameter, rtol=1e-10, atol=1e-12)


def test_kuramoto_sivashinsky_steady_waves_are_mirror_symmetric_until_they_travel():
    # u_t = -nu u_xxxx - u_xx - u u_x on a circle: steady waves from nu = 1 on, u ~ a sin x, do not travel
    problem = contin.load({
        "name": "ks", "kind": "pde", "domain": {"x": {"to": "2*pi", "points": 24, "method": "fourier"}},
        "fields": {"u": "-sin(x)"}, "parameters": {"nu": {"value": 0.8, "range": [0.5, 0.95]}},
        "equations": {"u": "-nu*dxxxx(u) - dxx(u) - u*dx(u)"},
        "travelling": {"axis": "x", "like": {"u": "-sin(x)"}},
    })  # fmt: skip
    line = contin.continuation(problem, "nu", (0.5, 0.95), settings={"steps": 20})
    assert np.abs(line.columns["c"]).max() < 1e-8
    # near onset u = a sin x + b sin 2x with a^2 = 24 (1 - nu)(...): -u u_x couples them; b (16 nu - 4) = -a^2/2, ...
    nu = float(line.columns["nu"].max())
    b = 2 * (1 - nu)
    a = np.sqrt(2 * b * (16 * nu - 4))
    assert line.columns["u.norm"][np.argmax(line.columns["nu"])] == pytest.approx(np.hypot(a, b) / np.sqrt(2), rel=0.02)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"axis": "y"}, "waves travel along a periodic axis: y is none; periodic are x"),
        ({"like": {"u": "1"}}, "does not change along x: write one, as in cos(x)"),
        ({"velocity": "mu"}, "mu is declared already"),
        ({"like": {"w": "x"}}, "travelling.like.w: not a field"),
    ],
)
def test_mistakes(change, message):
    given = {"axis": "x", "velocity": "c", "like": {"u": "cos(x)"}, **change}
    with pytest.raises(contin.InputError, match="travelling") as error:
        landau(8, travelling=given)
    assert message in str(error.value)
