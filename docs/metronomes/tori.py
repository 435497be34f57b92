"""Small beats of the equations of motion as invariant tori: the circle in which one cuts the plane x1 = 1, followed."""

import numpy as np
from drawing import MarkdownTable

import contin
from contin.api import compiled
from contin.tori.circle import Plane, continued, first_circle

PLANE = Plane(0, 1.0, 1)  # not on a surface where the escapement switches
START, MU = np.array([1.85, 1.0, 1.7]), 4.195


def family(to, step, count=41, eps=0.01):
    """Circles from MU to another mu, at beta = 0.8; the last is where no further one is found."""
    model = contin.load("metronomes/pair")
    p = np.array(list(model.default_parameters({"mu": MU, "beta": 0.8, "eps": eps}).values()), dtype=float)
    first = first_circle(compiled(model), PLANE, p, START, count=count, transient=12_000, points=2500)
    index = list(model.parameter_names).index("mu")
    return [first, *continued(first, index, to, step, smallest=2e-4)]


def table(circles):
    """mu, turns of a swing in a beat, size in x2, and the part of the curve that is not resolved."""
    rows = [
        (f"{c.p[0]:.4f}", f"{1 / abs(c.rho):.4f}", f"{np.ptp(c.values[:, 1]):.5f}", f"{c.tail:.1e}") for c in circles
    ]
    return MarkdownTable("mu | swings a beat | extent in x2 | not resolved", rows)
