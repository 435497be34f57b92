"""Eigenvalues of a small real matrix: balancing, Hessenberg form, Francis' double-shift QR.

As balanc, elmhes and hqr of EISPACK.
"""

import math

from contin.kernels.compile import kernel

RADIX = 2.0
EPSILON = 2.220446049250313e-16
SQUARED = 1e-145  # squares of what is below are lost, so that shifts of graded blocks do not converge


@kernel("f2")
def balance(a):
    """Diagonal similarity by powers of two that makes row and column norms comparable (in place.

    Eigenvalues unchanged).
    """
    n = a.shape[0]
    for _ in range(20):
        done = True
        for i in range(n):
            c = 0.0
            r = 0.0
            for j in range(n):
                if j != i:
                    c += abs(a[j, i])
                    r += abs(a[i, j])
            if c == 0.0 or r == 0.0 or not math.isfinite(c + r):
                continue
            g = r / RADIX
            f = 1.0
            s = c + r
            while c < g:
                f *= RADIX
                c *= RADIX * RADIX
            g = r * RADIX
            while c >= g:
                f /= RADIX
                c /= RADIX * RADIX
            if (c + r) / f < 0.95 * s:
                done = False
                g = 1.0 / f
                for j in range(n):
                    a[i, j] *= g
                for j in range(n):
                    a[j, i] *= f
        if done:
            return


@kernel("f2")
def hessenberg(a):
    """Reduce to upper Hessenberg form by stabilised elementary similarities (in place; below it zeros)."""
    n = a.shape[0]
    for m in range(1, n - 1):
        x = 0.0
        i = m
        for j in range(m, n):
            if abs(a[j, m - 1]) > abs(x):
                x = a[j, m - 1]
                i = j
        if i != m:
            for j in range(m - 1, n):
                swap = a[i, j]
                a[i, j] = a[m, j]
                a[m, j] = swap
            for j in range(n):
                swap = a[j, i]
                a[j, i] = a[j, m]
                a[j, m] = swap
        if x != 0.0:
            for i2 in range(m + 1, n):
                y = a[i2, m - 1]
                if y != 0.0:
                    y /= x
                    for j in range(m, n):
                        a[i2, j] -= y * a[m, j]
                    for j in range(n):
                        a[j, m] += y * a[j, i2]
            for i2 in range(m + 1, n):
                a[i2, m - 1] = 0.0


@kernel("f, f, f, f, f1, f1, i")
def pair_of_block(a, b, c, d, re, im, k):
    """Eigenvalues of [[a, b], [c, d]] into re, im at k and k + 1, without cancellation in the real case."""
    p = 0.5 * (a - d)
    q = p * p + b * c
    if q >= 0.0:
        z = math.sqrt(q)
        z = p + z if p >= 0.0 else p - z
        re[k + 1] = d + z
        re[k] = d - b * c / z if z != 0.0 else d
        im[k] = 0.0
        im[k + 1] = 0.0
    else:
        re[k] = d + p
        re[k + 1] = d + p
        im[k] = math.sqrt(-q)
        im[k + 1] = -im[k]


