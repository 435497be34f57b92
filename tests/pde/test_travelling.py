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
    # forms of order k are derivatives of those of order k - 1 along the last direction
    known = [(rng.normal(size=d.n), {"mu": 0.3, "c1": -0.2}), (rng.normal(size=d.n), {"mu": 0.1})]
    for k in (1, 2):
        rates = {name: value + 1e-30j * known[0][1].get(name, 0.0) for name, value in p.items()}
        slope = d.forms(u + 1e-30j * known[0][0], rates, [*known[1:k], (v, {"c2": 1.0})]).imag / 1e-30
        found = d.forms(u, p, [*known[:k], (v, {"c2": 1.0})])
        np.testing.assert_allclose(found, slope, rtol=1e-9, atol=1e-10 * np.abs(slope).max())
    by_parameter = d.value(u.astype(complex), {**p, "mu": p["mu"] + 1e-30j}).imag / 1e-30
    np.testing.assert_allclose(d.forms(u, p, [(0 * u, {"mu": 1.0})]), by_parameter, rtol=1e-10, atol=1e-12)


def kuramoto_sivashinsky(**more):
    """u_t = -nu u_xxxx - u_xx - u u_x on a circle: steady waves near a sin x + b sin 2x from nu = 1 on."""
    return contin.load({
        "name": "ks", "kind": "pde", "domain": {"x": {"to": "2*pi", "points": 24, "method": "fourier"}},
        "fields": {"u": "-2.6*sin(x)"}, "parameters": {"nu": {"value": 0.8, "range": [0.2, 0.95]}, "average": 0},
        "equations": {"u": "-nu*dxxxx(u) - dxx(u) - u*dx(u)"},
        "conserved": {"u": "average"},
        "travelling": {"axis": "x", "like": {"u": "-sin(x) - sin(2*x)"}},
        **more,
    })  # fmt: skip


@pytest.mark.seldom
def test_kuramoto_sivashinsky_waves_stand_still_until_they_branch_off_and_travel():
    problem = kuramoto_sivashinsky()
    line = contin.continuation(problem, "nu", (0.28, 0.95), settings={"steps": 40})
    assert np.abs(line.columns["c"]).max() < 1e-8
    top = int(np.argmax(line.columns["nu"]))
    nu = line.columns["nu"][top]
    b = 2 * (1 - nu)
    a = np.sqrt(2 * b * (16 * nu - 4))
    assert line.columns["u.norm"][top] == pytest.approx(np.hypot(a, b) / np.sqrt(2), rel=0.02)
    birth = line["BP1"]
    waves = contin.continuation(birth.switch(), "nu", (0.28, 0.95), settings={"steps": 10})
    speed = waves.columns["c"]
    row = int(np.argmax(np.abs(speed)))
    assert abs(speed[row]) > 0.3
    # the wave solves the equations as they are written, -nu D^4 u - D^2 u - u D u = -c D u, D exact on Fourier modes
    u, here = waves.z[row, :-1], waves.columns["nu"][row]
    modes = 1j * np.fft.fftfreq(24, 1 / 24)
    modes[12] = 0.0

    def derivative(v, order=1):
        return np.fft.ifft(modes**order * np.fft.fft(v)).real

    # where waves begin to travel, the zero eigenvalue of translations is double with one eigenvector (a second method)
    still, nu = birth.z[:-1], birth.z[-1]
    columns = np.eye(24)
    own = np.array([-nu * derivative(e, 4) - derivative(e, 2) - derivative(still * e) - e.mean() for e in columns]).T
    moved = derivative(still)
    assert np.linalg.norm(own @ moved) < 1e-9 * np.linalg.norm(own) * np.linalg.norm(moved)
    left = np.linalg.svd(own)[0][:, -1]
    assert abs(left @ moved) < 1e-7 * np.linalg.norm(moved)
    rest = -here * derivative(u, 4) - derivative(u, 2) - u * derivative(u) + speed[row] * derivative(u)
    assert np.abs(rest).max() < 1e-5 * np.abs(derivative(u, 4)).max()
    assert abs(u.mean()) < 1e-10


def test_a_wave_with_a_mean_is_carried_along_by_it():
    # Galilean invariance: u(x - m t) + m
    still = contin.equilibrium(kuramoto_sivashinsky())
    carried = contin.equilibrium(kuramoto_sivashinsky(), parameters={"average": 0.75})
    np.testing.assert_allclose(carried.u, still.u + 0.75, atol=1e-9)
    problem = kuramoto_sivashinsky()
    assert problem.discretised.velocity(carried.u, {**problem.values, "average": 0.75}) == pytest.approx(0.75, abs=1e-9)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"equations": {"u": "dxx(u) - u^3"}}, "conserved: the equation of u does not conserve its mean on this grid"),
        ({"conserved": {"w": 0}}, "conserved.w: not a field"),
        ({"domain": {"x": {"to": "2*pi", "points": 3001, "periodic": True}}}, "`conserved` makes the Jacobian full"),
    ],
)
def test_mistakes_in_what_is_conserved(change, message):
    with pytest.raises(contin.InputError) as error:
        kuramoto_sivashinsky(**change)
    assert message in str(error.value)


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


def test_states_without_a_velocity_need_not_be_one_where_a_run_starts_elsewhere():
    """The fields' default may be 0, which has no velocity; a start that has none is refused in words."""
    flat = landau(16, fields={"u": 0, "v": 0}, starts={"wave": {"u": "2*cos(2*x)", "v": "2*sin(2*x)"}})
    line = contin.continuation(contin.equilibrium(flat, start="wave"), "mu", (7, 9))
    again = contin.continuation(landau(16), "mu", (7, 9))
    np.testing.assert_allclose(line.columns["speed"], again.columns["speed"], rtol=1e-9)
    with pytest.raises(contin.ContinError, match="has no velocity"):
        contin.equilibrium(flat)
