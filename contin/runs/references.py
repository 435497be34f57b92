"""`from: BRANCH.LABEL` of a run: whether the file can make a branch of that name before the run begins."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from contin.model.advice import closest
from contin.model.source import Path, Problems
from contin.runs.schema import RunEntry

if TYPE_CHECKING:
    from contin.model.model import Model

LABEL: Final = re.compile(r"[A-Z][A-Z0-9]*[0-9]+")


def is_stored(reference: str) -> bool:
    """True for FILE.contin:BRANCH.LABEL (`contin.runs.stored_starts`)."""
    return ".contin:" in reference


def check_references(entry: RunEntry, model: Model, problems: Problems) -> None:
    """Note each `from:` that names a run which the file does not define, or defines later.

    Whether a branch has the label is known only when it is computed: a run from one that is not found is skipped then.
    """
    names = [run.name or f"run{k + 1}" for k, run in enumerate(entry.continuations)]
    for position, run in enumerate(entry.continuations):
        if run.from_ is not None and not is_stored(run.from_):
            path: Path = ("continuations", position, "from")
            _check(run.from_, names, position, entry, model, problems, path)
        for key in ("of", "start", "to"):
            end = getattr(run, key)
            if isinstance(end, str) and "." in end and (key == "of" or run.as_ == "connection"):
                _check(end, names, position, entry, model, problems, ("continuations", position, key))


def _check(
    reference: str, names: Sequence[str], position: int, entry: RunEntry, model: Model, problems: Problems, path: Path
) -> None:
    branch, _, label = reference.rpartition(".")
    if not LABEL.fullmatch(label):
        problems.add(path, f"expected NAME.LABEL with a label such as BP1 or HB2, got {reference!r}")
        return
    run = _run_of(branch, names, model)
    if run in names[:position]:
        return
    if run in names[position:]:
        where = "it is this run itself" if run == names[position] else "that run comes later; put it before this one"
        problems.add(path, f"{reference!r} cannot be where this run starts: {where}")
        return
    if entry.phase is not None or (entry.diagram is not None and _of_diagram(branch, entry)):
        return
    known = [*names[:position], *(_roots(entry) if entry.diagram is not None else [])]
    advice = closest(branch, known) or (f"before it are {', '.join(known)}" if known else "no run comes before it")
    problems.add(path, f"there is no run {branch!r}: {advice}")


def _run_of(branch: str, names: Sequence[str], model: Model) -> str:
    """The run that makes a branch of this name: NAME, its images NAME~SYMMETRY, further branches NAME.2."""
    name, tilde, symmetry = branch.partition("~")
    if tilde and all(s.name != symmetry for s in model.symmetries):
        return branch
    plain = re.sub(r"\.[0-9]+$", "", name)
    return name if name in names else plain


def _of_diagram(branch: str, entry: RunEntry) -> bool:
    """True for START, START/LABEL, ...: branches that the explorer may find."""
    roots = _roots(entry)
    root = branch.split("/")[0].split("~")[0]
    return "all" in roots or re.sub(r"\.[0-9]+$", "", root) in roots


def _roots(entry: RunEntry) -> list[str]:
    """Names of the explorer's first branches (`contin.api.diagrams`)."""
    assert entry.diagram is not None
    starts: Sequence[object] = entry.diagram.start or [None]
    alone = len(starts) == 1
    return [s if isinstance(s, str) else "start" if alone else f"start{k + 1}" for k, s in enumerate(starts)]
