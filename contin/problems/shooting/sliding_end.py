"""The end of a family of orbits that come to a surface along which solutions slide (a grazing-sliding bifurcation).

Beyond it orbits stick to the surface for a while, as those of dry friction do; these are not integrated.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from contin.continuation.branch import End
from contin.continuation.sample import Sample
from contin.problems.shooting.sampling import sliding

if TYPE_CHECKING:
    from contin.problems.shooting.shot_equations import ShotEquations


def comes_to_slide(problem: ShotEquations, origin: Sample) -> End | None:
    """The end in words where the corrector has failed after an orbit that slides, or next to which others do."""
    if not problem.system.n_switches:
        return None
    text = sliding(problem, origin.z)
    if text is None:
        return None
    name, value = problem.parameters[0], float(origin.z[-1])
    words = f"at {name} = {value:.10g} the orbits come to a surface along which solutions slide. {text}"
    return End("surface", words, {"at": {name: value}})
