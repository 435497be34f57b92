"""Names that a `FunctionProblem` gives to its parts: they become columns, labels of branches and words of reports."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from contin.errors import InputError
from contin.limits import brief

TAKEN: Final = frozenset({"t", "period", "stable", "unstable", "parameters"})  # columns and keys of results


def check_name(what: str, name: object, *, column: bool = True) -> str:
    """`name`, one printable text that is no key of the results; of columns without a dot too (`x.max` is theirs)."""
    if not isinstance(name, str) or not name.strip() or not name.isprintable():
        raise InputError(f"{what}: a name must be a text without control characters; got {brief(name)}")
    if column and name in TAKEN:
        raise InputError(f"{what}: {name!r} is taken (a column or key of the results); choose another name")
    if column and any(c in name for c in "./~ "):
        raise InputError(f"{what}: names may not contain dots, spaces, '/' and '~'; got {name!r}")
    return name


def check_names(**groups: Iterable[object]) -> None:
    """Names of columns, each group under its keyword: all different, within a group and between them."""
    seen: dict[str, str] = {}
    for what, names in groups.items():
        for name in names:
            text = check_name(what, name)
            if text in seen:
                where = "twice" if seen[text] == what else f"among {seen[text]} too"
                raise InputError(f"{what}: {text!r} is there {where}; every name must be another")
            seen[text] = what
