"""Orbits of large systems by shooting: the same bifurcations, the flow's derivative, shared factors of intervals."""

import numpy as np
import pytest
from scipy import sparse
from scipy.integrate import solve_ivp
from scipy.sparse.linalg import LinearOperator

import contin
from contin.errors import InputError, NoSolutionError
from contin.linalg.factor import Factoriser
from contin.linalg.tally import Tally
from contin.problems.large_orbits import sweeps
from contin.problems.large_orbits.from_starts import FromStarts, Mesh
from contin.problems.large_orbits.interval import Pattern
from contin.problems.large_orbits.reused import intervals_with_shared_factors
from contin.problems.sparse.large_equilibrium import LargeProblem
from contin.search.large_orbit_from_samples import large_orbit_from_samples
from contin.transitions.large_cycles import large_cycles
from tests.problems.large_orbits.cycles import family, landau, planted

EXACT = {"PD1": 0.25, "NS1": 0.3, "BPC1": 0.4}
ERROR = 1e-6  # steps whose errors are 1e-8 of the amplitude


@pytest.fixture(scope="module")
def shot():
    return family(planted(-1.0, 0.0, exact=True), (-0.1, 0.45), intervals=None, method="shooting", max_step=0.2)


@pytest.mark.seldom
def test_bifurcations_of_cycles_are_where_they_were_planted(shot):
    assert isinstance(shot.problem.layout, FromStarts)
    assert {p.label for p in shot.points} == set(EXACT)
    for point in shot.points:
        assert abs(point.values["mu"] - EXACT[point.label]) < point.error < ERROR
    np.testing.assert_allclose(shot.columns["period"], 2 * np.pi, rtol=ERROR)
    np.testing.assert_allclose(shot.columns["x.max"] ** 2, shot.columns["mu"], atol=ERROR)
    assert shot.columns["unstable"][-1] == 4
    assert shot.z.shape[1] == 7 + 2  # one state, the period, the parameter


@pytest.mark.seldom
def test_families_that_are_born_on_one_by_shooting(shot):
    crossing = contin.continuation(shot["BPC1"].switch(), "mu", (0.2, 0.6), settings={"steps": 2})
    largest = np.maximum(np.abs(crossing.columns["s.max"]), np.abs(crossing.columns["s.min"]))
    np.testing.assert_allclose(largest**2, crossing.columns["mu"] - 0.4, atol=ERROR)
    assert crossing.columns["mu"].max() > 0.4
    doubled = contin.continuation(shot["PD1"].switch(), "mu", (0.2, 0.6), settings={"steps": 1})
    np.testing.assert_allclose(doubled.columns["period"], 4 * np.pi, rtol=ERROR)
    np.testing.assert_allclose(doubled.columns["w1.max"] ** 2, np.sqrt(doubled.columns["mu"]) - 0.5, atol=ERROR)
    assert doubled.problem.layout.segments == 2
    with pytest.raises(InputError, match="a family that is born on one by shooting is followed by shooting"):
        contin.continuation(shot["PD1"].switch(), "mu", (0.2, 0.6), settings={"method": "collocation"})


@pytest.mark.seldom
def test_curves_in_two_parameters(shot):
    curve = contin.continuation(
        shot["PD1"].locus(), ("mu", "a"), {"mu": (0.1, 0.6), "a": (-0.2, 0.2)}, settings={"steps": 2}
    )
    a = curve.columns["a"]
    np.testing.assert_allclose(curve.columns["mu"], (0.5 + a) ** 2 * (1 - a), atol=ERROR)
    assert np.ptp(a) > 0.02


@pytest.mark.long  # every day: the fold from three segments with b, the curve of doublings (test_normal_forms, above)
def test_a_fold_of_cycles_and_its_curve_from_three_segments():
    found = family(
        planted(1.0, -1.0, exact=True), (-0.4, 0.1), intervals=3, method="shooting", max_step=0.2, stop_at=("LPC",)
    )
    fold = found["LPC1"]
    assert found.problem.layout.segments == 3
    assert abs(fold.values["mu"] + 0.25) < fold.error < ERROR
    curve = contin.continuation(fold.locus(), ("mu", "a"), {"mu": (-0.6, 0.1), "a": (-0.4, 0.4)}, settings={"steps": 2})
    np.testing.assert_allclose(curve.columns["mu"], -((1 + curve.columns["a"]) ** 2) / 4, atol=ERROR)


