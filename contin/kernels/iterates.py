"""Iterates of maps with their derivatives by the chain rule, in one call."""

from contin.kernels.compile import call4, kernel


@kernel("i, f2, f1, f1, f2, f2, f2")
def iterate_along(address, points, p, f, matrix, slope, fresh):
    """points (k + 1, n): from the first one the k iterates; slope (n, n + m): their last one's by (u, p).

    f (n,), matrix and fresh (n, n + m): memory.
    """
    n, width = slope.shape
    for i in range(n):
        for j in range(width):
            slope[i, j] = 1.0 if i == j else 0.0
    for k in range(points.shape[0] - 1):
        call4(address, points[k], p, f, matrix)
        for i in range(n):
            points[k + 1, i] = f[i]
            for j in range(width):
                total = matrix[i, j] if j >= n else 0.0
                for inner in range(n):
                    total += matrix[i, inner] * slope[inner, j]
                fresh[i, j] = total
        for i in range(n):
            for j in range(width):
                slope[i, j] = fresh[i, j]
