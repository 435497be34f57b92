"""One branch, whole or point by point."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from typing import Any

import numpy as np

from contin import lazy
from contin.api.seeds import FoundByItself, Range, extrema_of, placed, targets_of
from contin.continuation.branch import Branch, End
from contin.continuation.departure import depart
from contin.continuation.journal import Journal
from contin.continuation.rows import Rows
from contin.continuation.settings import Settings
from contin.continuation.trace import Watcher, followed, trace
from contin.errors import InputError
from contin.records import Fields, Record
from contin.symbolic.passes.conserved import conserved_notes


def continuation(
    start: Any,
    parameter: str | Sequence[str],
    range: Range | None = None,
    *,
    name: str = "branch",
    direction: str = "both",
    values: Mapping[str, Sequence[float]] | None = None,
    extrema: Sequence[str] = (),
    columns: Sequence[str] = (),
    shown: Sequence[str] = (),
    conditions: Sequence[str] = (),
    free: Sequence[str] = (),
    settings: Settings | Record | None = None,
    watch: Watcher | None = None,
    journal: Journal | None = None,
) -> Branch:
    """Follow the branch through `start` while `parameter` varies in `range`, and label its special points.

    start : an `Equilibrium`, a model (solved from the states' values, or u0 of a `FunctionProblem`), or a seed from
        `point.switch()`; of a list of seeds the first is followed.
        A curve of special points in two parameters starts from `point.locus()`, with the pair of names for `parameter`.
    range : (lo, hi), for two parameters {name: (lo, hi)}; default the range that the model gives for the parameter.
    direction : 'up' or 'down' follows one arm only, in the sense in which the parameter changes on leaving the start.
    values : {column: [values]} marks these values of the parameter, a state or an observable as UZ points.
    extrema : columns that are labelled EX where they turn along the branch.
    columns : of families of orbits, formulas that become columns: 'mean(x^2)', 'integral(v*i)', 'max(x) - min(y)', on
        top of the amplitude, norm and frequency. What `values` and `extrema` name so needs no mention here.
    shown : the same, for a picture of several branches: on a branch that has no orbits they say nothing.
    conditions, free : equations such as 'period = 5' that the solutions meet, and as many parameters, which are solved
        for beside the one that varies.
    watch : called with a mapping (parameter, value, fraction, rows, labels) after every chunk.
    journal : keeps every chunk, and answers with those of an earlier, killed run (see `contin.continuation.journal`).
    """
    seed, bounds = placed(start, parameter, range)
    asked = [*columns, *shown, *(values or {}), *extrema]
    if conditions or free:
        seed = lazy.module("conditions").under_conditions(seed, conditions, free)
    if seed.problem.kind == "orbit":
        seed = lazy.module("columns of orbits").with_columns(seed, asked)
    chosen = Settings.of(settings)
    senses = {"both": (-1, 1), "up": (1,), "down": (-1,)}
    if direction not in senses:
        raise InputError(f"direction must be 'up', 'down' or 'both'; got {direction!r}")
    if not seed.born:
        seed = replace(seed, arms=senses[direction])
    branch = trace(
        seed,
        bounds,
        name=name,
        settings=chosen,
        targets=[*targets_of(seed, values), *extrema_of(seed, extrema)],
        watch=watch,
        journal=journal,
    )
    totals = conserved_notes(getattr(getattr(seed.problem, "system", None), "model", None))
    words = [f"start: {start.words}"] if isinstance(start, FoundByItself) else []
    if columns and seed.problem.kind != "orbit":
        words.append(f"columns: {', '.join(columns)}: of periodic orbits, which this branch has none of")
    return replace(branch, notes=(*words, *totals, *branch.notes)) if totals or words else branch


def walk(
    start: Any,
    parameter: str | Sequence[str],
    range: Range | None = None,
    *,
    direction: str = "up",
    values: Mapping[str, Sequence[float]] | None = None,
    settings: Settings | Record | None = None,
) -> Iterator[Fields]:
    """The points of one arm as they are computed: mappings of columns, with `label` (a type such as 'LP', or None).

    As `continuation`, along curves in two parameters too. The start is not repeated. Computing goes chunk by chunk, a
    little ahead of what is taken; stop whenever you like.
    """
    if direction not in ("up", "down"):
        raise InputError(f"a walk goes one way: direction must be 'up' or 'down'; got {direction!r}")
    seed, bounds = placed(start, parameter, range)
    departure = depart(seed, bounds, Settings.of(settings))
    seed, problem = departure.seed, departure.seed.problem
    ready = departure.arm(1 if direction == "up" else -1, targets_of(seed, values))
    if isinstance(ready, End):
        return
    arm, segments = ready
    for segment in chain(segments, followed(arm, seed.z)):
        rows = Rows()
        rows.add_segment(segment)
        if not len(rows):
            continue
        (z, _, unstable, _), _ = rows.joined(0)
        columns = problem.columns(z)
        labels = {row: point.type for row, point, _ in rows.labelled}
        for k in np.arange(len(z)):
            point = {key: column[k].item() for key, column in columns.items()}
            yield {"label": labels.get(int(k)), **point, "unstable": int(unstable[k]), "stable": bool(unstable[k] == 0)}