@pytest.mark.seldom
def test_a_family_is_born_whatever_the_phases_of_its_states():
    """The real part of the eigenvector is not normal to the imaginary one: states follow a circular orbit, w' = 2 y - w
    three times and b' = 50 (1.3 y - b) six times, an eighth of a period apart."""

    def residual(u, p):
        x, y, w, b = u[0], u[1], u[2:5], u[5:]
        growth = p["mu"] - x * x - y * y
        return np.concatenate([[growth * x - y, growth * y + x], 2 * y - w, 50 * (1.3 * y - b)])

    pattern = np.eye(11)
    pattern[:, :2] = 1
    model = contin.FunctionProblem(residual, np.zeros(11), {"mu": -0.5}, sparsity=sparse.csc_matrix(pattern))
    line = contin.continuation(model, "mu", (-0.6, 0.2))
    q = line["HB1"].vectors["q"]
    assert abs(q.real @ q.imag) > 0.3 * np.linalg.norm(q.real) * np.linalg.norm(q.imag)
    found = contin.continuation(line["HB1"].switch(), "mu", (-0.1, 1), settings={"steps": 3, "method": "shooting"})
    assert isinstance(found.problem.layout, FromStarts)
    assert len(found) > 3
    np.testing.assert_allclose(found.columns["period"], 2 * np.pi, rtol=ERROR)
    np.testing.assert_allclose(found.columns["u1.max"] ** 2, found.columns["mu"], atol=ERROR)


def test_multipliers_of_a_uniform_oscillation_are_those_in_closed_form():
    points = 6
    line = contin.continuation(landau(points, "differences"), "mu", (-0.2, 0.3), settings={"stop_at": ("HB",)})
    found = contin.continuation(line["HB1"].switch(), "mu", (-0.1, 1), settings={"steps": 2, "method": "shooting"})
    mu = float(found.columns["mu"][-1])
    period = 2 * np.pi / (1 + 0.8 * mu)
    assert found.columns["period"][-1] == pytest.approx(period, rel=ERROR)
    q = (2 - 2 * np.cos(2 * np.pi / points)) * (points / (2 * np.pi)) ** 2  # wave number 1
    root = np.sqrt(complex(mu**2 + 0.8 * mu * q - 0.25 * q * q))
    exact = np.sort([np.exp(-2 * mu * period), *2 * [abs(np.exp(period * (-mu - q + root)))]])[::-1]
    np.testing.assert_allclose(np.abs(found.eigenvalues[-1][1:4]), exact, atol=ERROR)


def test_the_monodromy_action_is_the_derivative_of_the_flow(shot):
    problem, z = shot.problem, shot.z[-1]
    problem.prepare(z)
    sweeps = problem.sweeps(z)
    w = np.random.default_rng(1).normal(size=7)
    ends = [problem.profile(z + np.append(s * w, [0, 0])).U[-1, 2] for s in (1e-5, -1e-5)]
    np.testing.assert_allclose(sweeps.monodromy(w), (ends[0] - ends[1]) / 2e-5, atol=1e-8)
    v = np.random.default_rng(2).normal(size=7)
    assert v @ sweeps.monodromy(w) == pytest.approx(sweeps.transposed(v) @ w, rel=1e-10)


