"""What the claims share: a table of functions by name, and averaged models evaluated at a point."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
from scipy.optimize import brentq

import contin
from contin.api import compiled

Numbers = tuple[object, object] | tuple[object, object, object]
CLAIMS: dict[str, Callable[[], Numbers]] = {}
A, B, EPS = 4.0, 1.0, 0.01


def claim(function: Callable[[], Numbers]) -> Callable[[], Numbers]:
    """A function without arguments that gives (our numbers, the numbers that the paper's words or formula give).

    Where these differ it gives third what is right instead, with which our numbers must agree.
    """
    CLAIMS[function.__name__.replace("_", "-")] = function
    return function


@cache
def averaged(name: str, form: str = "polar"):
    """The average of a bundled model."""
    return contin.average(contin.load(f"metronomes/{name}"), form=form)


def rates(model, states, **parameters):
    """f(u, p) of a model at a point."""
    p = np.array(list(model.default_parameters(parameters).values()), dtype=float)
    return compiled(model).value(np.array(states, dtype=float), p)


@cache
def loaded(name: str):
    """A bundled equation of motion."""
    return contin.load(f"metronomes/{name}")


def motion(name: str, states, **parameters) -> np.ndarray:
    """The rates of a bundled equation of motion."""
    return rates(loaded(name), states, **parameters)


def pushed(name: str, x: float, y: float, **parameters) -> float:
    """The force of the escapement of a bundled equation of motion: all that is neither spring nor damping."""
    model = loaded(name)
    p = model.default_parameters(parameters)
    return float((rates(model, (x, y), **parameters)[1] + x) / p["eps"] + p["alpha"] * y)


def amplitudes(model, low: float = 1e-3, high: float = 8.0, **parameters) -> list[float]:
    """Where r' of an averaged model of one metronome changes its sign, by bisection."""
    p = np.array(list(model.default_parameters(parameters).values()), dtype=float)
    system, at = compiled(model), np.linspace(low, high, 4001)
    values = system.values(at[:, None], p)[:, 0]
    ends = np.flatnonzero(values[:-1] * values[1:] < 0)
    return [brentq(lambda r: float(system.value(np.array([r]), p)[0]), at[k], at[k + 1], xtol=1e-13) for k in ends]


def watched(model, name, states, **parameters) -> float:
    """An observable of a model at a point."""
    p = np.array(list(model.default_parameters(parameters).values()), dtype=float)
    system = compiled(model)
    row = system.observables(np.array([states], dtype=float), p[None])
    return float(np.ravel(row)[system.observable_names.index(name)])


def slopes(model, states, **parameters) -> np.ndarray:
    """df/du at a point."""
    p = np.array(list(model.default_parameters(parameters).values()), dtype=float)
    system = compiled(model)
    return system.jacobian(np.array(states, dtype=float), p)[1][:, : system.n]


def labels(name: str, type_: str, start: str, parameter: str, low: float, high: float, **parameters):
    """Special points that continuation of the averaged equations finds, by value of the parameter."""
    state = contin.equilibrium(averaged(name), start=start, parameters=parameters)
    branch = contin.continuation(state, parameter, (low, high))
    return [p for p in branch.points if p.type == type_]


def r_star(beta: float, sign: int = 1, a: float = A, b: float = B) -> float:
    """The printed amplitude: stable for +, unstable for -."""
    return float(np.sqrt((3 * a + sign * np.sqrt(9 * a * a - 48 * np.pi * b * beta)) / (4 * b)))


def mu_c(beta: float, a: float = A, b: float = B) -> float:
    """The printed value of mu at which in-phase synchrony changes its stability."""
    root = np.sqrt(9 * a * a - 48 * np.pi * b * beta)
    return float(-15 * np.pi * beta / 8 + 27 * a * a / (64 * b) + 9 * a / (64 * b) * root)
