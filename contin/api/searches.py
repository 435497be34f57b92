"""All equilibria in a box of states."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np

from contin.api.fixed_totals import for_branches
from contin.api.machine_code import compiled
from contin.api.requirements import need_parameters, refuse_forced
from contin.errors import InputError
from contin.model.kinds import need_model, need_states
from contin.model.model import Model
from contin.records import Record
from contin.search.equilibria_in_box import FoundEquilibrium, find, make_box
from contin.simulate.natural import natural_metric
from contin.systems.functions.function_problem import FunctionProblem

USUAL: Final = 0.5  # half of the box of a state about which nothing is known
RESOLVED: Final = 1e-3  # part of the box that a search tells from a point: it takes 1e-6 of it for the same


def find_equilibria(
    model: Any,
    box: Mapping[str, Sequence[float]] | Sequence[float] | None = None,
    parameters: Record | None = None,
    *,
    starts: int | None = None,
) -> list[FoundEquilibrium]:
    """Equilibria (fixed points of a map) in a box of states, by deflated Newton from many starts in compiled code.

    box : {state: (lo, hi)}, or (lo, hi) for all states; angles need no bounds. Default: twice as far in both directions
        as the model's states and starts reach, and each state's `scale`.
    starts : number of starting points a round; default so many that a search takes some tenths of a second.
    Solutions are told apart modulo angle periods; those that a declared symmetry makes of another one have `image_of`.
    There is no guarantee that all are found: more `starts` or a smaller box find more.
    """
    need_model(model)
    refuse_forced(model)
    need_states(model, "equilibria")
    if isinstance(model, FunctionProblem) and not model.state_names:
        raise InputError(
            f"{model.name!r} has {model.n} states without names, so that no box of them can be searched: "
            "contin.deflated finds several solutions of a large system, from known ones and along a parameter"
        )
    model = for_branches(model)
    need_parameters(model)
    system = compiled(model)
    _, p = model.start_point(None, dict(parameters or {}))
    periods = np.asarray(model.periods(dict(parameters or {})), dtype=float)
    wanted = box if box is not None else reach_of(model, parameters)
    return find(system, make_box(system.state_names, wanted, periods), p, starts)


def reach_of(model: Any, parameters: Record | None = None) -> dict[str, tuple[float, float]]:
    """Twice the largest size of each state in the model's default and named starts and its `scale`, both ways from 0.

    Of those that are 0 in all of them, the natural sizes, if these are far from the largest size of the others (from 1,
    where all are 0).

    Angles apart.
    """
    names = (None, *(s.name for s in model.starts))
    points = [model.start_point(name, dict(parameters or {}))[0] for name in names]
    largest = np.abs(np.array(points)).max(axis=0)
    if isinstance(model, Model):
        largest = np.maximum(largest, model.scales(dict(parameters or {})))
    usual = np.full(len(largest), max(float(largest.max(initial=0.0)), USUAL))
    if not largest.all():  # only the equations tell; sizes that a search of the usual box would see need no other
        flow = model.replace(events=()) if isinstance(model, Model) else model
        system, (u, p) = compiled(flow), model.start_point(None, dict(parameters or {}))
        natural = natural_metric(system, u, p)
        known = ~np.isin(model.state_names, natural.guessed)
        unseen = (natural.states < RESOLVED * usual) | (natural.states > usual / RESOLVED)
        usual = np.where(known & unseen, natural.states, usual)
    sizes = 2.0 * np.where(largest > 0.0, largest, usual)
    angles = np.asarray(model.periods()) > 0.0
    return {
        name: (-float(size), float(size))
        for name, size, angle in zip(model.state_names, sizes, angles, strict=True)
        if not angle
    }
