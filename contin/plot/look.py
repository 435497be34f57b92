"""What a user may say of a picture: the same options in Python, in run files and on the command line."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Final

from contin.errors import InputError
from contin.model.advice import closest

LEGENDS: Final = ("below", "inside", "none")


@dataclass(frozen=True)
class Look:
    """Options of a picture of branches.

    x, y : columns on the axes; several y make a panel each.
    labels : True, False, or the types whose labels are written, such as ['LP', 'HB'].
    limits : {column: (low, high)} of an axis.  log : columns with a logarithmic axis.
    size : width and height in inches.  legend : below, inside or none.  title : over everything.
    style : matplotlib's rcParams by name.
    """

    x: str | None = None
    y: str | Sequence[str] | None = None
    labels: bool | Sequence[str] = True
    limits: Mapping[str, Sequence[float]] = field(default_factory=dict)
    log: Sequence[str] = ()
    size: Sequence[float] | None = None
    legend: str | bool = "below"
    title: str | None = None
    style: Mapping[str, object] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if isinstance(self.log, str):
            object.__setattr__(self, "log", (self.log,))
        if isinstance(self.legend, bool):
            object.__setattr__(self, "legend", "below" if self.legend else "none")
        if self.legend not in LEGENDS:
            raise InputError(f"legend: expected {', '.join(LEGENDS)}, true or false; got {self.legend!r}")
        if self.size is not None and not (len(self.size) == 2 and all(0.5 <= v <= 60.0 for v in self.size)):
            raise InputError(f"size: expected [width, height] in inches between 0.5 and 60; got {list(self.size)!r}")
        for name, pair in self.limits.items():
            if not (isinstance(pair, Sequence) and len(pair) == 2 and float(pair[0]) < float(pair[1])):
                raise InputError(f"limits: {name}: expected [low, high] with low < high; got {pair!r}")

    @staticmethod
    def of(options: Mapping[str, object]) -> Look:
        """From a mapping that a user wrote; an unknown key is an InputError that names the known ones."""
        known = [one.name for one in fields(Look)]
        wrong = [key for key in options if key not in known]
        if wrong:
            advice = closest(wrong[0], known)
            advice = f": {advice}" if advice else ""
            raise InputError(f"a picture has no option {wrong[0]!r}{advice}; options: {', '.join(known)}")
        return Look(**options)  # type: ignore[arg-type]

    def writes(self, kind: str) -> bool:
        """Whether labels of special points of this type are written."""
        return self.labels if isinstance(self.labels, bool) else kind in self.labels

    def check_columns(self, known: Sequence[str]) -> None:
        """Raise InputError where `limits` or `log` name a column that no axis shows."""
        for key, names in (("limits", list(self.limits)), ("log", list(self.log))):
            for name in names:
                if name not in known:
                    raise InputError(f"{key}: no axis shows {name!r}; the axes show {', '.join(dict.fromkeys(known))}")


PLAIN_LOOK: Final = Look()
