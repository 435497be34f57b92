"""Approaches to homoclinic and heteroclinic orbits whose limits are known by other means."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import contin
from contin.model.model import Model


@pytest.mark.seldom
def test_a_slow_direction_that_takes_no_part_does_not_hide_the_limit():
    """The cubic leaf x^2 (1 - x) = y^2 is a loop of the origin at m = 0 (Sandstede 1997), eigenvalues a +- b.

    It drives z, whose rate 0.05 is much slower, and which drives nothing.
    """
    model = Model(
        "leaf", states={"x": 0.6, "y": 0, "z": 0}, parameters={"m": 0.4, "a": -0.25, "b": 1},
        equations={
            "x": "a*x + b*y - a*x^2 + m*x*(2 - 3*x)", "y": "b*x + a*y - 1.5*b*x^2 - 1.5*a*x*y - 2*m*y",
            "z": "-0.05*z + x*y",
        },
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "m", (-1, 1))
    family = contin.continuation(line["HB1"].switch(), "m", (-1, 1))
    end = family.ends[1]
    assert end.reason == "homoclinic"
    assert abs(end.data["at"]["m"]) <= end.data["error"] < 1e-7
    assert end.data["passes"] == 1


@pytest.mark.seldom
def test_orbits_between_two_saddles_are_heteroclinic_cycles():
    """x'' = -x + x^3 + e (m - x^2) x' has a cycle over x = -1 and 1 at m = 1/5 + O(e^2), by Melnikov's method."""
    model = Model(
        "cubic", states={"x": 0, "y": 0}, parameters={"m": -0.1, "e": 0.1},
        equations={"x": "y", "y": "-x + x^3 + e*y*(m - x^2)"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "m", (-1, 1))
    family = contin.continuation(line["HB1"].switch(), "m", (-1, 1))
    end = family.ends[1]
    assert end.reason == "heteroclinic"
    assert [s["state"]["x"] for s in end.data["saddles"]] == pytest.approx([-1, 1])
    assert end.data["at"]["m"] == pytest.approx(0.2, abs=2e-5)
    plane, box = ("m", "e"), {"m": (0.0, 0.5), "e": (0.01, 0.2)}
    halves = [contin.continuation(seed, plane, box) for seed in family["HOM1"].locus(plane)]
    assert len(halves) == 2
    for half in halves:
        m, e = half.columns["m"], half.columns["e"]
        assert np.interp(0.1, e, m) == pytest.approx(end.data["at"]["m"], abs=1e-6)
        slope = np.polyfit(e**2, m, 1)
        assert slope[1] == pytest.approx(0.2, abs=1e-6)


@pytest.fixture(scope="module")
def birth():
    """Three metronomes: beating born where one swings with another amplitude than the other two, beta = 0.8."""
    model = contin.average(contin.load("metronomes/three"), form="cartesian")
    line = contin.continuation(contin.equilibrium(model, "in-phase", {"mu": 8, "beta": 0.8}), "mu", (2.9, 8))
    fork = contin.continuation(line["BP1"].switch()[0], "mu", (2.6, 4))
    born = min((p for p in fork.points if p.type == "HB"), key=lambda p: abs(p.values["mu"] - 2.7587))
    return born.switch()


@pytest.fixture(scope="module")
def beats(birth):
    return contin.continuation(birth, "mu", (1.5, 4.0))


@pytest.fixture(scope="module")
def fine(birth):
    return contin.continuation(birth, "mu", (1.5, 4.0), settings={"max_step": 0.06})


@pytest.mark.parametrize(
    "settings",
    [
        pytest.param({"max_step": 0.1}, marks=pytest.mark.long),
        pytest.param({"max_step": 0.15}, marks=pytest.mark.long),
        {"max_step": 0.17},
        {"max_step": 0.25},
    ],
    ids=str,
)
@pytest.mark.seldom
def test_an_approach_is_told_whatever_the_steps(birth, fine, settings):
    """And every orbit near it has the distance mu* - mu = A(T) exp(-k T) of one of its period among short steps.

    Close to two passes of one saddle the matrix is nearly singular in the difference of their times. Chord iterations
    stall there, and orbits were taken for solutions that were off by 5 % of the distance to the limit; from those no
    step succeeded, or only the smallest ones.
    """
    limit = fine.ends[1].data
    family = contin.continuation(birth, "mu", (1.5, 4.0), settings=settings)
    end = family.ends[1]
    assert end.reason == "homoclinic"
    assert end.data["passes"] == 2
    assert end.data["error"] < 1e-6
    assert abs(end.data["at"]["mu"] - limit["at"]["mu"]) <= end.data["error"] + limit["error"]
    assert len(family.z) < 300  # 78 to 204, as rounding has it: the last steps are short; thousands where they failed

    def distances(family):
        mu, period = family.columns["mu"], family.columns["period"]
        near = (period > 20.5) & (period < 26.5)
        return period[near] - 23.5, np.log(limit["at"]["mu"] - mu[near])

    law = np.polyfit(*distances(fine), 3)
    period, logarithm = distances(family)
    assert period.size
    np.testing.assert_allclose(np.polyval(law, period), logarithm, atol=0.01)


@pytest.mark.seldom
def test_a_loop_and_its_image_in_turn_are_one_approach_with_two_passes(beats):
    """One metronome leaves the common state and comes back, then another one does: two loops of one saddle.

    Each lies in the subspace in which the other two agree, where the loop is found by shooting: the trajectory that
    leaves the saddle comes back to it, and passes it on one side or the other.
    """
    end = beats.ends[1]
    assert end.reason == "homoclinic"
    assert end.data["passes"] == 2
    system = beats.problem.system
    base = beats.problem.base.copy()

    def side(mu):
        p = base.copy()
        p[beats.problem.active] = mu
        saddle = np.array(list(end.data["saddle"].values()))
        for _ in range(5):
            f, jacobian = system.jacobian(saddle, p)
            saddle = saddle - np.linalg.solve(jacobian[:, :6], f)
        agree = np.vstack([np.eye(4), np.eye(4)[2:]])  # where states 2 and 3 agree one of the two directions is left
        values, vectors = np.linalg.eig(system.jacobian(saddle, p)[1][:4, :6] @ agree)
        leave = agree @ np.real(vectors[:, np.argmax(values.real)])
        leave *= -np.sign(leave[0]) / np.linalg.norm(leave)

        def field(_, u):
            v = system.value(u, p)
            v[4:6] = v[2:4]
            return v

        times = np.linspace(0, 60, 12001)
        path = solve_ivp(field, (0, 60), saddle + 1e-6 * leave, "DOP853", rtol=1e-11, atol=1e-13, t_eval=times).y
        gap = path[0] - path[2]
        away = int(np.argmax(np.abs(gap) > 0.2))
        back = away + int(np.argmax(np.abs(gap[away:]) < 0.01))
        return gap[back + int(np.argmax(np.abs(gap[back:]) > 0.05))]

    low, high = 2.56920, 2.56921
    start = np.sign(side(low))
    assert start != np.sign(side(high))
    for _ in range(12):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if np.sign(side(middle)) == start else (low, middle)
    assert end.data["error"] < 1e-6  # an extrapolation: which orbits it has, and its error, depend on the steps
    assert end.data["at"]["mu"] == pytest.approx(0.5 * (low + high), abs=end.data["error"] + 0.5 * (high - low))


def test_the_rate_at_which_a_frame_keeps_up_is_no_eigenvalue_of_the_saddle(beats):
    """The amplitudes stand in a frame that keeps up with their phases at its own rate, 1.

    Differences of the amplitudes decay or grow at rates that come in equal pairs (three metronomes may be exchanged).
    """
    end = beats.ends[1]
    values = np.sort(np.real(end.data["eigenvalues"]))
    frame = int(np.argmin(np.abs(values + 1.0)))
    assert values[frame] == pytest.approx(-1.0, abs=1e-6)
    own = np.delete(values, frame)
    assert own[-1] == pytest.approx(own[-2], abs=1e-6)
    assert end.data["saddle_quantity"] == pytest.approx(own[-1] + own[own < 0].max(), abs=1e-9)
    assert end.data["saddle_quantity"] < 1.0
