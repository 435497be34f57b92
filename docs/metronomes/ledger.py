"""The ledger of claims: data in ledger.yaml, numbers from the functions of the claims, one table on a page."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path

import claims_averages  # noqa: F401 - each registers its claims
import claims_figures  # noqa: F401
import claims_full  # noqa: F401
import claims_motion  # noqa: F401
import claims_one  # noqa: F401
import claims_pair  # noqa: F401
import claims_states  # noqa: F401
import claims_supplement  # noqa: F401
import claims_two  # noqa: F401
import numpy as np
from claiming import CLAIMS

from contin.model.shape import plain
from contin.model.yaml_reader import read_file

VERDICTS = ("confirmed", "differs", "slip")
TOLERANCE = 1e-7  # unless the entry says otherwise
RIGHT = 2e-6  # of what is right instead of what is printed, or of our own number to more digits
HERE = Path(__file__).resolve().parent


@cache
def entries() -> dict[str, dict]:
    """The claims by name: where, says, ours, command, verdict, tolerance."""
    return plain(read_file(HERE / "ledger.yaml").data)["claims"]


def agree(ours: object, printed: object, tolerance: float) -> bool:
    """True where all numbers agree to `tolerance` (relative, and absolute for zeros); words must be equal."""
    a, b = np.asarray(ours), np.asarray(printed)
    if a.dtype.kind not in "fciu" or b.dtype.kind not in "fciu":
        return bool(np.array_equal(a, b))
    return a.shape == b.shape and bool(np.allclose(a, b, rtol=tolerance, atol=1e-3 * tolerance))


def holds(name: str, printed: object = None, right: object = None) -> bool:
    """Whether the verdict follows from the numbers, or from others in place of the printed ones and the right ones.

    Confirmed: our numbers are the paper's to the entry's tolerance. Otherwise they are those of the correction only.
    """
    entry, ours, own = entries()[name], *result(name)
    said = own[0] if printed is None else printed
    correction = (own[1] if len(own) > 1 else None) if right is None else right
    agrees = agree(ours, said, float(entry.get("tolerance", TOLERANCE)))
    corrected = correction is not None and agree(ours, correction, RIGHT)
    if entry["verdict"] == "confirmed":
        return agrees and (correction is None or corrected)
    return corrected and not agrees


def altered(expected: object, tolerance: float) -> Iterator[np.ndarray]:
    """The expected numbers or words with each of them altered in turn."""
    flat = np.asarray(expected, dtype=object).ravel()
    for k, value in enumerate(flat):
        other = flat.copy()
        if isinstance(value, str):
            other[k] = f"not {value}"
        elif isinstance(value, bool | np.bool_):
            other[k] = not value
        else:
            other[k] = value + 10.0 * tolerance * (abs(value) or 1.0)
        yield np.array(other.tolist()).reshape(np.shape(np.asarray(expected, dtype=object)))


def assert_follows(name: str) -> None:
    """The verdict follows from the numbers, and from none of those with one of them altered."""
    entry, (ours, own) = entries()[name], result(name)
    assert holds(name), (name, ours, own)
    if entry["verdict"] == "confirmed":
        for other in altered(own[0], float(entry.get("tolerance", TOLERANCE))):
            assert not holds(name, printed=other), (name, other)
    for other in altered(own[1], RIGHT) if len(own) > 1 else ():
        assert not holds(name, right=other), (name, other)


@cache
def result(name: str) -> tuple[object, tuple[object, ...]]:
    """Our numbers, and the printed ones with what is right instead where they differ."""
    ours, *own = CLAIMS[name]()
    return ours, tuple(own)


def shown(numbers: object) -> str:
    """At most three numbers, in nine digits; of more, how many there are."""
    values = np.asarray(numbers)
    if values.dtype.kind == "b":
        words = ["yes" if value else "no" for value in values.ravel()]
        return ", ".join(words) if len(set(words)) > 1 or len(words) == 1 else f"{words[0]} ({len(words)})"
    if values.dtype.kind not in "fciu":
        return ", ".join(str(value) for value in values.ravel())
    flat = [f"{value:.9g}" for value in values.ravel()]
    return ", ".join(flat) if len(flat) <= 3 else f"{', '.join(flat[:2])}, ... ({len(flat)} numbers)"


def difference(ours: object, printed: object) -> str:
    """The largest difference of the numbers."""
    a, b = np.asarray(ours), np.asarray(printed)
    if a.dtype.kind not in "fciu" or b.dtype.kind not in "fciu" or a.shape != b.shape:
        return ""
    return f"{np.abs(a - b).max():.2g}"


class Table:
    """The ledger as a notebook shows it: counts of the verdicts and a table whose numbers are computed now.

    No table is made where a verdict does not follow from them.
    """

    def __init__(self) -> None:
        for name in entries():
            assert_follows(name)

    def _repr_markdown_(self) -> str:
        lines = [
            ", ".join(f"{count} {verdict}" for verdict, count in counts().items()) + ".",
            "",
            "| claim | ours | by the paper | difference | verdict |",
            "|---|---|---|---|---|",
        ]
        for name, entry in entries().items():
            ours, (printed, *_) = result(name)
            note = f" {entry['ours']}" if entry.get("ours") else ""
            claim = f"{entry['where']}: {entry['says']} <br> `{entry['command']}`"
            numbers = f"{shown(ours)}.{note} | {shown(printed)} | {difference(ours, printed)}"
            lines.append(f"| {claim} | {numbers} | **{entry['verdict']}** |")
        return "\n".join(lines)


def counts() -> dict[str, int]:
    """How many claims have each verdict."""
    verdicts = [entry["verdict"] for entry in entries().values()]
    return {verdict: verdicts.count(verdict) for verdict in VERDICTS}
