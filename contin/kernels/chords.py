"""Chord iterations: factors of an earlier iterate serve Newton's method while it converges fast with them.

The correctors of orbits and of boundary-value problems ask here after every iteration. `sizes` of a correction:
[length of the first, evaluations, moved since the last factorisation, factorisations].
"""

from contin.kernels.collocation_mesh import evened
from contin.kernels.compile import inlined
from contin.kernels.steering import STAGNATION, STALLED

ITERATIONS = 14
FACTORISATIONS = 6
SLOW = 0.15  # a chord iteration that contracts less than this is followed by a new factorisation
STALE = 2e-3  # factors are renewed before measuring when the point has moved further than this part of the orbit since
EXACT = 1e-9  # scaled distance within which factors give the tests of a probed point
MOVED = 0.05  # scaled distance beyond which the corrected point on a new mesh is not the same solution
PATIENCE = 2.0  # growth of the error after which an even mesh of a fixed number of intervals is looked at again

CONVERGED, FAILED, AGAIN, AFRESH = range(4)  # what follows an iteration; AFRESH: with new factors


@inlined("i, f, f, b, b, f, f1 -> i")
def follows(iteration, size, before, fresh, sound, tolerance, sizes):
    """What follows a correction of length `size`, `before` that of the one before, with new factors where `fresh`.

    sound : the point is one at which the equations mean something (a period is positive).

    Corrections that no longer fall are at the attainable accuracy only where they are Newton's: chord iterations stall
    in the direction in which the matrix is nearly singular (the times of two passes of one saddle, whose sum is the
    period), and leave an orbit 1000 times as far from the family as their length says. Those that fall like a geometric
    series, beside a singular point, go on.
    """
    sizes[2] += size
    if iteration == 0:
        sizes[0] = size
    if size <= tolerance and (fresh or size < 0.5 * before):
        return CONVERGED
    if not size < 1e3 or not sound:
        return FAILED
    ratio = size / before
    if iteration > 0:
        if ratio < 0.5 and size * ratio < 0.1 * tolerance:
            return CONVERGED
        if size < STAGNATION and size < sizes[0]:
            if fresh and ratio > STALLED:
                return CONVERGED
        elif (fresh and ratio > 0.8) or sizes[3] >= FACTORISATIONS:
            return FAILED
    return AFRESH if (iteration > 0 and ratio > SLOW) or (iteration == 0 and size > 0.1) else AGAIN


@inlined("f1, i, i, f, f1, f, f, f -> f")
def allowed(z, n, m, constant, density, error, limit, worthwhile):
    """The limit of the mesh's error from here on; 0 where the mesh is to be adapted now.

    worthwhile : of a fixed number of intervals: part of the error that a better mesh must leave at most; else 0.
    """
    if not error > limit:
        return limit
    if evened(z, n, m, constant, density) <= worthwhile * error or worthwhile == 0.0:
        return 0.0
    return PATIENCE * error


@inlined("f1, f2, i, f, f -> b")
def kept(z, rows, sign, moved, tolerance):
    """Row 0 becomes the corrected point z where it was not on its family to `tolerance`, as after a change of mesh.

    Else z is put back; True where the correction failed (sign 0 or 2) or led elsewhere.
    """
    stays = sign == 0 or sign == 2 or not moved < MOVED
    for j in range(z.size):
        if stays or moved <= tolerance:
            z[j] = rows[0, j]
        else:
            rows[0, j] = z[j]
    return stays


@inlined("i, f, f -> b")
def is_stale(sign, moved, extent):
    """True where a correction succeeded with factors that are not those of its point: it `moved` too far since.

    extent : of the solution, as a part of its size.
    """
    return sign != 0 and sign != 2 and moved > STALE * extent
