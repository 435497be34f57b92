"""Orbits that return moved along their circle, as orbits in the frame of `travelling`."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import contin
from contin.systems.functions.moving_frame import MovingFrame

L, POINTS = 22.0, 24
# modes 1 .. 11 of u = sum of 2 Re a_k exp(i k x), on the shortest relative periodic orbit
RPO = [
    -0.06212, -0.15402, -0.12325, -0.24293, -0.50445, -0.63266, 0.26179, 0.24463, 0.09025, 0.03983, 0.06185,
    0.01269, -0.05354, -0.0036, -0.00216, 0.00193, 4e-05, 0.00023, 0.00283, -0.00204, -0.00037, 0.00022,
]  # fmt: skip


def flame(**more):
    """u_t = -u u_y - u_yy - u_yyyy on a circle of length L, y = L x/(2 pi)."""
    return contin.load({
        "name": "flame", "kind": "pde", "domain": {"x": {"to": "2*pi", "points": POINTS, "method": "fourier"}},
        "fields": {"u": "sin(x)"}, "parameters": {"L": L},
        "equations": {"u": "-(2*pi/L)^4*dxxxx(u) - (2*pi/L)^2*dxx(u) - (2*pi/L)*u*dx(u)"},
        "conserved": {"u": 0}, "travelling": {"axis": "x", "like": {"u": "cos(x)"}}, **more,
    })  # fmt: skip


def at_rest(u, period, samples, points=POINTS, length=L):
    """Trajectory (samples, points) of the equations as they are written, by Fourier's series and DOP853."""
    k = np.fft.rfftfreq(points, 1.0 / points)
    q = 2.0 * np.pi / length * k
    slope = 1j * q * (k < points // 2)

    def rate(t, v):
        a = np.fft.rfft(v)
        found = np.fft.irfft((q**2 - q**4) * a, points) - v * np.fft.irfft(slope * a, points)
        return found - found.mean()

    times = np.linspace(0.0, period, samples)
    run = solve_ivp(rate, (0.0, period), u, method="DOP853", rtol=1e-9, atol=1e-11, t_eval=times)
    return times, run.y.T


def moved(u, distance):
    """u(x - distance) on a circle of length 2 pi."""
    return np.fft.irfft(np.fft.rfft(u) * np.exp(-1j * distance * np.fft.rfftfreq(len(u), 1.0 / len(u))), len(u))


@pytest.mark.seldom
def test_the_shortest_relative_orbit_of_kuramoto_sivashinsky_at_22():
    """Cvitanovic, Davidchack and Siminos, SIAM J. Appl. Dyn. Syst. 9 (2010) 1: T = 16.3149, which moves it by 2.863.

    From samples of the equations at rest, which return moved. Of the multipliers one is 1 (time), one exp(-T), in the
    place of the 1 of translations, and one outside the circle, ln 210/T = .328 (there, table of leading exponents).
    """
    x = 2.0 * np.pi * np.arange(POINTS) / POINTS
    a = np.array(RPO[0::2]) + 1j * np.array(RPO[1::2])
    start = 2.0 * (a @ np.exp(1j * np.outer(np.arange(1, len(a) + 1), x))).real
    times, samples = at_rest(start, 16.315, 41)
    problem = flame()
    orbit = contin.periodic_orbit(problem, samples, times=times, intervals=25)
    seed = orbit.seed("L")
    family, columns = seed.problem, seed.problem.columns(seed.z[None])
    (period,), (distance,) = columns["period"], columns["c.integral"]
    assert period == pytest.approx(16.3149, abs=0.03)
    assert distance * L / (2.0 * np.pi) == pytest.approx(2.8634, abs=0.01)
    values = family.multipliers(seed.z)
    assert np.sum(np.abs(values - 1.0) < 0.01) == 1
    assert np.sum(np.abs(values) > 1.01) == 1
    assert np.log(np.abs(values).max()) / period == pytest.approx(0.328, abs=0.003)
    assert np.abs(values - np.exp(-period)).min() < 0.1 * np.exp(-period)
    u = family.profile(seed.z).u[0]
    _, back = at_rest(u, period, 2)
    assert np.abs(back[-1] - moved(u, distance)).max() < 0.02 * np.abs(u).max()  # errors grow 210 times
    assert np.abs(back[-1] - u).max() > 0.5 * np.abs(u).max()


def test_the_frame_is_the_phase_of_the_given_wave_and_moves_with_what_keeps_it():
    """<w_x, u>' = -<w_x, u> on every state, so that orbits have no folds of the frame's own."""
    problem = flame()
    d, p, rng = problem.discretised, problem.values, np.random.default_rng(3)
    u = np.sin(2.0 * np.pi * np.arange(POINTS) / POINTS + 0.4) + 0.2 * rng.normal(size=POINTS)
    t = -np.sin(2.0 * np.pi * np.arange(POINTS) / POINTS)
    assert t @ d.value(u, p) == pytest.approx(-(t @ u), rel=1e-9)
    np.testing.assert_allclose(problem.in_frame(moved(u, 1.0)[None])[0] @ t, 0.0, atol=1e-9 * np.abs(u).sum())


def test_states_without_a_phase_are_refused_in_words():
    with pytest.raises(contin.ContinError, match="no phase in the frame of `travelling`"):
        contin.equilibrium(flame(), start={"u": "sin(2*x)"})


def test_a_phase_that_is_hardly_defined_is_a_note():
    frame = MovingFrame("c", lambda u: u[:, 0], "write another")
    assert frame.weakness(np.array([[1.0], [0.4]])) is None
    assert "falls to 0.01 of" in frame.weakness(np.array([[1.0], [0.01]]))
    assert "changes its sign" in frame.weakness(np.array([[1.0], [-0.3]]))
