"""What curves choose for a stretch (borders, phases, senses) is passed on: no answer depends on the call before."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import contin
from contin.continuation.sample import Frame, Sample
from contin.continuation.settings import Settings
from contin.model.model import Model
from tests.loci.equilibria.planes import BOGDANOV_TAKENS
from tests.problems.shooting.oscillators import bautin_family

SETTINGS = Settings()
BOUNDS = (-np.inf, np.inf)


def leaf():
    """x^2 (1 - x) = y^2 is a homoclinic orbit of the origin at m = 0 for every a."""
    return Model(
        "leaf", states={"x": 0.6, "y": 0}, parameters={"m": 0.4, "a": -0.25, "b": 1},
        equations={"x": "a*x + b*y - a*x^2 + m*x*(2 - 3*x)", "y": "b*x + a*y - 1.5*b*x^2 - 1.5*a*x*y - 2*m*y"},
    )  # fmt: skip


def bautin():
    """r' = r (b1 + b2 r^2 - r^4): folds of cycles on b1 = -b2^2/4."""
    rate, turn = "(b1 + b2*(x^2 + y^2) - (x^2 + y^2)^2)", "(1 + 0.2*(x^2 + y^2))"
    equations = {"x": f"{rate}*x - {turn}*y", "y": f"{rate}*y + {turn}*x"}
    return Model("bautin", states={"x": 1.0, "y": 0.0}, parameters={"b1": 0.1, "b2": 1.0}, equations=equations)


def henon():
    """Fixed points of x -> 1 - a x^2 + b x_before fold at a = -(1 - b)^2/4."""
    equations = {"x": "1 - a*x^2 + y", "y": "b*x"}
    return Model("henon", kind="map", states={"x": 0.6, "y": 0.2}, parameters={"a": 0.2, "b": 0.3}, equations=equations)


@cache
def seeds():
    """Curves by kind: extended and bordered equations, collocation, shooting, projections."""
    line = contin.continuation(contin.equilibrium(henon()), "a", (-0.5, 0.3))
    family = contin.continuation(contin.periodic_orbit(bautin()), "b1", (-0.5, 0.2), values={"b1": [-0.05]})
    rest = contin.continuation(contin.equilibrium(leaf()), "m", (-1, 1))
    loops = contin.continuation(rest["HB1"].switch(), "m", (-1, 1))
    plane = BOGDANOV_TAKENS.line()
    found = {
        "extended": (plane["LP1"], ("p", "q")), "bordered": (line["LP1"], ("a", "b")),
        "folds of cycles": (family["LPC1"], ("b1", "b2")), "one period": (family["UZ1"], ("b1", "b2")),
        "folds by shooting": (bautin_family()["LPC1"], ("b1", "b2")), "homoclinic": (loops["HOM1"], ("m", "a")),
    }  # fmt: skip
    return {kind: point.locus(names)[0] for kind, (point, names) in found.items()}


KINDS = ("extended", "bordered", "folds of cycles", "one period", "folds by shooting", "homoclinic")


@pytest.mark.parametrize("kind", KINDS)
def test_answers_do_not_depend_on_the_calls_before(kind):
    """A step, points beside it, and points solved for elsewhere: in one order, and in the other one."""
    seed = seeds()[kind]
    problem, z = seed.problem, seed.z
    scale = problem.initial_scale(z, (-1.0, 1.0)) if seed.scale is None else seed.scale
    tangent = seed.direction if seed.direction is not None else problem.tangents(z, scale)[0]
    frame = Frame(scale)
    start = problem.probe(bare(z, tangent), 0.0, z, frame, SETTINGS)
    assert start is not None

    def marched(gauge):
        step = 0.02
        return problem.march(start, None, 0.0, Frame(scale, 0.0, gauge), step, 3, BOUNDS, SETTINGS, None)

    def beside(chunk, row, length):
        own = Frame(scale, chunk.reference, chunk.gauge)
        base = chunk.sample(row)
        return problem.probe(base, length, base.z + length * scale * base.tangent, own, SETTINGS)

    def elsewhere():
        return problem.at_unknown(-1, start.z, float(start.z[-1] + 0.01 * scale[-1]), scale)

    first = marched(None)
    near, far, apart = beside(first, 1, 0.003), beside(first, 2, -0.004), elsewhere()
    marched(first.gauge)
    again = elsewhere(), beside(first, 2, -0.004), beside(first, 1, 0.003), marched(None)
    np.testing.assert_array_equal(again[0], apart)
    for one, other in ((again[1], far), (again[2], near)):
        assert (one is None) == (other is None)
        if one is not None:
            np.testing.assert_array_equal(one.z, other.z)
            np.testing.assert_array_equal(one.tests, other.tests)
    np.testing.assert_array_equal(again[3].z, first.z)
    np.testing.assert_array_equal(again[3].tests, first.tests)


def bare(z, tangent):
    """A point with a tangent, of which nothing else is known."""
    return Sample(z, tangent, np.zeros(0), 0, np.zeros(0, complex))
