"""AUTO-07p's equations file of a contin model: flows, maps, algebraic and boundary-value problems."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from beside import continued, formula

from contin.abi import Array
from contin.model.expression import Expression, number, substitute, symbol, symbols_in
from contin.model.model import Model
from contin.model.printing import to_text

FIRST = 9  # parameters from here on stand behind those that AUTO uses itself (its period is the eleventh)
BEHIND = 21
NPAR = 60


def place(k: int) -> int:
    """AUTO's number of the k-th parameter (from 0)."""
    return k + 1 if k < FIRST else k + BEHIND


def dimension(model: Model) -> int:
    """Of AUTO's problem: equations that use their independent variable have it as one unknown more."""
    return len(model.states) + uses_time(model)


def uses_time(model: Model) -> bool:
    return model.interval is not None and model.interval.name in symbols_in(list(model.equations))


def boundary_counts(model: Model) -> tuple[int, int]:
    """NBC and NINT."""
    integrals = sum(_is_integral(model, c.residual) for c in model.conditions)
    return len(model.conditions) - integrals + uses_time(model), integrals


def fortran(model: Model, u: Array, parameters: Mapping[str, float]) -> str:
    """u(k) is the k-th state, par(place(k)) the k-th parameter; u, parameters : at the start."""
    names = {name: f"par({place(k)})" for k, name in enumerate(model.parameter_names)}
    names |= {name: f"u({k + 1})" for k, name in enumerate(model.state_names)}
    rates, extra = list(model.equations), []
    if model.interval is not None:
        length = model.interval.end - model.interval.start
        if uses_time(model):
            names[model.interval.name] = f"u({len(rates) + 1})"
            rates.append(number(1))
            extra = [f"fb(nbc) = u0({len(rates)}) - ({formula(to_text(model.interval.start), names)})"]
        rates = [length * rate for rate in rates]
    values = [f"par({place(k)}) = {_literal(parameters[name])}" for k, name in enumerate(model.parameter_names)]
    body = [
        *_header("func(ndim, u, icp, par, ijac, f, dfdu, dfdp)", "ndim, icp(*), ijac", "u(ndim), par(*)",
                 "f(ndim)", "dfdu(ndim, *), dfdp(ndim, *)"),
        *[f"f({k + 1}) = {formula(to_text(rate), names)}" for k, rate in enumerate(rates)],
        "end subroutine",
        *_header("stpnt(ndim, u, par, t)", "ndim", "t", "", "u(ndim), par(*)"),
        *values,
        *[f"u({k + 1}) = {_literal(float(x))}" for k, x in enumerate(u)],
        "end subroutine",
        *_header("bcnd(ndim, par, icp, nbc, u0, u1, fb, ijac, dbc)", "ndim, icp(*), nbc, ijac",
                 "par(*), u0(ndim), u1(ndim)", "fb(nbc)", "dbc(nbc, *)"),
        *_conditions(model, names), *extra,
        "end subroutine",
        *_header("icnd(ndim, par, icp, nint, u, uold, udot, upold, fi, ijac, dint)", "ndim, icp(*), nint, ijac",
                 "par(*), u(ndim), uold(ndim), udot(ndim), upold(ndim)", "fi(nint)", "dint(nint, *)"),
        *_integrals(model, names),
        "end subroutine",
    ]  # fmt: skip
    for name in ("fopt", "pvls"):
        body += [f"subroutine {name}", "end subroutine"]
    return "\n".join(continued(line) for line in body) + "\n"


def _header(name: str, whole: str, known: str, result: str, either: str) -> list[str]:
    lines = [
        f"subroutine {name}", "implicit none", f"integer, intent(in) :: {whole}",
        f"double precision, intent(in) :: {known}", f"double precision, intent(inout) :: {either}",
        "double precision, parameter :: pi = 3.141592653589793d0",
    ]  # fmt: skip
    return [*lines, f"double precision, intent(out) :: {result}"] if result else lines


def _literal(x: float) -> str:
    return f"{x:.17e}".replace("e", "d")


def _is_integral(model: Model, residual: Expression) -> bool:
    return any(
        model.functionals[name].kind == "integral" for name in symbols_in([residual]) if name in model.functionals
    )


def _conditions(model: Model, names: Mapping[str, str]) -> list[str]:
    """fb(k) = g, with u0 and u1 for the values at the ends."""
    ends = dict(names)
    meaning = {}
    for name, functional in model.functionals.items():
        if functional.kind in ("start", "end"):
            stand_in = f"{functional.kind}_{model.state_names.index(to_text(functional.inner))}"
            meaning[symbol(name)] = symbol(stand_in)
            column = model.state_names.index(to_text(functional.inner)) + 1
            ends[stand_in] = f"u{int(functional.kind == 'end')}({column})"
    plain = [c.residual for c in model.conditions if not _is_integral(model, c.residual)]
    return [f"fb({k + 1}) = {formula(to_text(g), ends)}" for k, g in enumerate(substitute(plain, meaning))]


def _integrals(model: Model, names: Mapping[str, str]) -> list[str]:
    """fi(k), whose integral over [0, 1] vanishes: of conditions in which integrals stand linearly."""
    if model.interval is None:
        return []
    length = model.interval.end - model.interval.start
    meaning = {symbol(n): length * f.inner for n, f in model.functionals.items() if f.kind == "integral"}
    found = substitute([c.residual for c in model.conditions if _is_integral(model, c.residual)], meaning)
    return [f"fi({k + 1}) = {formula(to_text(g), names)}" for k, g in enumerate(found)]


def table(times: Array, columns: Sequence[Array]) -> str:
    """A start of AUTO's: time and unknowns by rows."""
    return "".join(" ".join(f"{x:.16e}" for x in row) + "\n" for row in zip(times, *columns, strict=True))


def of_number(text: str) -> float:
    """A number as Fortran prints it, whose exponent of three digits has no letter."""
    return float(re.sub(r"(?<=\d)([-+]\d{3})$", r"E\1", text))
