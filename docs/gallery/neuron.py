"""Firing of a Morris-Lecar neuron between two Hopf points."""

from matplotlib.figure import Figure

import contin


def compute():
    """Rest states in the current I, and the cycles from the first Hopf point."""
    model = contin.load("morris-lecar")
    rest = contin.continuation(contin.equilibrium(model), "I", (-50, 300), name="rest")
    firing = contin.continuation(rest["HB1"].switch(), "I", (-50, 300), name="firing")
    return rest, firing


def onset(firing) -> float:
    """The current at which stable firing appears with a finite period: the fold of the cycles."""
    return next(p for p in firing.points if p.type == "LPC").values["I"]


def draw() -> Figure:
    return contin.draw(*compute(), x="I", y="V")
