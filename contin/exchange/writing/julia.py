"""Models as Julia functions, as OrdinaryDiffEq and BifurcationKit take them; the file itself needs no package."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from contin.exchange.imported import Exported
from contin.exchange.writing.language import JULIA
from contin.exchange.writing.names import ForeignNames
from contin.exchange.writing.parts import checked, values, without_mass, written

if TYPE_CHECKING:
    from contin.model.model import Model

_RESERVED: Final = frozenset(
    "t u p du f f! u0 p0 observables baremodule begin break catch const continue do else elseif end export false "
    "finally for function global if import let local macro module quote return struct true try using while sin cos tan "
    "asin acos atan sinh cosh tanh asinh acosh atanh exp expm1 log log1p log10 sqrt abs sign min max floor ceil mod "
    "prod pi".split()
)


def write(model: Model) -> Exported:
    """f!(du, u, p, t), f(u, p), u0, p0 and observables(u, p)."""
    model, _ = without_mass(model, "a Julia file")
    notes = checked(model, ("flow", "map"), "a Julia file")
    names = ForeignNames(_RESERVED)
    symbols = {**names.all(model.state_names), **names.all(model.parameter_names), "t": "t"}
    text = written(model, JULIA, symbols, lambda name: names.take(name, quiet=True), names.fresh())
    numbers = values(model)
    order = [symbols[name] for name in model.parameter_names]
    result = "the next state" if model.kind == "map" else "the derivatives"
    head = [f"    {', '.join(symbols[name] for name in model.state_names)}{_comma(model.states)} = u"]
    head += [f"    (; {', '.join(order)}) = p"] if order else []
    head += [f"    {name} = {formula}" for name, formula in text.before]
    first = f"p0.{order[0]}" if order else "..."
    lines = [
        f"# {model.name}" + (f": {model.title}" if model.title else ""),
        "# using OrdinaryDiffEq; solve(ODEProblem(f!, u0, (0.0, 100.0), p0))",
        f"# using BifurcationKit; BifurcationProblem(f, u0, p0, (@optic _.{first.removeprefix('p0.')}))",
        f"u0 = [{', '.join(repr(v) for v in numbers.states.values())}]",
        f"p0 = (; {', '.join(f'{symbols[k]} = {v!r}' for k, v in numbers.parameters.items())})",
        "",
        f'"{result} at u, into du"',
        "function f!(du, u, p, t = 0.0)",
        *head,
        *(f"    du[{i}] = {formula}" for i, formula in enumerate(text.equations, 1)),
        "    return du",
        "end",
        "",
        "f(u, p, t = 0.0) = f!(similar(u, promote_type(eltype(u), typeof.(values(p))...)), u, p, t)",
    ]
    if text.observables:
        fields = ForeignNames(_RESERVED)
        items = [f"        {fields.take(name)} = {formula}," for name, formula in text.observables.items()]
        lines += ["", "function observables(u, p, t = 0.0)", *head, "    return (;", *items, "    )", "end"]
    return Exported("\n".join(lines) + "\n", (*notes, *names.notes))


def _comma(states: tuple[object, ...]) -> str:
    return "," if len(states) == 1 else ""
