"""What is kept of the rows of a branch besides its columns: spectra of all, orbits of some, equally spaced."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.errors import ContinError
from contin.records import Fields

if TYPE_CHECKING:
    from contin.continuation.branch import Branch
    from contin.continuation.orbit import Orbit

MOST_ORBITS: Final = 16  # of a branch, besides those at its labels
MOST_STATES: Final = 60  # with more, a file keeps orbits at labels alone


def spaced_orbits(branch: Branch, labelled: bool = True) -> dict[int, Orbit]:
    """Orbits of a family by row: at its labels, where wanted, and equally spaced; of one from a file those it keeps."""
    if branch.kind != "orbit":
        return {}
    at_labels = {int(point.index) for point in branch.points}
    spaced = np.linspace(0, len(branch) - 1, min(MOST_ORBITS, len(branch))).round().astype(int)
    rows = set(spaced.tolist()) if branch.problem is not None else set(branch.kept)
    found = {}
    for row in sorted(rows | at_labels if labelled else rows - at_labels):
        try:
            found[row] = branch.orbit(row)
        except ContinError:  # fields, or an orbit without a profile: what shows it says at which row it shows one
            continue
    return found


def kept_rows(branch: Branch) -> Fields:
    """For files: `start` (the row it began at), `eigenvalues` (rows, k) of all rows, and `orbits` between labels."""
    found: Fields = {"start": int(branch.start_row)}
    values = np.asarray(branch.eigenvalues)
    if values.ndim == 2 and values.size:
        found["eigenvalues"] = values
    if branch.kind == "orbit":
        states = getattr(getattr(branch.problem, "system", None), "n", 0)
        small = spaced_orbits(branch, labelled=False) if states <= MOST_STATES else {}
        found["orbits"] = [{"row": row, "orbit": dict(orbit.columns)} for row, orbit in small.items()]
    return found