@kernel("f2, f1, f1, f1, f1 -> i")
def hessenberg_qr(h, re, im, near_re, near_im):
    """Eigenvalues of the upper Hessenberg matrix `h` (destroyed); returns 0, or 1 where the iteration did not converge.

    near_re, near_im : eigenvalues of a nearby matrix, as this function returned them, or NaN. They are the first
    shifts: along a branch, where matrices change little from point to point, that saves more than half of the
    iterations.
    """
    n = h.shape[0]
    norm = 0.0
    for i in range(n):
        for j in range(max(i - 1, 0), n):
            norm += abs(h[i, j])
    if not math.isfinite(norm):
        re[:] = math.nan
        im[:] = math.nan
        return 1
    end = n - 1
    shift = 0.0
    while end >= 0:
        iteration = 0
        while True:
            low = end
            while low > 0:
                s = abs(h[low - 1, low - 1]) + abs(h[low, low])
                if s == 0.0:
                    s = norm
                below = abs(h[low, low - 1])
                if below <= EPSILON * s or below <= min(SQUARED, EPSILON * norm):
                    h[low, low - 1] = 0.0
                    break
                low -= 1
            x = h[end, end]
            if low == end:
                re[end] = x + shift
                im[end] = 0.0
                end -= 1
                break
            y = h[end - 1, end - 1]
            w = h[end, end - 1] * h[end - 1, end]
            if low == end - 1:
                pair_of_block(y + shift, h[end - 1, end], h[end, end - 1], x + shift, re, im, end - 1)
                end -= 2
                break
            if iteration == 60:
                re[: end + 1] = math.nan
                im[: end + 1] = math.nan
                return 1
            if iteration == 0 and math.isfinite(near_re[end] + near_re[end - 1]):
                x = near_re[end] - shift
                y = near_re[end - 1] - shift
                w = 0.0
                if near_im[end] != 0.0 and near_im[end - 1] == -near_im[end]:
                    w = -near_im[end] * near_im[end]
                elif near_im[end] != 0.0 or near_im[end - 1] != 0.0:  # halves of two pairs: no real shift pair
                    y = x
            elif iteration == 10 or iteration == 20 or iteration == 40:  # exceptional shift against rare cycles
                shift += x
                for i in range(end + 1):
                    h[i, i] -= x
                s = abs(h[end, end - 1]) + abs(h[end - 1, end - 2])
                x = 0.75 * s
                y = x
                w = -0.4375 * s * s
            iteration += 1
            m = end - 2
            p = 0.0
            q = 0.0
            r = 0.0
            while m >= low:
                z = h[m, m]
                rr = x - z
                ss = y - z
                p = (rr * ss - w) / h[m + 1, m] + h[m, m + 1]
                q = h[m + 1, m + 1] - z - rr - ss
                r = h[m + 2, m + 1]
                s = abs(p) + abs(q) + abs(r)
                p /= s
                q /= s
                r /= s
                if m == low:
                    break
                u = abs(h[m, m - 1]) * (abs(q) + abs(r))
                v = abs(p) * (abs(h[m - 1, m - 1]) + abs(z) + abs(h[m + 1, m + 1]))
                if u <= EPSILON * v:
                    break
                m -= 1
            for i in range(m + 2, end + 1):
                h[i, i - 2] = 0.0
                if i > m + 2:
                    h[i, i - 3] = 0.0
            for k in range(m, end):
                last = k == end - 1
                x2 = 0.0
                if k != m:
                    p = h[k, k - 1]
                    q = h[k + 1, k - 1]
                    r = 0.0 if last else h[k + 2, k - 1]
                    x2 = abs(p) + abs(q) + abs(r)
                    if x2 == 0.0:
                        continue
                    p /= x2
                    q /= x2
                    r /= x2
                s = math.sqrt(p * p + q * q + r * r)
                if p < 0.0:
                    s = -s
                if s == 0.0:
                    continue
                if k != m:
                    h[k, k - 1] = -s * x2
                elif low != m:
                    h[k, k - 1] = -h[k, k - 1]
                p += s
                xx = p / s
                yy = q / s
                zz = r / s
                q /= p
                r /= p
                for j in range(k, end + 1):
                    p = h[k, j] + q * h[k + 1, j]
                    if not last:
                        p += r * h[k + 2, j]
                        h[k + 2, j] -= p * zz
                    h[k + 1, j] -= p * yy
                    h[k, j] -= p * xx
                top = min(end, k + 3)
                for i in range(low, top + 1):
                    p = xx * h[i, k] + yy * h[i, k + 1]
                    if not last:
                        p += zz * h[i, k + 2]
                        h[i, k + 2] -= p * r
                    h[i, k + 1] -= p * q
                    h[i, k] -= p
    return 0


@kernel("f2, f1, f1, f1, f1 -> i")
def eigenvalues(a, re, im, near_re, near_im):
    """Eigenvalues of the real matrix `a` (n, n), which is destroyed, into re and im; returns 0 where all converged.

    near_re, near_im : eigenvalues of a nearby matrix from an earlier call (they may be re and im themselves), or NaN.
    Conjugate pairs are neighbours, the one with the positive imaginary part first. Cost about 10 n^3.
    """
    n = a.shape[0]
    if n == 1:
        re[0] = a[0, 0]
        im[0] = 0.0
        return 0
    if n == 2:
        pair_of_block(a[0, 0], a[0, 1], a[1, 0], a[1, 1], re, im, 0)
        return 0
    balance(a)
    hessenberg(a)
    return hessenberg_qr(a, re, im, near_re, near_im)
