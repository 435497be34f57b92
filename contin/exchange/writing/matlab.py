"""Models as MatCont's system files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from contin.exchange.imported import Exported
from contin.exchange.writing.language import MATLAB
from contin.exchange.writing.names import ForeignNames
from contin.exchange.writing.parts import checked, values, without_mass, written

if TYPE_CHECKING:
    from contin.model.model import Model

_RESERVED: Final = frozenset(
    "t kmrgd dydt out init fun_eval tspan y0 options handles choose function end if else elseif for while switch case "
    "otherwise return break continue global persistent try catch classdef parfor spmd sin cos tan asin acos atan atan2 "
    "sinh cosh tanh asinh acosh atanh exp expm1 log log1p log10 sqrt abs sign min max floor ceil mod factorial pi i j "
    "jacobian jacobianp hessians hessiansp der3 der4 der5 feval odeset".split()
)
_CHOOSE: Final = """
% --------------------------------------------------------------------------
function value = choose(condition, one, other)
if condition
  value = one;
else
  value = other;
end
"""


def write(model: Model) -> Exported:
    """The system file of a flow (MatCont) or a map (MatContM)."""
    model, _ = without_mass(model, "a MatCont system file")
    notes = checked(model, ("flow", "map"), "a MatCont system file")
    if model.observables:
        notes.append("observables are not written: MatCont has no place for them in a system file")
    names = ForeignNames(_RESERVED)
    parameters = {name: f"par_{names.take(name)}" for name in model.parameter_names}
    states = names.all(model.state_names)
    fresh, title = names.fresh(), names.take(model.name, quiet=True)
    symbols = {**states, **parameters, "t": "t"}
    text = written(model, MATLAB, symbols, lambda name: names.take(name, quiet=True), fresh, observed=False)
    numbers = values(model)
    lines = [
        f"function out = {title}",
        *(["% map"] if model.kind == "map" else []),
        *(f"% {parameters[name]} = {value!r}" for name, value in numbers.parameters.items()),
        "out{1} = @init;",
        "out{2} = @fun_eval;",
        *(f"out{{{k}}} = [];" for k in range(3, 10)),
        "",
        "% --------------------------------------------------------------------------",
        f"function dydt = fun_eval({', '.join(['t', 'kmrgd', *parameters.values()])})",
        *(f"{states[name]} = kmrgd({i});" for i, name in enumerate(model.state_names, 1)),
        *(f"{name} = {formula};" for name, formula in text.before),
        "dydt = [" + ";\n".join(text.equations) + ";];",
        "",
        "% --------------------------------------------------------------------------",
        "function [tspan,y0,options] = init",
        f"handles = feval({title});",
        f"y0 = [{', '.join(repr(v) for v in numbers.states.values())}];",
        "options = odeset('Jacobian',[],'JacobianP',[],'Hessians',[],'HessiansP',[]);",
        "tspan = [0 10];",
    ]
    choose = _CHOOSE if any("choose(" in line for line in lines) else ""
    return Exported("\n".join(lines) + "\n" + choose, (*notes, *names.notes))
