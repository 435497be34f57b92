"""Curves of special and of homoclinic orbits through points that other programs and methods found.

Every curve starts elsewhere, at a label that contin finds itself, and passes the published point.
"""

from __future__ import annotations

import numpy as np
import pytest

import contin

LORENZ_HOMOCLINIC = 13.926557407520  # s = 10, b = 8/3: Sparrow (1982) gives 13.926; the digits are from shooting
TO_FOLD = {"stop_at": ("LPC",)}


@pytest.fixture(scope="module")
def slow():
    return contin.average(contin.load("metronomes/pair"), form="stokes")


def value_at(curve, name: str, value: float, wanted: str) -> list[float]:
    return [p.values[wanted] for p in curve.points if p.type == "UZ" and abs(p.values[name] - value) < 1e-12]


def through(point, names, box, name: str, value: float, wanted: str) -> list[float]:
    curve = contin.continuation(point.locus(names), names, box, values={name: [value]})
    return value_at(curve, name, value, wanted)


@pytest.fixture(scope="module")
def beats(slow):
    """The small beats at beta = 0.78, from the equations' own Hopf point, and the large ones beyond the gluing."""
    start = contin.equilibrium(slow, "in-phase", {"mu": 8, "beta": 0.78})
    line = contin.continuation(start, "mu", (1, 8))
    fork = contin.continuation(line["BP1"].switch(), "mu", (3, 8))
    small = contin.continuation(fork["HB1"].switch(), "mu", (1, 8))
    return small, contin.continuation(small["HOM1"].switch(), "mu", (1, 8), settings=TO_FOLD)


def test_large_beats_of_the_averaged_pair_fold_where_shooting_finds_them(beats):
    box = {"beta": (0.75, 0.82), "mu": (1, 8)}
    assert through(beats[1]["LPC1"], ("beta", "mu"), box, "beta", 0.8, "mu") == pytest.approx([3.2092895356], abs=2e-9)


def test_turning_beats_of_the_averaged_pair_fold_where_shooting_finds_them(slow):
    p = {"mu": 2.0, "beta": 0.78}
    orbit = contin.periodic_orbit(slow, {"S1": 0.05, "S2": 8.0, "S3": 0.001}, p)
    turning = contin.continuation(orbit, "mu", (0.5, 2.5), direction="down", settings=TO_FOLD)
    box = {"beta": (0.75, 0.82), "mu": (0.3, 2)}
    found = through(turning["LPC1"], ("beta", "mu"), box, "beta", 0.8, "mu")
    assert found == pytest.approx([0.7153214039], abs=2e-9)


def test_small_beats_of_the_averaged_pair_are_glued_where_long_orbits_tend_to(beats):
    box = {"beta": (0.75, 0.82), "mu": (3, 6)}
    found = through(beats[0]["HOM1"], ("beta", "mu"), box, "beta", 0.8, "mu")
    assert found == pytest.approx([4.469914868654], abs=2e-8)


@pytest.mark.seldom
def test_homoclinic_orbits_of_the_lorenz_equations_pass_the_classical_point():
    lorenz = contin.load("classics/lorenz")
    start = contin.equilibrium(lorenz, {"x": 6, "y": 6, "z": 20}, {"rho": 22, "s": 9.5})
    line = contin.continuation(start, "rho", (2, 30))
    family = contin.continuation(line["HB1"].switch(), "rho", (2, 30))
    box = {"s": (9, 11), "rho": (10, 20)}
    found = through(family["HOM1"], ("s", "rho"), box, "s", 10.0, "rho")
    assert found == pytest.approx([LORENZ_HOMOCLINIC], abs=2e-7)


def test_folds_of_cycles_of_the_reactor_abc_turn_where_auto_finds_it():
    """AUTO-07p, demo abc, NTST 50, EPSL 1e-10: alpha = 0.982182587 at D = 0.219982798, period 6.954906605."""
    reactor = contin.load("classics/reactor-abc")
    line = contin.continuation(contin.equilibrium(reactor), "D", (0, 0.4))
    cycles = contin.continuation(line["HB1"].switch(), "D", (0, 0.4), settings=TO_FOLD)
    names, box = ("D", "alpha"), {"D": (0.15, 0.3), "alpha": (0.9, 1.1)}
    folds = contin.continuation(cycles["LPC1"].locus(names), names, box, settings={"max_step": 0.01})
    alpha, damkoehler, period = (folds.columns[name] for name in ("alpha", "D", "period"))
    turns = np.flatnonzero(np.diff(np.sign(np.diff(alpha)))) + 1
    turn = min(turns, key=lambda row: abs(damkoehler[row] - 0.22))
    rows = slice(turn - 4, turn + 5)
    along = np.polynomial.Polynomial.fit(damkoehler[rows], alpha[rows], 6)
    place = min((r.real for r in along.deriv().roots()), key=lambda r: abs(r - damkoehler[turn]))
    assert along(place) == pytest.approx(0.982182587, abs=2e-9)
    assert place == pytest.approx(0.219982798, abs=1e-7)
    times = np.polynomial.Polynomial.fit(damkoehler[rows], period[rows], 6)
    assert times(place) == pytest.approx(6.954906605, abs=2e-5)