def test_intervals_with_shared_factors_are_solved_to_rounding():
    generator, n = np.random.default_rng(0), 30
    base = sparse.csc_matrix(sparse.random(n, n, 0.1, random_state=0) - sparse.diags(np.arange(1.0, n + 1)))
    base.sort_indices()
    threes = [
        [sparse.csc_matrix((base.data * (1 + 0.1 * generator.normal(size=base.nnz)), base.indices, base.indptr))
         for _ in range(3)] for _ in range(2)
    ]  # fmt: skip
    tally = Tally()
    for three, interval in zip(
        threes, intervals_with_shared_factors([(three, 0.3) for three in threes], tally), strict=True
    ):
        matrix = Pattern.of(base).matrix(three, 0.3)
        right = generator.normal(size=3 * n) + 1j * generator.normal(size=3 * n)
        np.testing.assert_allclose(matrix @ interval.solve(right), right, atol=1e-11)
        np.testing.assert_allclose(matrix.T @ interval.solve_transposed(right), right, atol=1e-11)
    assert tally.factorisations == 2  # a real one and a complex one, for all intervals


def test_factors_are_shared_where_those_of_all_intervals_do_not_fit(monkeypatch):
    """Bands tell how many numbers their factors hold: (2 lower + upper + 1) n; those of 90 rows here fit, or do not."""
    line = sparse.diags([np.ones(29), -2.0 * np.ones(30), np.ones(29)], [-1, 0, 1], format="csc")
    kinds, moved = [], []
    for numbers in (16 * 90 * 4, 90):
        monkeypatch.setattr(sweeps, "NUMBERS", numbers)
        made = sweeps.Sweeps.of([line] * 12, np.full(4, 0.1), Factoriser())
        kinds.append([type(one).__name__ for one in made.intervals])
        columns = np.column_stack([np.arange(30.0), np.cos(np.arange(30.0))])
        moved.append(made.monodromy(columns[:, 0]))
        at_once = made.monodromy(columns)
        np.testing.assert_allclose(at_once.T, [moved[-1], made.monodromy(columns[:, 1])], rtol=1e-10)
    np.testing.assert_allclose(moved[0], moved[1], rtol=1e-10)
    assert kinds == [["BandFactor"] * 4, ["ReusedInterval"] * 4]


def test_meshes_are_halved_where_errors_are_large_and_joined_again():
    mesh = Mesh.even(4)
    finer = mesh.refined(np.array([0.0, 1e-6, 0.0, 1e-5]))
    assert finer.lengths.sum() == pytest.approx(1.0)
    assert [len(finer.steps), finer.first_of(2)] == [2 + 4 + 4, 5]
    joined = finer.coarsened(np.full(len(finer.steps), 1e-13))
    assert len(joined.steps) < len(finer.steps)
    assert joined.lengths.sum() == pytest.approx(1.0)


def uniform(mu, points):
    """Samples of the oscillation |A|^2 = mu, exact in time and on every grid; times, and the period."""
    period = 2 * np.pi / (1 + 0.8 * mu)
    times = np.linspace(0, period, 25)
    angles = 2 * np.pi * times / period
    waves = np.column_stack([np.cos(angles), np.sin(angles)])
    return np.sqrt(mu) * np.repeat(waves, points, axis=1), times, period


@pytest.mark.seldom
def test_orbits_of_more_than_a_thousand_states_start_from_samples():
    model = landau(502, "differences")
    samples, times, period = uniform(0.3, 502)
    orbit = contin.periodic_orbit(model, samples, {"mu": 0.3}, times=times, intervals=10)
    assert orbit.period == pytest.approx(period, rel=1e-4)
    found = contin.continuation(orbit, "mu", (0.1, 0.5), settings={"steps": 1})
    np.testing.assert_allclose(found.columns["period"] * (1 + 0.8 * found.columns["mu"]), 2 * np.pi, rtol=1e-4)


def test_samples_lead_to_an_orbit_by_shooting_or_to_words():
    system = landau(24, "differences").system()
    samples, times, period = uniform(0.3, 24)
    p = np.array([0.3, 0.5, -0.8])
    orbit = large_orbit_from_samples(system, times, samples, p, "shooting")
    assert orbit.period == pytest.approx(period, rel=ERROR)
    with pytest.raises(NoSolutionError, match=r"not near a periodic orbit|lead to an equilibrium"):
        large_orbit_from_samples(system, times, 0.01 * samples, np.array([-0.3, 0.5, -0.8]))


