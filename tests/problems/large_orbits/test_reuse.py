"""Oscillations of the Ginzburg-Landau equation on a rectangle: beside an explicit method, and what they cost."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import contin
from contin.continuation.sample import Frame, Sample
from contin.continuation.settings import Settings
from tests.problems.large_orbits.cycles import GinzburgLandau

INTERVALS = 20
MESH = 1e-5  # error of so many, of order 5, in orbits that are nearly harmonic


@pytest.fixture(scope="module")
def plate():
    return GinzburgLandau(9, 5)


@pytest.fixture(scope="module")
def waves(plate):
    rest = contin.continuation(plate.model(), "r", (0.2, 1.2 * plate.hopf), settings={"stop_at": ["HB"]})
    assert rest["HB1"].values["r"] == pytest.approx(plate.hopf, rel=1e-10)
    return contin.continuation(
        rest["HB1"].switch(), "r", (0.5 * plate.hopf, 1.2 * plate.hopf),
        settings={"steps": 10, "intervals": INTERVALS},
    )  # fmt: skip


@pytest.mark.seldom
def test_an_orbit_and_its_multipliers_are_those_of_an_explicit_method(plate, waves):
    model, z = plate.model(), waves.z[-1]
    n, p, period = 2 * plate.nx * plate.ny, {"r": float(z[-1])}, float(z[-2])
    assert waves.columns["r"][-1] < plate.hopf  # subcritical

    def rate(t, x):
        wide = x.reshape(n, n + 1)
        u = wide[:, 0]
        return np.column_stack([model.residual(u, p), model.jacobian(u, p) @ wide[:, 1:]]).ravel()

    start = np.column_stack([waves.problem.beginning(z), np.eye(n)]).ravel()
    end = solve_ivp(rate, (0, period), start, method="DOP853", rtol=1e-9, atol=1e-10).y[:, -1].reshape(n, n + 1)
    size = waves.columns["largest.max"][-1]
    np.testing.assert_allclose(end[:, 0], waves.problem.beginning(z), atol=MESH * size)
    exact = np.linalg.eigvals(end[:, 1:])
    exact = exact[np.argsort(-np.abs(exact))][:3]
    np.testing.assert_allclose(np.sort(waves.eigenvalues[-1][:3].real), np.sort(exact.real), atol=MESH)
    assert waves.columns["unstable"][-1] == 1


def test_two_sets_of_factors_a_row_and_a_few_times_round_the_orbit_a_correction(waves):
    """Every correction had factors of its own, every solve a Krylov space: 4.6 sets and 150 rounds a row."""
    rows = len(waves) - 1
    assert waves.effort["factorisations"] / INTERVALS <= 3.2 * rows
    assert waves.effort["applications"] / INTERVALS <= 80 * rows


@pytest.mark.seldom
def test_a_march_answers_as_if_nothing_had_been_asked_between(waves):
    """Factors and Krylov spaces go from chunk to chunk: what is asked elsewhere changes no digit."""
    problem, z = waves.problem, waves.z[8]
    scale = problem.initial_scale(z, (0.0, 10.0))
    tangent = problem.tangents(z, scale)[0]
    settings = Settings.of({"steps": 10, "intervals": INTERVALS})
    start = Sample(z, tangent, np.zeros(5), 0, np.zeros(0, complex))
    origin = problem.probe(start, 0.0, z, Frame(scale), settings)

    def two_chunks(between):
        first = problem.march(origin, None, 0.0, Frame(scale), 0.01, 1, (0.0, 10.0), settings, None)
        if between:
            problem.probe(origin, 0.02, origin.z + 0.02 * scale * origin.tangent, Frame(scale), settings)
            problem.multipliers(waves.z[-1])
        frame = Frame(scale, gauge=first.gauge)
        return problem.march(
            first.sample(-1), first.sample(-2), 0.01, frame, 0.01, 1, (0.0, 10.0), settings, None
        )  # fmt: skip

    plain, disturbed = two_chunks(False), two_chunks(True)
    np.testing.assert_array_equal(plain.z, disturbed.z)
    np.testing.assert_array_equal(plain.eigenvalues, disturbed.eigenvalues)
