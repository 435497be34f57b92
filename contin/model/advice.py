"""What to write instead: close declared names, and the spellings of other languages."""

from __future__ import annotations

from collections.abc import Container, Iterable, Sequence
from difflib import get_close_matches
from typing import Final

from contin.errors import InputError
from contin.model import features
from contin.model.vocabulary import FUNCTIONS

_FUNCTION_ADVICE: Final = {
    "sec": "1/cos(x)",
    "csc": "1/sin(x)",
    "cosec": "1/sin(x)",
    "cot": "1/tan(x)",
    "sech": "1/cosh(x)",
    "csch": "1/sinh(x)",
    "coth": "1/tanh(x)",
    "ln": "log(x)",
    "log2": "log(x)/log(2)",
    "arcsin": "asin(x)",
    "arccos": "acos(x)",
    "arctan": "atan(x)",
    "arctan2": "atan2(y, x)",
    "tg": "tan(x)",
    "sgn": "sign(x)",
    "signum": "sign(x)",
    "pow": "x^y",
    "power": "x^y",
    "square": "x^2",
    "sqr": "x^2",
    "cbrt": "sign(x)*abs(x)^(1/3)",
    "root": "x^(1/n)",
    "fabs": "abs(x)",
    "theta": "heaviside(x)",
    "step": "heaviside(x)",
    "h": "heaviside(x)",
    "sigmoid": "1/(1 + exp(-x))",
    "logistic": "1/(1 + exp(-x))",
    "arcsinh": "asinh(x)",
    "arccosh": "acosh(x)",
    "arctanh": "atanh(x)",
    "ceiling": "ceil(x)",
    "flr": "floor(x)",
    "int": "floor(x), or for an integral add a state whose rate is the integrand",
    "fmod": "mod(x, y)",
    "rem": "mod(x, y)",
    "gamma": "factorial(x - 1)",
    "minimum": "min(x, y)",
    "maximum": "max(x, y)",
    "where": "u if c else v",
    "piecewise": "u if c else v",
    "ifelse": "u if c else v",
    "iif": "u if c else v",
    "hypot": "sqrt(x^2 + y^2)",
    "sinc": "sin(x)/x",
    "rad": "x*pi/180",
    "deg": "x*180/pi",
}
_NAME_ADVICE: Final = {
    "i": "formulas are real: complex numbers are not available",
    "j": "formulas are real: complex numbers are not available",
    "π": "write pi",
    "e": "declare it, or write exp(1)",
    "inf": "infinity is not a number here",
    "infinity": "infinity is not a number here",
    "nan": "write a number",
    "true": "write a comparison such as x > 0",
    "false": "write a comparison such as x > 0",
    "t": "there is time in flows alone (kind: flow)",
    "lambda": "declare it to use it",
    "then": "write u if c else v",
    "xor": "write (a and not b) or (b and not a)",
}


def closest(word: str, known: Iterable[str]) -> str:
    """ "did you mean 'beta'?", or an empty text."""
    candidates = list(known)
    folded = {name.lower(): name for name in candidates}
    lower = word.lower()
    near = get_close_matches(lower, folded, n=3, cutoff=0.75)
    far = near or get_close_matches(lower, folded, n=3, cutoff=0.5 if len(word) <= 5 else 0.6)
    matches = [folded[m] for m in far]
    if not matches:
        return ""
    return f"did you mean {' or '.join(repr(m) for m in matches)}?"


def place_of_parameter(name: str, names: Sequence[str], key: str = "") -> int:
    """Where it stands among the names; InputError, which begins with the key, where it is none of them."""
    if name not in names:
        advice = closest(name, names) or f"the model has {', '.join(names) or 'none'}"
        raise InputError(f"{key}no parameter {name!r}: {advice}")
    return list(names).index(name)


def unknown_name(word: str, known: Iterable[str], calls: Container[str] = ()) -> str:
    """Sentence about a name that nothing declares."""
    known = list(known)
    lower = word.lower()
    if word in FUNCTIONS:
        return f"{word} is a function: write {word}(...) with its argument in parentheses"
    if lower == "pi":
        return f"unknown name {word!r}: write pi"
    feature, near = features.of_name(word, known, calls), closest(word, known)
    advice = "; or ".join(filter(None, [feature, near])) or _NAME_ADVICE.get(lower, "")
    if not advice:
        listed = ", ".join(known[:12]) + (", ..." if len(known) > 12 else "")
        advice = f"declared are {listed}" if known else "no names are declared here"
    return f"unknown name {word!r}: {advice}"


def unknown_function(word: str, known: Iterable[str]) -> str:
    """Sentence about a function that does not exist."""
    lower = word.lower()
    if lower in FUNCTIONS:
        return f"unknown function {word!r}: write {lower}(...)"
    if lower in _FUNCTION_ADVICE:
        return f"unknown function {word!r}: write {_FUNCTION_ADVICE[lower]}"
    known = list(known)
    feature = features.of_function(word, known)
    if feature:
        return f"{word!r}: {feature}"
    advice = closest(word, [*known, *FUNCTIONS]) or f"available are {', '.join(sorted([*known, *FUNCTIONS]))}"
    return f"unknown function {word!r}: {advice}"
