"""Whether the limit of a family with growing period is believed, and to what error."""

from __future__ import annotations

from contin.machine import elementary
from contin.problems.orbits.ends.extrapolated import Limit

REACHED = 2e-9  # distance of the parameter from its limit, relative to its range, at which the approach is complete
AGREED = 1e-9  # ... or at which two extrapolations agree to this
AGREED_SPIRAL = 1e-7  # ... with complex leading eigenvalues, where infinitely many folds accumulate
DOUBTFUL = 1e-4  # ... above which the extrapolation is not tried
SWINGING, SAFETY = 6.0, 3.0  # factors of the errors that two orbits tell
NOISE = 1e-7  # ... below which it is accepted where two extrapolations differ by more than what remains
SETTLED = 1e-3  # part of an orbit's extent that it would still gain (beside a continuum of orbits nothing else tells)
NEARLY_SETTLED = 0.02  # ... where the corrector can go no further
PATIENCE = 3000  # rows that would still be followed until the limit is as near as `REACHED`, beyond which ...
TOLD = 0.1  # ... it is enough that two orbits agree on the limit to this part of what remains


def error_of_limit(
    limit: Limit, moved: float, gained: float, growth: float, width: float, failed: bool, first: bool
) -> float | None:  # fmt: skip
    """The error of a limit; None where it is not believed.

    moved, gained : by how much the parameter and the period changed between the two orbits.  growth : of the extrema,
    by the period.  first : of the slowest rates.

    Bursts whose parts move along the period are followed in steps of a part of a spike: the approach may take tens of
    thousands of rows. Where that many are foreseen, an agreement to a part of what remains is enough, and is its error.
    """
    remaining = abs(limit.step)
    if remaining > DOUBTFUL * width or growth / limit.rate > (NEARLY_SETTLED if failed else SETTLED):
        return None
    error = limit.drift * max(1.0, remaining / abs(moved)) if moved != 0.0 else limit.drift
    settled = abs(moved) > 1e-3 * remaining
    if limit.spiral:
        settled &= error < AGREED_SPIRAL * width and limit.doubt < AGREED_SPIRAL * width
        error = max(SWINGING * error, 2.0 * limit.doubt)
    else:
        error = max(error, limit.doubt)
        settled &= error < AGREED * width
        error *= SAFETY
    near = remaining < REACHED * width or (limit.drift > remaining and remaining < NOISE * width)
    if failed and remaining < NOISE * width:
        near, error = True, max(error, SAFETY * remaining)
    told = (SWINGING if limit.spiral else SAFETY) * TOLD
    if not settled and not near and remaining > 0.0 and error < told * remaining:
        ahead = float(elementary.log(remaining / (REACHED * width))) / (limit.rate * gained)
        settled = ahead > PATIENCE
    return error if settled or (near and first) else None
