"""Small models in which each verb has something to find; the harsh ones among them start at zero."""

from __future__ import annotations

from dataclasses import replace

from contin.model.expression import number
from contin.model.model import Model

FHN = Model(
    "fitzhugh-nagumo", states={"v": -1.2, "w": -0.6},
    parameters={"I": {"value": 0, "range": [0, 2]}, "e": {"value": 0.08, "range": [0.02, 0.2]}},
    equations={"v": "v - v^3/3 - w + I", "w": "e*(v + 0.7 - 0.8*w)"},
)  # fmt: skip
CUSP = Model(
    "cusp", states={"x": -2}, parameters={"p": {"value": -3, "range": [-3, 3]}, "q": {"value": 3, "range": [-1, 4]}},
    equations={"x": "p + q*x - x^3"},
)  # fmt: skip
PITCHFORK = Model(
    "pitchfork", states={"x": 0, "y": 0}, parameters={"p": {"value": -1, "range": [-1, 1]}},
    equations={"x": "p*x - x^3 + x*y", "y": "-y + 0.3*x^2"}, symmetries={"flip": {"x": "-x"}},
)  # fmt: skip
HENON = Model(
    "henon", kind="map", states={"x": 0.3, "y": 0.1}, parameters={"a": {"value": 0.2, "range": [-0.3, 0.6]}, "b": 0.3},
    equations={"x": "1 - a*x^2 + y", "y": "b*x"},
)  # fmt: skip
DELAYED = Model(
    "delayed-logistic", kind="map", states={"x": 0.3, "y": 0.3}, parameters={"r": {"value": 1.5, "range": [1.1, 2.3]}},
    equations={"x": "r*x*(1 - y)", "y": "x"},
)  # fmt: skip
DOUBLE_ZERO = Model(  # the unfolding of Bogdanov and Takens, with further terms
    "double-zero", states={"x": 1, "y": 0},
    parameters={"a": {"value": -1, "range": [-1, 0.5]}, "b": {"value": -0.5, "range": [-1, 1]}},
    equations={"x": "y", "y": "a + b*y + x^2 + x*y + 0.3*x^3"},
)  # fmt: skip
SADDLE_LOOP = Model(  # x'' = x - x^2 + small damping: the loop of x' = 0 exists at nu near 6/7 mu (here mu = 1)
    "loop", states={"x": 1, "y": 0}, parameters={"nu": {"value": 1.1, "range": [0.5, 1.5]}, "e": 0.2},
    equations={"x": "y", "y": "x - x^2 + e*y*(x - nu)"},
)  # fmt: skip
VDP = Model(
    "van-der-pol", states={"x": 2, "y": 0}, parameters={"m": {"value": 1, "range": [0.2, 3]}},
    equations={"x": "y", "y": "m*(1 - x^2)*y - x"},
)  # fmt: skip
BRATU = Model(
    "bratu", kind="bvp", time={"name": "s"}, states={"u": 0, "v": 0}, parameters={"lam": {"value": 0, "range": [0, 4]}},
    equations={"u": "v", "v": "-lam*exp(u)"}, conditions=["u(start) = 0", "u(end) = 0"],
    observables={"height": "max(u)"},
)  # fmt: skip
FREED = Model(  # u'' = -lam, integral(u) = lam/3, with a fold of s in lam
    "freed", kind="bvp", states={"u": 0, "v": 0}, parameters={"lam": {"value": 0, "range": [-1, 2]}, "s": 0},
    equations={"u": "v", "v": "-lam"}, conditions=["u(start) = 0", "v(end) = 0", "integral(u) = s + lam^2"],
)  # fmt: skip
CIRCLES = Model(
    "circles", kind="algebraic", states={"x": -0.9, "y": 0.1}, parameters={"p": {"value": -0.5, "range": [-2, 2]}},
    equations={"x": "x^2 + p^2 - 1", "y": "y*(x - 0.5) + 0.1*y^3"},
)  # fmt: skip
NAGUMO = Model(
    "nagumo", states={"u": 0, "v": 0},
    parameters={"a": {"value": 0.25, "range": [0.1, 0.4]}, "c": {"value": 0.35, "range": [-1, 1]}},
    equations={"u": "v", "v": "-c*v - u*(1 - u)*(u - a)"},
)  # fmt: skip
BAUTIN = Model(
    "bautin", states={"x": 0, "y": 0},
    parameters={"a": {"value": -0.5, "range": [-0.6, 0.6]}, "b": {"value": 0.5, "range": [-1, 1.2]}},
    definitions={"r": "x^2 + y^2"},
    equations={"x": "a*x - y + b*x*r - x*r^2", "y": "x + a*y + b*y*r - y*r^2"},
)  # fmt: skip
TWISTED = Model(  # doublings of the unit circle at p = 0, and on it a degenerate one at q = 0
    "twisted", states={"x": 1, "y": 0, "u": 0, "v": 0},
    parameters={"p": {"value": -0.2, "range": [-0.3, 0.3]}, "q": {"value": 0.5, "range": [-1, 1]}},
    definitions={"R": "1 - x^2 - y^2", "c": "x", "s": "y", "U": "p - q*(u^2 + v^2)",
                 "A": "0.5*(1 + c)*U - 0.5*(1 - c)", "B": "0.5*s*(U + 1)", "D": "0.5*(1 - c)*U - 0.5*(1 + c)"},
    equations={"x": "x*R - y", "y": "y*R + x", "u": "A*u + (B - 0.5)*v", "v": "(B + 0.5)*u + D*v"},
)  # fmt: skip
HALVES = Model(  # folds where al be = tanh(pi/4)/pi
    "halves", states={"x": 1.0, "y": 0.0},
    parameters={"al": {"value": 1, "range": [0.2, 3]}, "be": {"value": 0.1, "range": [0.05, 0.4]}},
    definitions={"R": "x^2 + y^2", "g": "(al - R)/(2*R) if y > 0 else be*R/2"},
    equations={"x": "x*g - y", "y": "y*g + x"},
)  # fmt: skip
DRIVEN = Model(
    "driven", states={"x": 0.1, "y": 0}, forcing={"period": "2*pi/w"},
    parameters={"w": {"value": 0.8, "range": [0.8, 2.2]}, "F": 0.4, "k": 0.2},
    equations={"x": "y", "y": "-x - x^3 - k*y + F*cos(w*t)"},
)  # fmt: skip
PENDULUM = Model(
    "pendulum", states={"q": 0, "v": 0}, parameters={"d": {"value": -0.3, "range": [-0.5, 0.5]}},
    equations={"q": "v", "v": "-q + q^3/6 - d*v"},
)  # fmt: skip
SLIDING = Model(
    "sliding", states={"x": -1, "y": 0}, parameters={"p": {"value": -1, "range": [-1.5, 1.5]}},
    equations={"x": "p - x + (1 if y > 0.1 else 0)", "y": "x - y + 0.3"},
)  # fmt: skip
LOGISTIC = Model(
    "logistic", kind="map", states={"x": 0.6}, parameters={"r": {"value": 2.5, "range": [2.2, 3.5]}},
    equations={"x": "r*x*(1 - x)"},
)  # fmt: skip
HENON_PLANE = HENON.replace(
    parameters=tuple(replace(p, range=(number(-0.4), number(0.6)) if p.name == "b" else p.range)
                     for p in HENON.parameters)
)  # fmt: skip
ROTATED = Model(
    "exchange", states={"x": 0.1, "y": 0.1},
    parameters={"p": {"value": -0.5, "range": [-0.5, 1]}, "k": {"value": 0.3, "range": [0.05, 1]}},
    equations={"x": "p*x - x^3 + k*(y - x)", "y": "p*y - y^3 + k*(x - y)"},
    symmetries={"exchange": {"x": "y", "y": "x"}, "flip": {"x": "-x", "y": "-y"}},
)  # fmt: skip
