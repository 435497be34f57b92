"""Which columns the results of a run file can have: what `outputs: {x, y}` and `values` may name."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from contin.continuation.spectra import NAMES
from contin.errors import ContinError
from contin.model.advice import closest
from contin.model.model import Model
from contin.model.relations import measure
from contin.model.source import Path, Problems

OF_BRANCHES: Final = frozenset(
    {
        "period", "stable", "unstable", "kappa", "neutral", "cos.theta", "unfolding", "turns", "saddle_node", "angle",
        "amplitude", "norm", "frequency", "rotation", "size", "nodes", "tail", "error", *NAMES,
    }
)  # beside parameters, states and observables: what problems record of themselves
STANDARD: Final = ("amplitude", "norm", "frequency")  # of orbits
PARTS: Final = frozenset({"min", "max", "start", "end", "norm", "saddle", "saddle2", "cycle", "mean"})  # of a state
SHOWN: Final = ("min", "max")  # of these, in a message
OF_MANY: Final = frozenset({"norm", "min", "max"})  # in place of many states


def formulas(names: Iterable[str], model: Model, others: Iterable[str] = ()) -> list[str]:
    """Those names that are no columns by themselves but formulas, such as mean(x^2), which orbits record."""
    named = [*model.parameter_names, *model.state_names, *model.observables, *others]
    found = dict.fromkeys(name for name in names if not _is_known(name, named))
    return [name for name in found if isinstance(model, Model) and not _mistake(name, model)]


def check_columns(
    written: Iterable[tuple[Path, str | None]], model: Model, problems: Problems, others: Iterable[str] = ()
) -> None:
    """Note each name that can be no column of this model's branches, nor one of `others`; `s.min` counts as s.

    Formulas such as mean(x^2) can be columns.
    """
    named = [*model.parameter_names, *model.state_names, *model.observables, *others]
    for path, name in written:
        if name is None or _is_known(name, named):
            continue
        if _mistake(name, model):
            advice = closest(name, [*named, "period"]) or column_mistake(name, model)
            advice = advice or f"there are {', '.join(named[:30])}, and of a state its {', '.join(SHOWN)}"
            problems.add(path, f"there is no column {name!r}: {advice}")


def column_mistake(name: str, model: object) -> str:
    """What is wrong with what looks like a formula; '' for anything else, and where nothing is."""
    return _mistake(name, model) if "(" in name else ""


def _mistake(formula: str, model: object) -> str:
    """Why a formula is no number of an orbit; '' where it is one."""
    if not isinstance(model, Model) or model.kind != "flow":
        return "formulas such as mean(x^2) are columns of periodic orbits"
    try:
        measure(model, formula)
    except ContinError as error:
        return str(error)
    return ""


def _is_known(name: str, named: list[str]) -> bool:
    if name in named or name in OF_BRANCHES | OF_MANY:
        return True
    # x.min, x.saddle, x.cycle.min, x.1: of orbits, connections, cycles of maps; u.max.min: of orbits of fields
    words = name.split(".")
    return any(
        ".".join(words[:k]) in named and all(word in PARTS or word.isdigit() for word in words[k:])
        for k in range(1, len(words))
    )
