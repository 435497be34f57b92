"""A form of averaged systems in energies E = r^2/2 in place of amplitudes, and an escapement."""

from contin.symbolic.averaging.other_forms import NewForm
from contin.symbolic.passes.escapements import Escapement


def energy_of(radius):
    return "E" + radius[1:]


def states(old):
    return {energy_of(n): f"{n}^2/2" if n.startswith("r") else n for n in radii(old)} | angles(old)


def inverse(old):
    return {n: f"sqrt(2*{energy_of(n)})" for n in radii(old)} | angles(old)


def radii(old):
    return [n for n in old if n.startswith("r")]


def angles(old):
    return {n: n for n in old if n.startswith("psi")}


FORM = NewForm("polar", states, inverse, lambda old: dict.fromkeys(angles(old), "2*pi"))
BRASS = Escapement("a*y - b*y^3 if x > 0 else 0", {"a": 2.0, "b": 0.3})
