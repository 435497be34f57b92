"""What verbs that follow branches take of a model: at fixed conserved totals, and with at least one parameter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np

from contin.model.expression import ZERO
from contin.model.kept import kept_with
from contin.model.model import Model
from contin.model.parts import Parameter
from contin.records import Fields, Record
from contin.symbolic.passes.conserved import without_conserved

NO_PARAMETER: Final = "no_parameter"  # stands where a model has none: nothing depends on it

AUTO: Final = "auto"


def for_branches(model: object) -> Any:
    """The model whose solutions are isolated as far as linear conserved quantities are concerned.

    A model without parameters gets one that nothing depends on: its solutions can be found, if not followed.
    """
    found = without_conserved(model)
    if isinstance(found, Model) and not found.parameters and found.interval is None:
        return kept_with(found, NO_PARAMETER, lambda: found.replace(parameters=(Parameter(NO_PARAMETER, ZERO),)))
    return found


def is_auto(model: Any, start: object) -> bool:
    """True where a start is to be found (`start: auto`), unless the model has a start of this name."""
    return isinstance(start, str) and start == AUTO and all(s.name != AUTO for s in getattr(model, "starts", ()))


def varying(names: Sequence[str]) -> list[str]:
    """The parameters that can be varied."""
    return [name for name in names if name != NO_PARAMETER]


def named_start(model: Any, start: Any) -> Any:
    """A start given as numbers in the order of all states, by the names of the states."""
    if start is None or isinstance(start, str | Mapping) or not isinstance(model, Model):
        return start
    values = list(start)
    if len(values) != len(model.state_names):
        return start  # which is told where it is read
    return dict(zip(model.state_names, values, strict=True))


def named_table(model: Any, reduced: Any, table: Any, parameters: Record | None) -> tuple[Any, Fields]:
    """Samples (K, n) of all states as samples of those that are left, and the parameters with the totals on them."""
    given = dict(parameters or {})
    if reduced is model or not getattr(reduced, "totals", ()) or table.shape[1:] != (len(model.state_names),):
        return table, given
    first = dict(zip(model.state_names, table[0], strict=True))
    _, p = reduced.start_point({n: float(v) for n, v in first.items()}, given)
    totals = {t.name for t in reduced.totals}
    sums = {n: float(v) for n, v in zip(reduced.parameter_names, p, strict=True) if n in totals}
    columns = [model.state_names.index(n) for n in reduced.state_names]
    return np.ascontiguousarray(table[:, columns]), {**sums, **given}
