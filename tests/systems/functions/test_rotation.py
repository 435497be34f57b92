"""Functions with a rotation: waves with their rate, eigenvalues without the rotation's, orbits that return turned."""

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.integrate import solve_ivp
from scipy.sparse.linalg import LinearOperator

import contin
from contin.errors import InputError, InputWarning
from contin.systems.functions.turning_frame import FunctionInFrame

C1, C2 = 0.5, -0.8


def spectral(points):
    """d/dx on a circle of length 2 pi, from the Fourier series."""
    k = np.fft.fftfreq(points, 1.0 / points) * (np.arange(points) != points // 2)
    return np.real(np.fft.ifft(1j * k[:, None] * np.fft.fft(np.eye(points), axis=0), axis=0))


def landau(way, points=16, generator=None):
    """A_t = (mu + i) A + (1 + i c1) A_xx - (1 + i c2) |A|^2 A on a circle; A = a exp(i (x - w t)), a^2 = mu - 1."""
    D, x = spectral(points), 2.0 * np.pi * np.arange(points) / points
    D2, one = D @ D, np.eye(points)

    def f(u, p):
        v, w = u[:points], u[points:]
        square = v * v + w * w
        return np.concatenate([
            p["mu"] * v - w + D2 @ (v - C1 * w) - square * (v - C2 * w),
            p["mu"] * w + v + D2 @ (w + C1 * v) - square * (w + C2 * v),
        ])  # fmt: skip

    def J(u, p):
        v, w = u[:points], u[points:]
        square, a, b = v * v + w * w, v - C2 * w, w + C2 * v
        rows = [
            [p["mu"] * one + D2 - np.diag(square + 2 * v * a), -one - C1 * D2 + np.diag(C2 * square - 2 * w * a)],
            [one + C1 * D2 - np.diag(C2 * square + 2 * v * b), p["mu"] * one + D2 - np.diag(square + 2 * w * b)],
        ]
        return np.block(rows)

    jacobian = {
        "value": None,
        "dense": J,
        "sparse": lambda u, p: sp.csc_matrix(J(u, p)),
        "products": lambda u, p: LinearOperator((2 * points,) * 2, matvec=lambda v: J(u, p) @ np.ravel(v), dtype=float),
    }[way]
    G = sp.block_diag([D, D]) if generator is None else generator(D, x)
    more = {} if way != "products" else {
        "preconditioner": lambda u, p: lambda r: np.linalg.solve(J(u, p) - np.eye(2 * points), r)
    }  # fmt: skip
    u0 = np.concatenate([2 * np.cos(x), 2 * np.sin(x)])
    return contin.FunctionProblem(f, u0, {"mu": 8.0}, jacobian, rotation=G, name="waves", **more)


@pytest.mark.parametrize("way", ["value", "dense", "sparse", "products"])
def test_plane_waves_have_their_rate_however_the_function_is_given(way):
    """u(x - w t) turns at the rate of d/dx, -w."""
    found = contin.equilibrium(landau(way))
    frequency = -1 + C1 + C2 * 7
    (rate,) = found.system.observables(found.u, found.p)[0]
    assert abs(rate + frequency) < 1e-9


def test_eigenvalues_are_those_of_the_wave_and_the_decay_of_the_phase():
    found = contin.equilibrium(landau("sparse"))
    a2, speed = 7, -1 + C1 + C2 * 7
    values = np.linalg.eigvals(found.system.state_jacobian(found.u, found.p))
    exact = [-found.system.model.decay]
    for q in (-1, 1):
        own = [-(1 + 1j * C1) * ((1 + q) ** 2 - 1), -(1 - 1j * C1) * ((1 - q) ** 2 - 1)]
        reaction = (1 + 1j * C2) * a2
        matrix = np.array([[own[0] - reaction, -reaction], [-np.conj(reaction), own[1] - np.conj(reaction)]])
        exact += list(np.linalg.eigvals(matrix) + 1j * q * speed)
    assert max(np.abs(values - one).min() for one in exact) < 1e-8
    assert np.abs(values).min() > 1e-3  # the rotation's own 0 is gone


def test_derivatives_in_the_frame_are_derivatives():
    """Forms of order k along the last direction by complex steps of those of order k - 1, where they are given."""
    points = 4
    D = spectral(points)

    def f(u, p):
        return p["a"] * u + 2.0 * (D @ u) - u * u * u * (1.0 + p["a"] * p["a"])

    def form(u, p, *d):
        n, a, (v, w) = len(u), p["a"], (d[0], d[1])
        rates = [one[n] for one in d]
        if len(d) == 2:
            out = v[:n] * rates[1] + w[:n] * rates[0] - 6.0 * u * v[:n] * w[:n] * (1.0 + a * a)
            out = out - 3.0 * u * u * (v[:n] * rates[1] + w[:n] * rates[0]) * 2.0 * a
            return out - u**3 * 2.0 * rates[0] * rates[1]
        states, out = [one[:n] for one in d], -6.0 * np.prod([one[:n] for one in d], axis=0) * (1.0 + a * a)
        for i, j, k in ((0, 1, 2), (0, 2, 1), (1, 2, 0)):
            out = out - 6.0 * u * states[i] * states[j] * 2.0 * a * rates[k]
            out = out - 3.0 * u * u * states[k] * 2.0 * rates[i] * rates[j]
        return out

    G = D.copy()
    problem = contin.FunctionProblem(f, np.ones(points), {"a": 1.0}, rotation=G, derivative=form)
    rng = np.random.default_rng(2)
    u, directions = rng.normal(size=points), [rng.normal(size=points + 1) for _ in range(3)]
    frame = FunctionInFrame(problem, problem.rotation, problem.rotation.mode_of(u[None]), u, np.array([1.0]))
    system = frame.system()
    given = [frame.derivative(u, {"a": 1.0}, *directions[:k]) for k in (2, 3)]
    steps = [system.lines.form(u, np.array([1.0]), tuple(directions[:k])) for k in (2, 3)]
    np.testing.assert_allclose(given[0], steps[0], rtol=1e-9, atol=1e-9 * np.abs(steps[0]).max())
    np.testing.assert_allclose(given[1], steps[1], rtol=1e-6, atol=1e-6 * np.abs(steps[1]).max())


class Flames:
    """u_t = -u u_x - u_xx - u_xxxx on a circle of length L: u = sum over k of a_k exp(2 pi i k x/L), a_k = b_k + i c_k.

    The rotation a_k' = -i k a_k moves u along x by L/(2 pi) for an angle of 1. Products are exact (no aliasing).
    """

    def __init__(self, modes):
        self.modes, self.k = modes, np.arange(1, modes + 1)
        self.points = 3 * modes + 2

    def complex(self, u):
        return u[..., 0::2] + 1j * u[..., 1::2]

    def real(self, a):
        return np.stack([a.real, a.imag], axis=-1).reshape(*a.shape[:-1], -1)

    def waves(self, a):
        full = np.zeros((*a.shape[:-1], self.points), complex)
        full[..., 1 : self.modes + 1] = a
        return 2.0 * np.fft.ifft(full, axis=-1).real * self.points

    def square(self, v, w):
        return np.fft.fft(v * w, axis=-1)[..., 1 : self.modes + 1] / self.points

    def value(self, u, p):
        q, a = 2 * np.pi / p["L"] * self.k, self.complex(u)
        w = self.waves(a)
        return self.real((q**2 - q**4) * a - 0.5j * q * self.square(w, w))

    def jacobian(self, u, p):
        q, unit = 2 * np.pi / p["L"] * self.k, self.complex(np.eye(len(u)))
        w = self.waves(self.complex(u))
        return sp.csc_matrix(self.real((q**2 - q**4) * unit - 1j * q * self.square(w, self.waves(unit))).T)

    def problem(self, u0):
        G = sp.block_diag([np.array([[0.0, k], [-k, 0.0]]) for k in self.k])
        start = np.zeros(2 * self.modes)
        start[: len(u0)] = u0
        return contin.FunctionProblem(self.value, start, {"L": 22.0}, self.jacobian, rotation=G, name="flames")


E1 = [-0.301, -0.282, 0.092, -0.006, -0.135, 0.164, -0.024, -0.181, 0.047, 0.034]
E2 = [0, 0, 0.059, 0.557, 0, 0, 0.073, 0.341, 0, 0, 0.018, 0.054]
E3 = [0, 0, 0, 0, 0, -1.24, 0, 0, 0, 0, 0, 0.224, 0, 0, 0, 0, 0, -0.019]
TW1 = [0.318, 0.298, 0.06, 0.353, -0.074, 0.283, -0.063, 0.21, -0.014, 0.106, -0.007, 0.042, -0.005, 0.017]
TW2 = [0.056, 0.415, -0.21, -0.094, -0.276, 0.429, 0.082, 0.323, 0.005, 0.016, -0.054, 0.017, -0.012, 0.029]


@pytest.mark.parametrize(
    ("start", "velocity", "leading"),
    [
        (E1, 0.0, (0.1308 + 0.3341j, 0.0824 + 0.3402j)),
        (E2, 0.0, (0.1390 + 0.2384j,)),
        (E3, 0.0, (0.0933, 0.0933)),
        (TW1, 0.73699, (0.1156 + 0.8173j, 0.0337 + 0.4189j)),
        (TW2, 0.34954, (0.3370,)),
    ],
)
def test_equilibria_and_waves_of_kuramoto_sivashinsky_at_22(start, velocity, leading):
    """Cvitanovic, Davidchack and Siminos, SIAM J. Appl. Dyn. Syst. 9 (2010) 1: velocities and leading eigenvalues."""
    found = contin.equilibrium(Flames(16).problem(start))
    (rate,) = found.system.observables(found.u, found.p)[0]
    assert abs(abs(rate) * 22.0 / (2.0 * np.pi) - velocity) < 1e-5
    values = np.linalg.eigvals(found.system.state_jacobian(found.u, found.p))
    growing = values[(values.real > 0.0) & (values.imag > -1e-6)]  # one of a pair, and both of a double one
    assert len(growing) == len(leading)
    assert max(np.abs(growing - one).min() for one in leading) < 1.5e-4


@pytest.mark.seldom
def test_waves_that_pulsate_return_turned_and_start_from_samples_of_the_function_itself():
    """Born at a Hopf point of travelling waves. A second integrator, of the function as it is given, brings the first
    state back turned by the mean of the rate; the orbit through its samples has the same period."""
    flames = Flames(8)
    line = contin.continuation(flames.problem(TW1), "L", (18.5, 22.0), settings={"steps": 8, "max_step": 3.0})
    waves = contin.continuation(line["HB1"].switch(), "L", (18.0, 20.0), settings={"steps": 2})
    z = waves.z[-1]
    orbit, p = waves.problem.profile(z), {"L": float(z[-1])}
    run = solve_ivp(
        lambda t, u: flames.value(u, p), (0.0, orbit.period), orbit.u[0], method="DOP853", rtol=1e-10, atol=1e-12,
        t_eval=np.linspace(0.0, orbit.period, 101),
    )  # fmt: skip
    assert abs(waves.columns["rotation_rate.max"][-1] - waves.columns["rotation_rate.min"][-1]) > 1e-3
    first, last = flames.complex(run.y[:, 0]), flames.complex(run.y[:, -1])
    rates = waves.problem.system.observables(orbit.u, np.tile(waves.problem.full_parameters(z), (len(orbit.u), 1)))[
        :, 0
    ]
    angle = orbit.period * np.trapezoid(rates, orbit.times)
    assert abs(waves.columns["rotation_rate.integral"][-1] - angle) < 1e-5
    assert np.abs(last - first * np.exp(-1j * flames.k * angle)).max() < 1e-5
    again = contin.periodic_orbit(flames.problem(run.y[:, 0]), run.y.T, {"L": p["L"]}, times=run.t)
    assert abs(again.period - orbit.period) < 3e-4  # which changes by 13 for a change 1 of L along the family
    values, decay = waves.problem.multipliers(z)[0], np.exp(-waves.problem.system.model.decay * orbit.period)
    assert np.abs(values - decay).min() < 1e-4  # in the place of the rotation's 1


def test_matrices_that_are_no_rotation_are_refused():
    f, start, p = (lambda u, p: p["a"] * u), [1.0, 2.0, 0.5, 0.3], {"a": 1.0}
    with pytest.raises(InputError, match=r"must be a matrix \(4, 4\)"):
        contin.FunctionProblem(f, start, p, rotation=np.eye(3))
    with pytest.raises(InputError, match="eigenvalues off the imaginary axis"):
        contin.equilibrium(contin.FunctionProblem(f, start, p, rotation=np.eye(4)))
    turn = sp.block_diag([[[0, -1], [1, 0]], [[0, -2], [2, 0]]])
    with pytest.raises(InputError, match="not a symmetry of 'bent'"):
        contin.equilibrium(contin.FunctionProblem(lambda u, p: p["a"] - u**2, start, p, rotation=turn, name="bent"))
    free = LinearOperator((4, 4), matvec=lambda v: np.array([-v[1], v[0], 0.0, 0.0]), dtype=float)
    with pytest.raises(InputError, match="needs a wave of one mode"):
        contin.equilibrium(contin.FunctionProblem(f, start, p, rotation=free))


def test_a_rotation_by_differences_is_told_to_be_one_only_about():
    def central(D, x):
        n = len(x)
        d = (np.roll(np.eye(n), 1, axis=1) - np.roll(np.eye(n), -1, axis=1)) / (2.0 * (x[1] - x[0]))
        return sp.block_diag([d, d])

    with pytest.warns(InputWarning, match=r"symmetry to .* only"):
        contin.equilibrium(landau("sparse", points=32, generator=central))


def test_a_given_wave_is_the_phase_and_must_be_of_one_mode():
    def chosen(D, x):
        return sp.block_diag([D, D]), np.concatenate([np.cos(x), np.sin(x)])

    own, given = contin.equilibrium(landau("sparse")), contin.equilibrium(landau("sparse", generator=chosen))
    np.testing.assert_allclose(own.system.observables(own.u, own.p), given.system.observables(given.u, given.p))
    with pytest.raises(InputError, match="not of one mode"):
        contin.equilibrium(
            landau("sparse", generator=lambda D, x: (sp.block_diag([D, D]), np.tile(np.exp(np.sin(x)), 2)))
        )
