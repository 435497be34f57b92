"""Places of special orbits whose trajectories part beside a saddle focus: their equations are nearly singular."""

import mpmath
import numpy as np
import pytest
from scipy.linalg import expm

import contin

BE, M0, M1 = 14.286, -0.142857, 0.285714  # Chua's circuit: slopes of its resistor inside and outside |x| = 1
FOLD, PERIOD = 10.9144, 4.6294328697842  # of the family from the Hopf point; al is stationary in the period there
CIRCUIT = {
    "name": "chua", "states": {"x": 0, "y": 0, "z": 0}, "parameters": {"al": 9.0},
    "equations": {
        "x": f"al*(y - ({M1}*x + ({M0} - {M1})*(abs(x + 1) - abs(x - 1))/2))", "y": "x - y + z", "z": f"-{BE}*y",
    },
}  # fmt: skip


def affine(al, outer):
    """The rates of (x, y, z, 1) where x > 1 (outer = 1) and in |x| < 1 (0)."""
    m = M1 if outer else M0
    return [[-al * m, al, 0, -al * (M0 - M1) * outer], [1, -1, 1, 0], [0, -BE, 0, 0], [0, 0, 0, 0]]


def orbit(period: float) -> tuple[float, ...]:
    """(y, z) where the orbit of a period enters |x| < 1, its time there, and al, in 25 digits."""
    with mpmath.workdps(25):

        def missed(y, z, inside, al):
            between = mpmath.expm(mpmath.matrix(affine(al, 0)) * inside) * mpmath.matrix([1, y, z, 1])
            back = mpmath.expm(mpmath.matrix(affine(al, 1)) * (mpmath.mpf(period) - inside)) * between
            return between[0] - 1, back[0] - 1, back[1] - y, back[2] - z

        found = mpmath.findroot(missed, (-0.29750731, -1.44539041, 3.21853366, FOLD + 1.7e-5), tol=1e-40)
        return tuple(float(v) for v in found)


@pytest.mark.seldom
def test_a_fold_holds_to_its_error_where_its_equations_are_nearly_singular():
    period = PERIOD - 0.02
    y, z, inside, al = orbit(period)
    times = np.linspace(0.0, period, 401)
    start, rows = np.array([1.0, y, z, 1.0]), []
    for t in times:
        first = expm(np.array(affine(al, 0)) * min(t, inside)) @ start
        rows.append(expm(np.array(affine(al, 1)) * max(t - inside, 0.0)) @ first)
    seed = contin.periodic_orbit(contin.load(CIRCUIT), np.array(rows)[:, :3], {"al": al}, times=times)
    branch = contin.continuation(seed, "al", (al - 1e-3, al + 1e-3))
    (fold,) = [point for point in branch.points if point.type == "LPC"]
    assert abs(fold.values["al"] - orbit(PERIOD)[3]) <= fold.error < 1e-11
