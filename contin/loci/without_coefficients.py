"""The remark of points of codimension two whose normal form is not computed."""

from __future__ import annotations

from dataclasses import replace

from contin.continuation.outcome import Verified


def with_remark(point: Verified, where: str) -> Verified:
    """The point with the remark that it has no coefficients, where it has none and no other remark says why.

    where : what the curve is of, in words (plural).
    """
    if point.normal_form or point.remark:
        return point
    return replace(point, remark=f"{point.type}: the coefficients of its normal form are not computed for {where}")
