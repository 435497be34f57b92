"""Models as AUTO-07p's equations files, with a file of constants beside them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Final

from contin.exchange.imported import Exported
from contin.exchange.writing.language import FORTRAN
from contin.exchange.writing.names import ForeignNames
from contin.exchange.writing.parts import Values, checked, values, without_mass, written

if TYPE_CHECKING:
    from contin.model.model import Model

WIDTH: Final = 110  # characters of a line, of Fortran's 132
_RESERVED: Final = frozenset(
    "ndim u icp par ijac f dfdu dfdp t i j sin cos tan asin acos atan atan2 sinh cosh tanh asinh acosh atanh exp log "
    "log10 sqrt abs sign min max merge modulo anint gamma dble real int if then else end do call func stpnt bcnd icnd "
    "fopt pvls implicit none double precision intent in out inout integer subroutine".split()
)
_BREAK: Final = re.compile(r"(?<=[ ,*/])")
_REST: Final = """
SUBROUTINE BCND
END SUBROUTINE BCND

SUBROUTINE ICND
END SUBROUTINE ICND

SUBROUTINE FOPT
END SUBROUTINE FOPT

SUBROUTINE PVLS
END SUBROUTINE PVLS
"""


def places(count: int) -> list[int]:
    """Places of parameters in PAR: AUTO keeps the period in PAR(11)."""
    return [k if k <= 10 else k + 1 for k in range(1, count + 1)]


def write(model: Model) -> Exported:
    """FUNC and STPNT of a flow or a map, and its constants."""
    model, _ = without_mass(model, "AUTO's equations file")
    notes = checked(model, ("flow", "map"), "AUTO's equations file", time=False)
    if model.observables:
        notes.append("observables are not written: AUTO has them in PVLS")
    names = ForeignNames(_RESERVED, fold=True)
    symbols = {**names.all(model.state_names), **names.all(model.parameter_names)}
    text = written(model, FORTRAN, symbols, lambda name: names.take(name, quiet=True), names.fresh(), observed=False)
    slots = dict(zip(model.parameter_names, places(len(model.parameters)), strict=True))
    local = [*symbols.values(), *(name for name, _ in text.before)]
    lines = [
        f"! {model.name}",
        "SUBROUTINE FUNC(NDIM,U,ICP,PAR,IJAC,F,DFDU,DFDP)",
        "  IMPLICIT NONE",
        "  INTEGER, INTENT(IN) :: NDIM, ICP(*), IJAC",
        "  DOUBLE PRECISION, INTENT(IN) :: U(NDIM), PAR(*)",
        "  DOUBLE PRECISION, INTENT(OUT) :: F(NDIM)",
        "  DOUBLE PRECISION, INTENT(INOUT) :: DFDU(NDIM,NDIM), DFDP(NDIM,*)",
        *(line for name in local for line in _wrapped(f"DOUBLE PRECISION {name}")),
        *(f"  {symbols[name]} = U({i})" for i, name in enumerate(model.state_names, 1)),
        *(f"  {symbols[name]} = PAR({slot})" for name, slot in slots.items()),
        *(line for name, formula in text.before for line in _wrapped(f"{name} = {formula}")),
        *(line for i, formula in enumerate(text.equations, 1) for line in _wrapped(f"F({i}) = {formula}")),
        "END SUBROUTINE FUNC",
        "",
        *_start(model, values(model), slots),
    ]
    beside = {"c.{stem}": _constants(model, symbols, slots)}
    return Exported("\n".join(lines) + "\n" + _REST, (*notes, *names.notes), beside)


def _start(model: Model, numbers: Values, slots: Mapping[str, int]) -> Iterator[str]:
    yield "SUBROUTINE STPNT(NDIM,U,PAR,T)"
    yield "  IMPLICIT NONE"
    yield "  INTEGER, INTENT(IN) :: NDIM"
    yield "  DOUBLE PRECISION, INTENT(INOUT) :: U(NDIM), PAR(*)"
    yield "  DOUBLE PRECISION, INTENT(IN) :: T"
    for name, slot in slots.items():
        yield f"  PAR({slot}) = {_literal(numbers.parameters[name])}  ! {name}"
    for i, name in enumerate(model.state_names, 1):
        yield f"  U({i}) = {_literal(numbers.states[name])}  ! {name}"
    yield "END SUBROUTINE STPNT"


def _literal(value: float) -> str:
    return ("-" if value < 0 else "") + FORTRAN.number(abs(value))


def _wrapped(text: str) -> Iterable[str]:
    """A statement on as many lines as it needs."""
    row = "  "
    for part in _BREAK.split(text):
        if len(row) + len(part) > WIDTH and row.strip():
            yield row.rstrip() + " &"
            row = "      "
        row += part
    yield row


def _constants(model: Model, symbols: Mapping[str, str], slots: Mapping[str, int]) -> str:
    """Constants of a run along the first parameter, over its range where it has one."""
    states = ", ".join(f"{i}: '{symbols[name]}'" for i, name in enumerate(model.state_names, 1))
    parameters = ", ".join(f"{slot}: '{symbols[name]}'" for name, slot in slots.items())
    free = next((p for p in model.parameters if p.range is not None), next(iter(model.parameters), None))
    ends = None if free is None else model.parameter_range(free.name)
    step = 0.01 * (ends[1] - ends[0]) if ends is not None else 0.01
    largest = max([11, *slots.values()])
    stop = f"UZSTOP = {{'{symbols[free.name]}': [{ends[0]!r}, {ends[1]!r}]}}\n" if free is not None and ends else ""
    return (
        f"unames = {{{states}}}\nparnames = {{{parameters}}}\n"
        f"NDIM = {len(model.states)}, IPS = {-1 if model.kind == 'map' else 1}, IRS = 0, ILP = 1\n"
        f"ICP = [{'' if free is None else repr(symbols[free.name])}]\n"
        "NTST = 50, NCOL = 4, IAD = 3, ISP = 2, ISW = 1, IPLT = 0, NBC = 0, NINT = 0\n"
        "NMX = 500, NPR = 100, MXBF = 10, IID = 2, ITMX = 9, ITNW = 5, NWTN = 3, JAC = 0\n"
        "EPSL = 1e-07, EPSU = 1e-07, EPSS = 1e-05\n"
        f"DS = {step!r}, DSMIN = {step / 1000!r}, DSMAX = {step * 5!r}, IADS = 1\n"
        f"NPAR = {max(36, largest)}, THL = {{11: 0.0}}, THU = {{}}\n{stop}"
    )
