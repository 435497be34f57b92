"""A table of what was planted and what contin labelled: the count of each kind of error, one line a machine.

Outcomes of one system:

    found     an expected label, within its stated error of the planted place
    wrong     an expected label, farther from it than its stated error, or with a coefficient or word that is not so
    missed    an expected label that is not there, and no note says that something was not told
    noted     an expected label that is not there, and a note says so
    spurious  a label that was not planted
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

COLUMNS = ("systems", "expected", "found", "noted", "missed", "spurious", "wrong")
NEAR = 1e-2  # of the parameter's range: a label of the right type this near is the one that was planted


@dataclass(frozen=True)
class Expected:
    """A label that was planted: its type, the parameter's value, and what else must hold (a complaint, or '')."""

    type: str
    at: float
    further: Callable[[Any], str] = lambda point: ""


@dataclass(eq=False)
class Ledger:
    """Counts by machine, and every complaint in words with what reproduces it."""

    counts: dict[str, Counter[str]] = field(default_factory=dict)
    complaints: list[str] = field(default_factory=list)

    def judge(
        self, machine: str, system: str, branch: Any, expected: Sequence[Expected], name: str, width: float,
        slack: float = 0.0,
    ) -> None:  # fmt: skip
        """Compare the labels of a branch with those planted, by the value of the column `name` of a range `width`.

        slack : what the stated errors do not cover (of a second parameter, say), 0 where they should cover all.
        """
        counts = self.counts.setdefault(machine, Counter())
        counts["systems"] += 1
        counts["expected"] += len(expected)
        left = list(branch.points)
        for wanted in expected:
            places = [other.at for other in expected if other.type == wanted.type]
            same = [
                p for p in left
                if p.type == wanted.type and abs(p.values[name] - wanted.at) < NEAR * width
                and abs(p.values[name] - wanted.at) <= min(abs(p.values[name] - at) for at in places) + p.error
            ]  # fmt: skip
            if not same:
                kind = "noted" if branch.notes else "missed"
                self._complain(counts, kind, machine, system, f"{wanted.type} at {wanted.at:.12g}: {branch.notes}")
                continue
            point = min(same, key=lambda p: abs(p.values[name] - wanted.at))
            left.remove(point)
            off = abs(point.values[name] - wanted.at)
            complaint = wanted.further(point)
            if off > point.error + slack:
                complaint = f"off by {off:.1e}, stated error {point.error:.1e}" + (f"; {complaint}" * bool(complaint))
            if complaint:
                self._complain(counts, "wrong", machine, system, f"{point.label}: {complaint}")
            else:
                counts["found"] += 1
        for point in left:
            where = f"{point.label} at {point.values[name]:.12g}, residual {point.residual:.1e}"
            self._complain(counts, "spurious", machine, system, where)

    def failed(self, machine: str, system: str, error: BaseException) -> None:
        """A system that ended in an exception."""
        counts = self.counts.setdefault(machine, Counter())
        counts["systems"] += 1
        self._complain(counts, "missed", machine, system, f"{type(error).__name__}: {error}")

    def count(self, machine: str, system: str, kind: str, text: str) -> None:
        """A complaint about something other than a label on the branch that was judged."""
        self._complain(self.counts.setdefault(machine, Counter()), kind, machine, system, text)

    def _complain(self, counts: Counter[str], kind: str, machine: str, system: str, text: str) -> None:
        counts[kind] += 1
        self.complaints.append(f"{machine} {system}: {kind}: {text}")

    def total(self, kind: str) -> int:
        return sum(counts[kind] for counts in self.counts.values())

    def table(self) -> str:
        """In Markdown."""
        head = ["| machine | " + " | ".join(COLUMNS) + " |", "|---" * (len(COLUMNS) + 1) + "|"]
        rows = [f"| {name} | " + " | ".join(str(c[k]) for k in COLUMNS) + " |" for name, c in self.counts.items()]
        return "\n".join([*head, *rows])

    def write(self, path: Path, facts: Mapping[str, str]) -> None:
        """The table, what it was made with, and every complaint."""
        lines = [*(f"{key}: {value}" for key, value in facts.items()), "", self.table(), "", *_items(self.complaints)]
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")

    def assert_clean(self) -> None:
        """Nothing missed, spurious or wrong; what is noted is no error, but is not found either."""
        bad = [c for c in self.complaints if ": noted: " not in c]
        assert not bad, "\n".join([self.table(), *bad])


def _items(texts: Iterable[str]) -> list[str]:
    return [f"- {text}" for text in texts]
