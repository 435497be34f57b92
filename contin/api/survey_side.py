"""One arm of a survey: from an attractor, one parameter one way, until something happens."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from contin.api.branches import continuation
from contin.continuation.settings import Settings
from contin.errors import ContinError
from contin.special.table import table

STEPS: Final = 400  # of an arm
ORBIT_STEPS: Final = 120
BORN: Final = {  # reasons for which families of orbits end, and the bifurcation that it is
    "hopf": ("HB", "born here"), "homoclinic": ("HOM", ""), "heteroclinic": ("HOM", "heteroclinic")
}  # fmt: skip
GONE: Final = ("corrector", "steps", "stopped")


@dataclass(frozen=True)
class Side:
    """How far an arm came: `at` is the parameter's value there.

    type : of the bifurcation it came to, or an empty text.  detail : its criticality or kind.  reason : of the end.
    """

    at: float
    type: str = ""
    detail: str = ""
    reason: str = "bound"
    text: str = ""

    @property
    def complete(self) -> bool:
        """False where it could not be followed further, for no reason that the system gives."""
        return self.reason not in GONE and self.reason != "failed"


def bifurcations() -> tuple[str, ...]:
    """Types that a branch of states meets in one parameter."""
    return tuple(row.code for row in table().values() if row.codimension == 1 and row.code not in ("UZ", "EX"))


def follow(solution: Any, parameter: str, value: float, far: float) -> Side:
    """From a solution at `value` towards `far`, to the first bifurcation."""
    if far == value:
        return Side(value)
    orbit = hasattr(solution, "period")
    settings = Settings(steps=ORBIT_STEPS if orbit else STEPS, stop_at=bifurcations())
    try:
        branch = continuation(
            solution, parameter, (min(value, far), max(value, far)), direction="up" if far > value else "down",
            settings=settings,
        )  # fmt: skip
    except (ContinError, ArithmeticError, np.linalg.LinAlgError) as error:
        return Side(value, reason="failed", text=str(error).split(". ")[0])
    column = np.asarray(branch.columns[parameter], dtype=float)
    outer = branch.ends[1] if far > value else branch.ends[0]
    met = [p for p in branch.points if p.type in settings.stop_at]
    if met:
        first = min(met, key=lambda p: abs(int(p.index) - branch.start_row))
        form = first.normal_form
        detail = next((str(form[key]) for key in ("criticality", "kind", "case") if form.get(key)), "")
        return Side(float(first.values[parameter]), first.type, detail, "bifurcation", outer.text)
    reached = float(column[-1] if far > value else column[0]) if len(column) else value
    if outer.reason in BORN:
        at = outer.data.get("at")
        place = float(at.get(parameter, reached)) if isinstance(at, dict) else reached
        return Side(place, *BORN[outer.reason], outer.reason, outer.text)
    return Side(reached, "", "", outer.reason, outer.text)
