"""Which columns the results of a run file can have: what `outputs: {x, y}` and `values` may name."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Final

from contin.model.advice import closest
from contin.model.source import Path, Problems

if TYPE_CHECKING:
    from contin.model.model import Model

OF_BRANCHES: Final = frozenset(
    {
        "period", "stable", "unstable", "kappa", "neutral", "cos.theta", "unfolding", "turns", "saddle_node", "angle",
        "amplitude", "norm",
    }
)  # beside parameters, states and observables: what problems record of themselves
OF_MANY: Final = frozenset({"norm", "min", "max"})  # in place of many states


def check_columns(
    written: Iterable[tuple[Path, str | None]], model: Model, problems: Problems, others: Iterable[str] = ()
) -> None:
    """Note each name that can be no column of this model's branches, nor one of `others`; `s.min` counts as s."""
    named = [*model.parameter_names, *model.state_names, *model.observables, *others]
    for path, name in written:
        if name is not None and not _is_known(name, named):
            advice = closest(name, [*named, "period"]) or f"there are {', '.join(named[:30])}"
            problems.add(path, f"there is no column {name!r}: {advice}")


def _is_known(name: str, named: list[str]) -> bool:
    if name in named or name in OF_BRANCHES | OF_MANY:
        return True
    # x.min, x.saddle, x.1: of orbits, connections, cycles of maps; u.max.min: of orbits of fields
    return "." in name and (name.split(".")[0] in named or name.rpartition(".")[0] in named)