@pytest.mark.seldom
def test_modulated_waves_of_the_kuramoto_sivashinsky_equation_return_moved_along_the_circle():
    """Born on travelling waves, in their frame; seen from rest the flow over a period is a rotation: amplitudes of all
    Fourier modes return, and phases turn by k times one angle (second method: LSODA)."""
    flame = contin.load({
        "name": "kuramoto-sivashinsky", "kind": "pde",
        "domain": {"x": {"to": "2*pi", "points": 24, "method": "fourier"}},
        "fields": {"u": "-2.6*sin(x)"}, "parameters": {"nu": {"value": 0.8, "range": [0.1, 0.95]}},
        "equations": {"u": "-nu*dxxxx(u) - dxx(u) - u*dx(u)"},
        "conserved": {"u": 0}, "travelling": {"axis": "x", "like": {"u": "-sin(x) - sin(2*x)"}},
    })  # fmt: skip
    standing = contin.continuation(flame, "nu", (0.28, 0.95), settings={"stop_at": ("BP",)})
    waves = contin.continuation(standing["BP1"].switch(), "nu", (0.2, 0.95), settings={"stop_at": ("HB",)})
    found = contin.continuation(waves["HB1"].switch(), "nu", (0.2, 0.3), settings={"steps": 2, "method": "shooting"})
    z = found.z[-1]
    nu, period, start = z[-1], z[-2], found.problem.beginning(z)
    k = np.fft.fftfreq(24, 1 / 24)
    odd = np.where(np.arange(24) == 12, 0, k)

    def rate(t, u):
        modes = np.fft.fft(u)
        return np.fft.ifft((k**2 - nu * k**4) * modes).real - u * np.fft.ifft(1j * odd * modes).real

    flown = solve_ivp(rate, (0, period), start, method="LSODA", rtol=1e-11, atol=1e-12).y
    first, last = np.fft.fft(flown[:, 0])[1:9], np.fft.fft(flown[:, -1])[1:9]
    size = np.abs(first[0])
    np.testing.assert_allclose(np.abs(last), np.abs(first), atol=ERROR * size)
    turn = np.angle(last[0] / first[0])
    np.testing.assert_allclose(last * np.exp(-1j * turn * np.arange(1, 9)), first, atol=ERROR * size)
    assert np.ptp(np.abs(np.fft.fft(flown, axis=0)[1])) > 0.01 * size  # it is modulated


def test_a_jacobian_that_is_only_applied_has_orbits():
    """Up to 1,000 states its entries are products; beyond, words."""

    def model(n):
        decay = -np.arange(1.0, n - 1)

        def residual(u, p):
            growth = p["mu"] - u[0] ** 2 - u[1] ** 2
            return np.concatenate([[growth * u[0] - u[1], growth * u[1] + u[0]], decay * u[2:]])

        def jacobian(u, p):
            x, y = u[:2]
            growth = p["mu"] - x * x - y * y

            def product(v):
                top = [(growth - 2 * x * x) * v[0] - (2 * x * y + 1) * v[1],
                       (1 - 2 * x * y) * v[0] + (growth - 2 * y * y) * v[1]]  # fmt: skip
                return np.concatenate([top, decay * v[2:]])

            return LinearOperator((n, n), matvec=product, dtype=float)

        return contin.FunctionProblem(residual, np.zeros(n), {"mu": -0.5}, jacobian)

    line = contin.continuation(model(30), "mu", (-0.6, 0.2))
    found = contin.continuation(line["HB1"].switch(), "mu", (-0.1, 1), settings={"steps": 2, "intervals": 8})
    np.testing.assert_allclose(found.columns["period"], 2 * np.pi, rtol=1e-4)
    large = LargeProblem(model(1001).system(), np.array([0.0]), 0, None)
    with pytest.raises(InputError, match="1001 states and no entries of its Jacobian: orbits factor"):
        large_cycles(large, line["HB1"], "mu")
