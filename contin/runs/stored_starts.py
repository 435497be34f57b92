"""`from: results.contin:line.HB1` of a run: a labelled point of results that an earlier run, or a session, saved."""

from __future__ import annotations

import hashlib
import re
import warnings
from dataclasses import dataclass, replace
from pathlib import Path as FilePath
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Any, Final

from contin.api.reading import read
from contin.continuation.as_computed import as_computed
from contin.continuation.branch import Branch, SpecialPoint
from contin.errors import ContinError, InputError
from contin.homoclinic.ends_of_connection import EndsOfConnection
from contin.loci.augmented.tangencies import CurveOfTangencies
from contin.model.advice import closest
from contin.model.model import Model
from contin.model.source import Path, Problems
from contin.runs.outputs import path_mistake
from contin.store.digest import DamageWarning
from contin.symbolic.passes.lifted import is_lift

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

SAME: Final = 1e-12  # relative: two values of a parameter that are one


@dataclass(frozen=True)
class StoredStart:
    """A label of a stored result; `sha256` of the file as it was when the run was planned."""

    file: FilePath
    written: str  # the file as the run file names it
    branch: str
    label: str
    sha256: str

    def read(self) -> Branch:
        """Its branch with the point as it was computed; InputError where the file has no such point any more."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DamageWarning)  # the point itself is checked
            branch = _branch(self)
        point = replace(as_computed(_point(branch, self)), branch=f"{self.written}:{self.branch}")
        points = tuple(point if p.label == self.label else p for p in branch.points)
        return replace(branch, points=points)


def stored_start(
    text: str, run_file: FilePath, model: Model, values: Mapping[str, float], given: Mapping[str, object],
    varying: tuple[str, ...], problems: Problems, place: Path,
) -> StoredStart | None:  # fmt: skip
    """What `from: FILE.contin:BRANCH.LABEL` names; None, with a note at `place`, where it names nothing to start from.

    values : of all parameters of this run; those `given` in the run file or the command must be those of the point.
    """
    found = re.fullmatch(r"(.+\.contin):(.+)\.([A-Z][A-Z0-9]*[0-9]+)", text)
    if found is None:
        problems.add(place, f"expected FILE.contin:NAME.LABEL, such as results.contin:line.HB1, got {text!r}")
        return None
    written, branch, label = found.groups()
    folder = run_file.parent.resolve()
    file = folder / PurePosixPath(written)
    mistake = path_mistake(written, (".contin",), folder, run_file)
    if mistake is None and not file.is_file():
        mistake = f"there is no file {written!r} in this file's folder; run what saves it first"
    if mistake is not None:
        problems.add(place, mistake)
        return None
    start = StoredStart(file, written, branch, label, hashlib.sha256(file.read_bytes()).hexdigest())
    try:
        point = _point(start.read(), start)
        mistake = another_model(model, point) or _other_values(point, values, given, varying)
    except ContinError as error:
        mistake = str(error)
    if mistake is not None:
        problems.add(place, mistake)
        return None
    return start


def _branch(start: StoredStart) -> Branch:
    results: Iterable[Branch] = read(start.file)
    for branch in results:
        if branch.name == start.branch:
            return branch
    names = [branch.name for branch in results]
    advice = closest(start.branch, names) or f"there are {', '.join(names) or 'none'}"
    raise InputError(f"{start.written} has no branch {start.branch!r}: {advice}")


def _point(branch: Branch, start: StoredStart) -> SpecialPoint:
    for point in branch.points:
        if point.label == start.label:
            return point
    labels = ", ".join(point.label for point in branch.points) or "none"
    raise InputError(f"{start.branch} in {start.written} has no point {start.label} (points: {labels})")


def another_model(model: Model, point: SpecialPoint) -> str | None:
    """What tells the model of a run from that of a stored point, in words; None where they are one.

    Values and ranges of parameters may differ. A model that was reduced or turned before it was followed has other
    equations than the file's; of it names are compared.
    """
    stored = _model_of(point.problem)
    unknown = sorted(set(stored.parameter_names) - set(model.parameter_names))
    if (model.rotation or stored.totals) if isinstance(stored, Model) else True:
        return None if stored.name == model.name else f"it was computed from the model {stored.name!r}"
    if unknown or tuple(stored.state_names) != tuple(model.state_names) or stored.kind != model.kind:
        return f"it was computed from another model, {stored.name!r} in {', '.join(stored.state_names[:8])}"
    same = stored.equations == model.equations or is_lift(stored, model)
    if not same or _time(stored) != _time(model):
        return f"it was computed from other equations than those of {model.name}; name the model that it came from"
    return None


def _model_of(problem: Any) -> Any:
    """Of an orbit that connects cycles the flow's, not that of its boundary-value problem."""
    if isinstance(problem, CurveOfTangencies):
        return problem.base.model
    return problem.model if isinstance(problem, EndsOfConnection) else problem.system.model


def _time(model: Model) -> object:
    return model.forcing, model.conditions, model.interval, dict(model.mass)


def _other_values(
    point: SpecialPoint, values: Mapping[str, float], given: Mapping[str, object], varying: tuple[str, ...]
) -> str | None:
    """Parameters that are given another value than the point has."""
    for name in given:
        here, there = values.get(name), point.values.get(name)
        if here is None or there is None or name in varying or name in point.problem.parameters:
            continue
        if abs(here - there) > SAME * max(abs(here), abs(there)):
            return f"the point has {name} = {there:.10g}, and this run sets {name} = {here:.10g}: leave that out"
    return None
