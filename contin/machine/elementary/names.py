"""Which elementary functions there are, and what they are called in machine code."""

from typing import Final

FUNCTIONS: Final = {
    **dict.fromkeys(("exp", "exp2", "expm1"), "exponential"),
    **dict.fromkeys(("log", "log1p", "log10", "log2"), "logarithm"),
    "pow": "power",
    **dict.fromkeys(("sin", "cos", "sincos", "tan"), "circular"),
    **dict.fromkeys(("asin", "acos", "atan", "atan2"), "inverse_circular"),
    **dict.fromkeys(("sinh", "cosh", "tanh", "asinh", "acosh", "atanh"), "hyperbolic"),
    "hypot": "distance",
}
"""Elementary functions by their names in C, with the module each is written in; `sincos` gives sine and cosine."""

PREFIX: Final = "contin_"


def symbol(name: str) -> str:
    """The symbol under which an elementary function is exported."""
    return PREFIX + name
