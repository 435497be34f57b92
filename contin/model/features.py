"""What formulas cannot say, by name: delays, noise, integrals, derivatives. The message says what to write instead."""

from __future__ import annotations

import re
from collections.abc import Container
from typing import Final

DELAY: Final = (
    "delay equations are not supported: rates depend on the present states alone. A chain of states, "
    "x1 = n/tau*(x - x1), x2 = n/tau*(x1 - x2), ... approximates x at time t - tau; in maps add a state, xold = x"
)
NOISE: Final = (
    "stochastic equations are not supported: continuation follows solutions of deterministic ones. Leave the noise out"
)
INTEGRAL: Final = (
    "integrals are not supported in equations: a state whose rate is the integrand stands for one over time. "
    "kind: bvp takes integral(...) in conditions, kind: pde in observables"
)
SPACE: Final = "derivatives in space need kind: pde, with a domain and fields (docs: your PDE)"
RATE: Final = (
    "derivatives in time are not supported in formulas: the equation of a state is its rate; "
    "for x'' = f write two states, x: v and v: f"
)
FRACTIONAL: Final = "fractional derivatives are not supported"
MATRIX: Final = (
    "sums, vectors and matrices are not supported in formulas: write the terms out, or give a Python function"
)
SPECIAL: Final = "special functions are not supported in formulas: give the equations as a Python function"

_FUNCTIONS: Final = {
    **dict.fromkeys(("delay", "delayed", "lag", "past", "prev", "del_shift", "shift"), DELAY),
    **dict.fromkeys(
        ("noise", "normal", "gauss", "gaussian", "ran", "rand", "randn", "random", "uniform", "wiener", "dw"),
        NOISE,
    ),
    **dict.fromkeys(("integral", "integrate", "quad", "trapz", "conv", "convolve", "convolution"), INTEGRAL),
    **dict.fromkeys(("mean", "norm", "average"), INTEGRAL),
    **dict.fromkeys(("dx", "dy", "dz", "dxx", "dyy", "dxy", "dxxxx", "dn", "lap", "laplacian", "laplace"), SPACE),
    **dict.fromkeys(("grad", "gradient", "div", "divergence", "nabla", "curl"), SPACE),
    **dict.fromkeys(("d", "diff", "deriv", "derivative", "ddt", "dot", "der"), RATE),
    **dict.fromkeys(("caputo", "fracdiff", "fractional"), FRACTIONAL),
    **dict.fromkeys(("sum", "prod", "product", "matmul", "transpose", "inv", "det", "trace", "outer"), MATRIX),
    **dict.fromkeys(("erf", "erfc", "bessel", "besselj", "bessely", "airy", "zeta", "lambertw", "ellipk"), SPECIAL),
}  # fmt: skip
_NAMES: Final = {
    **dict.fromkeys(("noise", "wiener", "brownian", "dw", "dwt", "whitenoise", "white_noise"), NOISE),
    **dict.fromkeys(("u_xx", "uxx", "u_x", "v_xx", "vxx", "laplacian", "nabla"), SPACE),
}
_KINDS: Final = {
    "dde": DELAY,
    "delay": DELAY,
    "sde": NOISE,
    "stochastic": NOISE,
    "ode": "write flow",
    "dae": "write flow, with mass: {y: 0} for a state y without a rate (docs: mass matrices)",
    "hybrid": "write flow, with events:",
}
_KEYS: Final = {
    **dict.fromkeys(("delays", "delay", "lags", "history"), DELAY),
    **dict.fromkeys(("noise", "wiener", "diffusion", "sde"), NOISE),
    **dict.fromkeys(("domain", "fields", "boundary"), "it belongs to kind: pde (docs: your PDE)"),
    **dict.fromkeys(
        ("aux", "auxiliary", "auxiliaries", "expressions", "intermediates", "let", "macros", "rates", "where"),
        "names for parts of equations stand under definitions: {name: formula}",
    ),
    **dict.fromkeys(
        ("dynamics", "ode", "odes", "rhs", "vector_field"), "rates stand under equations: {state: formula}"
    ),
    **dict.fromkeys(
        ("init", "initial", "initial_conditions", "initial_values", "variables", "vars"),
        "states, with the values that runs start from, stand under states: {name: value}",
    ),
}
_DELAYED: Final = re.compile(r"(.+?)_?(tau\d*|delay|delayed|lag|lagged|past|prev|previous)")
_LEIBNIZ: Final = re.compile(r"d(2|3|4)?([A-Za-z]\w*)")
_OF_FIELDS: Final = "derivatives of a field u along an axis x are dx(u), dxx(u), with a second axis dxy(u), lap(u)"
_PAST: Final = re.compile(r"\[\s*[A-Za-z]\w*\s*[-+]")


def of_function(word: str, known: Container[str]) -> str:
    """The sentence about a function that stands for a feature contin does not have; empty where it is none."""
    feature = _FUNCTIONS.get(word.lower(), "")
    if feature is SPACE and "lap" in known:
        return _OF_FIELDS
    return feature


def of_name(word: str, known: Container[str], calls: Container[str] = ()) -> str:
    """The same of a name: x_tau where there is a state x, dW, dx."""
    delayed = _DELAYED.fullmatch(word)
    if delayed and delayed[1] in known:
        return f"if this is {delayed[1]} at an earlier time: {DELAY}"
    leibniz = _LEIBNIZ.fullmatch(word)
    if leibniz and leibniz[2] in known:
        return SPACE if leibniz[1] else RATE
    feature = _NAMES.get(word.lower(), "")
    return _OF_FIELDS if feature is SPACE and "lap" in calls else feature


def of_brackets(text: str) -> str:
    """x[t - 1], x[n-1]: the value of another time."""
    return DELAY if _PAST.match(text) else ""


def of_kind(word: object) -> str:
    """What to say of a `kind:` that does not exist; empty where nothing is known of it."""
    return _KINDS.get(str(word).lower(), "")


def of_key(word: str) -> str:
    """The same of a key of model files."""
    return _KEYS.get(word.lower(), "")
