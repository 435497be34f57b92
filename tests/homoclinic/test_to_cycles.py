"""Connecting orbits to cycles of the Lorenz equations, by projections on adjoint Floquet modes."""

import numpy as np
import pytest

import contin
from contin.errors import InputError, NoSolutionError
from contin.simulate.trajectory import integrate

ORIGIN = {"x": 0, "y": 0, "z": 0}


@pytest.fixture(scope="module")
def lorenz():
    return contin.load("lorenz")


@pytest.fixture(scope="module")
def cycles(lorenz):
    rest = contin.equilibrium(lorenz, {"x": 8, "y": 8, "z": 23}, {"rho": 24})
    line = contin.continuation(rest, "rho", (23, 26))
    return contin.continuation(line["HB1"].switch(), "rho", (23, 25), values={"rho": [23.8, 24.2]})


@pytest.fixture(scope="module")
def start(lorenz, cycles):
    at = {point.values["rho"]: point for point in cycles.points if point.type == "UZ"}
    return contin.connection(lorenz, ORIGIN, at[24.2]), contin.connection(lorenz, ORIGIN, at[23.8])


@pytest.fixture(scope="module")
def seeds(start):
    """The connecting orbits from there, found once."""
    return [one.locus(("rho", "s"))[0] for one in start]


@pytest.mark.seldom
def test_the_origin_is_connected_with_a_cycle_where_the_attractor_is_born(seeds, lorenz):
    """rho = 24.0579 (Doedel, Kooi, van Voorn and Kuznetsov 2008), from cycles on both sides of it.

    Trajectories that leave the origin come to rest below (inside of the cycle's stable manifold), and do not above.
    """
    found = [float(seed.z[-1]) for seed in seeds]
    assert found[0] == pytest.approx(24.0579, abs=5e-5)
    assert found[0] == pytest.approx(found[1], abs=1e-8)
    from contin.lowering.system import compile_system

    system = compile_system(lorenz)
    inside = []
    for rho in (found[0] - 1e-4, found[0] + 1e-4):
        p = np.array([{"rho": rho, "s": 10.0, "b": 8 / 3}[name] for name in system.parameter_names])
        values, vectors = np.linalg.eig(system.jacobian(np.zeros(3), p)[1][:, :3])
        v = np.real(vectors[:, np.argmax(values.real)])
        path = integrate(system, -1e-6 * v * np.sign(v[0]), p, 400.0, times=np.linspace(0, 400, 20001)).u
        late = path[len(path) // 20 :, 0]
        inside.append(bool(late.min() > 0.0))
    assert inside == [True, False]


def test_the_curve_in_two_parameters(seeds):
    branch = contin.continuation(
        seeds[0], ("rho", "s"), {"rho": (20, 28), "s": (9.5, 10.5)}, values={"s": [10.2]}, settings={"max_step": 1.0}
    )
    assert (branch.locus, branch.problem.parameters) == ("HOM", ("rho", "s"))
    assert {end.text for end in branch.ends} == {"s reached 9.5", "s reached 10.5"}
    assert np.all(branch.columns["multiplier"] > 1.0)
    assert [point.type for point in branch.points] == ["UZ"]
    assert np.ptp(branch.columns["x.saddle"]) == 0.0


def test_what_cannot_be_followed_is_named(lorenz, cycles):
    point = next(point for point in cycles.points if point.type == "UZ")
    with pytest.raises(InputError, match="name two parameters"):
        contin.continuation(contin.connection(lorenz, ORIGIN, point), "rho", (23, 25))
    with pytest.raises(InputError, match="name one parameter"):
        contin.continuation(contin.connection(lorenz, point), ("rho", "s"), {"rho": (23, 25), "s": (9, 11)})
    with pytest.raises(InputError, match="leave out `reversor`"):
        contin.connection(lorenz, point, reversor={"x": "-x"})


def at_s(start, s=10.0):
    """The label at a value of the second parameter that the start has."""
    ranges, settings = {"rho": (20, 28), "s": (9.9, 10.1)}, {"max_step": 1.0}
    branch = contin.continuation(start, ("rho", "s"), ranges, values={"s": [s]}, settings=settings)
    return branch["UZ1"]


@pytest.fixture(scope="module")
def at_ten(seeds):
    return at_s(seeds[0])


@pytest.mark.parametrize("truncation", [1e-2, pytest.param(1e-3, marks=pytest.mark.long)])
def test_ends_that_are_farther_from_the_cycle_state_larger_errors(lorenz, cycles, at_ten, truncation):
    """Manifolds are taken for their linear spaces there: off by the square of the distance, which the error has."""
    point = next(point for point in cycles.points if point.type == "UZ" and point.values["rho"] > 24)
    far = at_s(contin.connection(lorenz, ORIGIN, point, truncation=truncation))
    off = abs(far.values["rho"] - at_ten.values["rho"])
    assert off <= far.error + at_ten.error
    assert 0.0 < at_ten.error < 1e-8 < far.error < truncation


@pytest.mark.seldom
def test_samples_of_an_orbit_are_enough(lorenz, cycles, seeds, at_ten):
    """An orbit at rho = 24.0579, from a table that is only roughly right."""
    point = next(point for point in cycles.points if point.type == "UZ" and point.values["rho"] > 24)
    profile = seeds[0].problem.orbit_at(seeds[0].z)
    s = np.linspace(0.0, 1.0, 801)
    rough = np.round(profile.at(s), 2)
    found = at_s(contin.connection(lorenz, ORIGIN, point, samples=(s * profile.period, rough)))
    assert abs(found.values["rho"] - at_ten.values["rho"]) < found.error + at_ten.error < 1e-6
    with pytest.raises(NoSolutionError, match="the orbit given ends at"):
        contin.connection(lorenz, ORIGIN, point, samples=(s[:300], rough[:300])).locus(("rho", "s"))
