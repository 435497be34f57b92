"""Orbits that return turned by an angle, in models with a circle symmetry: periodic in the frame that turns so."""

import numpy as np
import pytest

import contin

BETA = {"beta": 0.8}


@pytest.fixture(scope="module")
def beats():
    """Three metronomes, averaged: one swings against two, found by simulation from near in-phase synchrony."""
    model = contin.average(contin.load("metronomes/three"), form="cartesian")
    start = {"u1": 2.1, "u2": 2.0, "v2": 0.1, "u3": 2.0, "v3": 0.1}
    orbit = contin.periodic_orbit(model, start, {"mu": 3.1, **BETA})
    return contin.continuation(orbit, "mu", (2.5, 5.0))


@pytest.fixture(scope="module")
def invariant_beats():
    """The same in the invariants of the rotation (two clusters in Stokes' form), where no frame is needed."""
    model = contin.average(contin.load("metronomes/clusters"), form="stokes")
    start = {"S1": 0.41, "S2": 8.4, "S3": -0.4}
    orbit = contin.periodic_orbit(model, start, {"mu": 3.1, "p": 1.0, "q": 2.0, **BETA})
    return contin.continuation(orbit, "mu", (2.5, 5.0))


@pytest.mark.seldom
def test_folds_and_ends_are_those_of_the_invariants(beats, invariant_beats):
    """Not those of the frame: one that only keeps up with the state on average adds folds of its own (at 3.3305)."""
    ours, theirs = (np.sort([p.values["mu"] for p in b.points if p.type == "LPC"]) for b in (beats, invariant_beats))
    np.testing.assert_allclose(ours, theirs, atol=1e-8)
    ends = [{e.reason for e in b.ends} for b in (beats, invariant_beats)]
    assert ends[0] == ends[1] == {"bound", "homoclinic"}


def test_periods_are_those_of_the_invariants(beats, invariant_beats):
    """Both families beside their common fold: mu as a function of the period."""

    def fitted(branch):
        mu, period = branch.columns["mu"], branch.columns["period"]
        near = np.argsort(np.abs(period - 2.3))[:7]
        return np.polynomial.Polynomial.fit(period[near], mu[near], 5)

    at = np.linspace(2.25, 2.4, 5)
    np.testing.assert_allclose(fitted(beats)(at), fitted(invariant_beats)(at), atol=2e-6)


def test_stability_counts_the_full_space(beats, invariant_beats):
    """Two metronomes of the larger cluster may part: period doubling and branch points that clusters do not have."""
    found = {p.type for p in beats.points}
    assert {"PD", "BPC"} <= found
    assert not {"PD", "BPC"} & {p.type for p in invariant_beats.points}
    doubled = sorted(p.values["mu"] for p in beats.points if p.type == "PD")
    assert doubled == pytest.approx([2.9623282, 3.07925], abs=1e-6)  # where simulations of all three lose the beat


def test_a_rotating_wave_is_still_an_orbit_of_the_flow():
    """z' = (1 + 2 i) z - |z|^2 z: in its frame it rests; as an orbit its period is pi."""
    model = contin.Model(
        "wave", states={"x": 0.5, "y": 0.1}, parameters={"a": 1.0},
        equations={"x": "a*x - 2*y - x*(x^2 + y^2)", "y": "2*x + a*y - y*(x^2 + y^2)"},
        rotation={"x": "-y", "y": "x"},
    )  # fmt: skip
    assert contin.periodic_orbit(model).period == pytest.approx(np.pi, rel=1e-9)
