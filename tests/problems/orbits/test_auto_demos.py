"""AUTO-07p's demos pen and cir, and MatCont's MLfast: curves and families that end where nothing more is resolved."""

from __future__ import annotations

import numpy as np
import pytest

import contin
from contin.model.model import Model


def angle(value: float) -> dict[str, float | str]:
    return {"value": value, "period": "2*pi"}


def pendula() -> Model:
    """Coupled pendula (Aronson, Doedel and Othmer 1991), rotating in phase."""
    return Model(
        "pen", states={"a": angle(1.2403680193), "b": angle(1.2403680193), "c": 4.0783200778, "d": 4.0783200778},
        parameters={"gamma": 0.175, "eps": 0.1, "I": 0.4},
        equations={
            "a": "c", "b": "d",
            "c": "-eps*c - sin(a) + I + gamma*(b - a)", "d": "-eps*d - sin(b) + I + gamma*(a - b)",
        },
    )  # fmt: skip


@pytest.mark.seldom
def test_a_curve_of_period_doublings_ends_at_the_homoclinic_orbits_that_it_follows():
    """At the end the rotation in phase is the homoclinic one of the pendulum phi'' + eps phi' + sin phi = I, with the
    saddle sin phi = I, cos phi < 0."""
    model = pendula()
    family = contin.continuation(contin.periodic_orbit(model, {}), "I", (0.0, 1.0), settings={"stop_at": ("PD",)})
    curve = contin.continuation(family["PD1"].locus(("I", "eps")), ("I", "eps"), {"I": (0, 3), "eps": (0, 3)})
    # without friction and drive another multiplier is 1: at that end of the range rounding says whether it passes 1
    inside = [point for point in curve.points if point.values["eps"] > point.error]
    assert {point.type for point in inside} <= {"GPD"}
    assert all(point.residual < 1e-5 for point in curve.points)
    (end,) = [end for end in curve.ends if end.reason == "homoclinic"]
    at, saddle = end.data["at"], end.data["saddle"]
    assert np.sin(saddle["a"]) == pytest.approx(at["I"], abs=1e-9)
    assert np.cos(saddle["a"]) < 0.0
    pendulum = Model(
        "pendulum", states={"a": angle(1.24), "c": 4.08}, parameters={"eps": at["eps"], "I": 1.0},
        equations={"a": "c", "c": "-eps*c - sin(a) + I"},
    )  # fmt: skip
    rotations = contin.continuation(contin.periodic_orbit(pendulum, {}, {"I": 2.0}), "I", (0.1, 2.0))
    (limit,) = [end for end in rotations.ends if end.reason == "homoclinic"]
    assert limit.data["at"]["I"] == pytest.approx(at["I"], abs=1e-6)


@pytest.mark.seldom
def test_doubled_orbits_that_slip_onto_those_of_half_the_period_end_as_joined():
    """cir (Freire, Rodriguez-Luis, Gamero and Ponce 1993), beside a Shilnikov homoclinic orbit."""
    model = Model(
        "cir", states={"x": 0, "y": 0, "z": 0}, parameters={"nu": -1, "beta": 0.6},
        definitions={"k": "0.933578*(y - x)^3"},
        equations={"x": "(-(beta + nu)*x + beta*y - 0.328578*x^3 + k)/0.6", "y": "beta*x - beta*y - z - k", "z": "y"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "nu", (-1, 0))
    fork = contin.continuation(line["BP1"].switch(), "nu", (-1, 0))
    family = contin.continuation(fork["HB1"].switch(), "nu", (-1, 0))
    last = [p for p in family.points if p.type == "PD"][-1]
    doubled = contin.continuation(last.switch(), "nu", (-1, 0))
    for point in doubled.points:  # none is one of the family, run through twice
        for known in family.points:
            same = abs(point.values["period"] / known.values["period"] - 2.0) < 1e-4
            assert not (same and abs(point.values["nu"] - known.values["nu"]) < 1e-9), (point, known)
    assert doubled.ends[1].reason == "joined"
    periods = doubled.columns["period"]
    assert abs(periods[-1] - periods[0]) < 0.05 * periods[0]


@pytest.mark.parametrize(
    "steps", [(0.1,), pytest.param((0.03, 0.1), marks=pytest.mark.long)], ids=["coarse", "coarse and fine"]
)
@pytest.mark.seldom
def test_a_curve_of_folds_beside_homoclinic_orbits_does_not_depend_on_the_step(steps):
    model = Model(
        "mlfast", states={"v": 0.03, "w": 0.25}, parameters={"y": 0.3, "z": 0.1},
        equations={
            "v": "y - (v + 0.5)/2 - 2*w*(v + 0.7) - (1 + tanh((v + 0.01)/0.15))*(v - 1)/2",
            "w": "1.15*((1 + tanh((v - z)/0.145))/2 - w)*cosh((v - 0.1)/0.29)",
        },
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "y", (-0.05, 0.3))
    family = contin.continuation(line["HB1"].switch(), "y", (-0.05, 0.3), settings={"stop_at": ("LPC",)})
    assert family["LPC1"].values["y"] == pytest.approx(0.08456948, abs=2e-8)  # MatCont's tutorial
    places = []
    for step in steps:
        curve = contin.continuation(
            family["LPC1"].locus(), ("y", "z"), {"y": (-0.2, 0.4), "z": (-0.1, 0.4)}, settings={"max_step": step}
        )
        assert curve.points == ()
        assert sorted(end.reason for end in curve.ends) == ["homoclinic", "hopf"]
        order = np.argsort(curve.columns["z"])
        places.append((curve.columns["z"][order], curve.columns["y"][order]))
    (fine, there), (coarse, here) = places[0], places[-1]
    inside = (coarse > fine.min()) & (coarse < fine.max())
    np.testing.assert_allclose(np.interp(coarse[inside], fine, there), here[inside], atol=1e-4)


@pytest.mark.parametrize("eps", [0.93947, 0.939478470001, 0.9394784702686441, 0.9395, 0.95])
def test_a_rotation_from_a_simulation_is_a_single_turn(eps):
    """It was two or three where a return after several crossings came closer by rounding; then its family ended."""
    pendulum = Model(
        "pendulum", states={"a": angle(1.24), "c": 4.08}, parameters={"eps": eps, "I": 1.0},
        equations={"a": "c", "c": "-eps*c - sin(a) + I"},
    )  # fmt: skip
    orbit = contin.periodic_orbit(pendulum, {}, {"I": 2.0})
    np.testing.assert_allclose(orbit.winding, [2.0 * np.pi, 0.0], rtol=1e-12)
    # energy: eps <c^2> = I <c>, <c> = 2 pi / T
    c2 = orbit.profile.weights @ np.square(orbit.profile.u[:, 1])
    assert eps * c2 == pytest.approx(2.0 * 2.0 * np.pi / orbit.period, rel=1e-6)
