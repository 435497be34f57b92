"""Random flows, maps and forced oscillators whose families fold, double and turn to tori, with two ranges."""

from __future__ import annotations

import numpy as np

from contin.model.model import Model

BURSTS = {"p": (-4.0, 4.0), "q": (-0.5, 2.0)}
PAIRS = {"p": (-2.0, 3.0), "q": (-0.5, 1.0)}
TURBULENCE = {"p": (-6.0, 6.0), "q": (-3.0, 3.0)}
MAPS = {"p": (-3.0, 3.0), "q": (-2.0, 2.0)}
FORCED = {"w": (0.4, 2.5), "q": (0.1, 6.0)}


def _drawn(seed):
    """A number between two others, of three digits."""
    generator = np.random.default_rng(seed)
    return generator, lambda low, high: round(float(generator.uniform(low, high)), 3)


def bursting(seed):
    """A cubic cell with two slow states."""
    _, u = _drawn(seed)
    fast, slow = round(10.0 ** u(-2, 0), 4), round(10.0 ** u(-3, -0.5), 5)
    equations = {
        "x": f"x - x^3/3 - y - {u(0.1, 1.2)}*z + p",
        "y": f"{fast}*(x + q - {u(0.2, 1)}*y + ({u(-0.5, 0.5)})*z)",
        "z": f"{slow}*({u(0.2, 3)}*(x + ({u(-1, 1.5)})) - z + ({u(-0.5, 0.5)})*y)",
    }
    states = {"x": -1.5, "y": -0.5, "z": 0.0}
    return Model(f"bursting {seed}", states=states, parameters={"p": -1.0, "q": 0.7}, equations=equations), BURSTS


def pair(seed):
    """Two cells that differ, coupled by a state of each."""
    _, u = _drawn(seed)
    equations = {
        "v": "v - v^3/3 - w + p + q*(V - v)",
        "w": f"{u(0.1, 0.6)}*(v + {u(0.2, 0.8)} - {u(0.3, 0.9)}*w)",
        "V": f"V - V^3/3 - W + {u(0.5, 1.2)}*p + {u(0.05, 0.4)}*(v - V)",
        "W": f"{u(0.1, 0.6)}*(V + {u(0.2, 0.8)} - {u(0.3, 0.9)}*W + ({u(-0.3, 0.3)})*v)",
    }
    states = {"v": -1.2, "w": -0.6, "V": -1.2, "W": -0.6}
    return Model(f"pair {seed}", states=states, parameters={"p": -1.0, "q": 0.2}, equations=equations), PAIRS


def turbulence(seed):
    """Damped and driven, with quadratic terms that keep the energy: bounded (Lorenz, Tellus 12 (1960) 243)."""
    generator, u = _drawn(seed)
    n = int(generator.choice([3, 4, 4, 5]))
    forms = np.round(generator.normal(size=(n, n, n)), 2)
    forms = forms - np.swapaxes(forms, 0, 1)
    turns = np.round(generator.normal(size=(n, n)), 2)
    turns = turns - turns.T
    equations = {}
    for i in range(n):
        terms = [f"p*({u(-1.5, 1.5)}) + q*({u(-1.5, 1.5)}) - {u(0.3, 1.5)}*x{i}"]
        terms += [f"({turns[i, j]:.2f})*x{j}" for j in range(n) if j != i]
        terms += [f"({forms[i, j, k]:.2f})*x{j}*x{k}" for j in range(n) for k in range(n) if j != i]
        equations[f"x{i}"] = " + ".join(terms)
    states = dict.fromkeys(equations, 0.0)
    return Model(f"turbulence {seed}", states=states, parameters={"p": 0.0, "q": 0.5}, equations=equations), TURBULENCE


def quadratic_map(seed):
    """Quadratic maps of two or three states."""
    generator, u = _drawn(seed)
    n = int(generator.choice([2, 2, 3]))
    equations = {}
    for i in range(n):
        terms = [f"({u(-1, 1)})*p + ({u(-0.5, 0.5)})*q"]
        terms += [f"({u(-0.9, 0.9)})*x{j}" for j in range(n)]
        terms += [f"({u(-0.6, 0.6)})*x{j}*x{k}" for j in range(n) for k in range(j, n)]
        equations[f"x{i}"] = " + ".join(terms)
    states = dict.fromkeys(equations, 0.0)
    return Model(f"map {seed}", kind="map", states=states, parameters={"p": 0.0, "q": 0.2}, equations=equations), MAPS


def forced(seed):
    """Odd seeds: Duffing's equation, even ones: van der Pol's with a cubic term; every third one is symmetric."""
    _, u = _drawn(seed)
    damping = f"{u(0.05, 0.25)}*y" if seed % 2 else f"{u(0.1, 0.6)}*(x^2 - 1)*y"
    slope = u(-0.8, 1.2) if seed % 2 else u(0.8, 1.2)
    bend, cubic = u(-0.5, 0.5) if seed % 3 else 0.0, u(0.3, 1.2) if seed % 2 else u(0.0, 0.2)
    equations = {"x": "y", "y": f"-({damping}) - ({slope})*x - ({bend})*x^2 - {cubic}*x^3 + q*cos(w*t)"}
    states, parameters = {"x": 0.1, "y": 0.0}, {"w": 1.3, "q": u(1.0, 4.0)}
    forcing = {"period": "2*pi/w"}
    return Model(f"forced {seed}", states=states, parameters=parameters, forcing=forcing, equations=equations), FORCED
