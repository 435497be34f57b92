"""Models as XPPAUT's .ode files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from contin.exchange.imported import Exported
from contin.exchange.writing.language import XPP
from contin.exchange.writing.names import ForeignNames
from contin.exchange.writing.parts import checked, values, without_mass, written

if TYPE_CHECKING:
    from contin.model.model import Model

_RESERVED: Final = frozenset(
    "sin cos tan atan atan2 sinh cosh tanh exp delay ln log log10 t pi if then else asin acos heav sign ceil flr ran "
    "abs del_shft max min normal besselj bessely besseli erf erfc hom_bcs int sum of shift not mod sqrt set "
    "d done".split()
)
KEPT: Final = 9  # characters of a name: XPP keeps ten


def write(model: Model) -> Exported:
    """The .ode file of a flow or a map."""
    model, massless = without_mass(model, "an .ode file", algebraic=True)
    notes = checked(model, ("flow", "map"), "an .ode file")
    names = ForeignNames(_RESERVED, longest=KEPT, fold=True)
    symbols = {**names.all(model.state_names), **names.all(model.parameter_names), "t": "t"}
    observed = names.all(model.observables)
    text = written(model, XPP, symbols, lambda name: names.take(name, quiet=True), names.fresh())
    numbers = values(model)
    lines = [f"# {model.name}" + (f": {model.title}" if model.title else "")]
    lines += [f"par {symbols[name]}={value!r}" for name, value in numbers.parameters.items()]
    for name, value in numbers.states.items():
        lines.append(f"{'solve' if name in massless else 'init'} {symbols[name]}={value!r}")
    lines += [f"{name}={formula}" for name, formula in text.before]
    left = "{}(t+1)" if model.kind == "map" else "{}'"
    for name, formula in zip(model.state_names, text.equations, strict=True):
        lines.append(f"{'0' if name in massless else left.format(symbols[name])}={formula}")
    lines += [f"aux {observed[name]}={formula}" for name, formula in text.observables.items()]
    for start in model.starts:
        there = values(model, start.name)
        own = {**{k: there.states[k] for k in start.states}, **{k: there.parameters[k] for k in start.parameters}}
        items = ",".join(f"{symbols[k]}={v!r}" for k, v in own.items())
        lines.append(f"set {start.name.replace(' ', '-')} {{{items}}}")
    if model.parameters and model.parameters[0].range is not None:
        ends = model.parameter_range(model.parameters[0].name)
        if ends is not None:
            lines.append(f"@ parmin={ends[0]!r},parmax={ends[1]!r}")
    return Exported("\n".join([*lines, "done", ""]), (*notes, *names.notes))
