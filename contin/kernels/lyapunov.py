"""The first Lyapunov coefficient along a curve of Hopf points, from exact second and third derivatives."""

import math

import numpy as np

from contin.kernels.compile import allocating, call5, call6, kernel


@kernel("c2, c1 -> b")
def complex_solve(a, b):
    """Solve a x = b in place of b by elimination with partial pivoting (a is destroyed); False where a is singular."""
    n = a.shape[0]
    for k in range(n):
        best = k
        largest = abs(a[k, k])
        for i in range(k + 1, n):
            size = abs(a[i, k])
            if size > largest:
                largest = size
                best = i
        if not largest > 0.0:
            return False
        if best != k:
            for j in range(k, n):
                swap = a[k, j]
                a[k, j] = a[best, j]
                a[best, j] = swap
            held = b[k]
            b[k] = b[best]
            b[best] = held
        for i in range(k + 1, n):
            factor = a[i, k] / a[k, k]
            if factor != 0.0:
                for j in range(k + 1, n):
                    a[i, j] -= factor * a[k, j]
                b[i] -= factor * b[k]
    for i in range(n - 1, -1, -1):
        s = b[i]
        for j in range(i + 1, n):
            s -= a[i, j] * b[j]
        b[i] = s / a[i, i]
    return True


@kernel("i, f1, f1, f1, f1, f1, f1, f1, f1")
def second(form2, u, p, scale, x, y, wide_x, wide_y, out):
    """out = B(x, y) in scaled states."""
    n = x.size
    for i in range(n):
        wide_x[i] = scale[i] * x[i]
        wide_y[i] = scale[i] * y[i]
    call5(form2, u, p, wide_x, wide_y, out)
    for i in range(n):
        out[i] /= scale[i]


@kernel("f1, f1, f1, f1 -> f")
def dot(p_re, p_im, x_re, x_im):
    """Re <p, x> = Re conj(p) . x"""
    total = 0.0
    for i in range(p_re.size):
        total += p_re[i] * x_re[i] + p_im[i] * x_im[i]
    return total


@kernel("f1, f1 -> f")
def length(x_re, x_im):
    """Of a complex vector."""
    total = 0.0
    for i in range(x_re.size):
        total += x_re[i] * x_re[i] + x_im[i] * x_im[i]
    return math.sqrt(total)


@allocating("i, i, f1, f1, f1, f2, f, f1, f1, f1 -> b")
def lyapunov_terms(form2, form3, u, p, scale, matrix, omega, v, w, terms):
    """terms[0] = Re G21 and terms[1] > 0, a size to compare it with, in scaled states with |q| = 1.

    terms[1] = omega + |p| (|C(q,q,q*)| + |B(q*,h20)| + 2 |B(q,h11)|) does not vanish with G21, where that has one term
    only: the ratio is smooth along a curve, so that two of its zeros between two points show as a minimum.

    matrix : f_u in scaled states, eigenvector v - i w/omega to i omega.  form2, form3 : addresses of the second and
    third derivatives of f.  Kuznetsov, Elements, 3rd ed., (5.62):
    G21 = <p, C(q,q,q*) + B(q*,h20) + 2 B(q,h11)>, h20 = (2 i omega - A)^-1 B(q,q), h11 = -A^-1 B(q,q*).
    False where one of the systems is singular; both are 0 then.
    """
    terms[:] = 0.0
    n = v.size
    width = n + p.size
    a = np.empty(n)
    b = np.empty(n)
    norm = 0.0
    for i in range(n):
        a[i] = v[i]
        b[i] = -w[i] / omega
        norm += a[i] * a[i] + b[i] * b[i]
    norm = math.sqrt(norm)
    for i in range(n):
        a[i] /= norm
        b[i] /= norm
    bordered = np.zeros((n + 1, n + 1), np.complex128)
    left = np.zeros(n + 1, np.complex128)
    for i in range(n):
        q = complex(a[i], b[i])
        for j in range(n):
            bordered[i, j] = matrix[j, i]
        bordered[i, i] += complex(0.0, omega)
        bordered[i, n] = q
        bordered[n, i] = q.conjugate()
    left[n] = 1.0
    if not complex_solve(bordered, left):
        return False
    p_re = np.empty(n)
    p_im = np.empty(n)
    weight = 0.0
    for i in range(n):
        p_re[i] = left[i].real
        p_im[i] = left[i].imag
        weight += p_re[i] * p_re[i] + p_im[i] * p_im[i]
    weight = math.sqrt(weight)
    x = np.zeros(width)
    y = np.zeros(width)
    aa = np.empty(n)
    ab = np.empty(n)
    bb = np.empty(n)
    second(form2, u, p, scale, a, a, x, y, aa)
    second(form2, u, p, scale, a, b, x, y, ab)
    second(form2, u, p, scale, b, b, x, y, bb)
    system = np.empty((n, n), np.complex128)
    h20 = np.empty(n, np.complex128)
    for i in range(n):
        for j in range(n):
            system[i, j] = -matrix[i, j]
        system[i, i] += complex(0.0, 2.0 * omega)
        h20[i] = complex(aa[i] - bb[i], 2.0 * ab[i])
    if not complex_solve(system, h20):
        return False
    h11 = np.empty(n, np.complex128)
    for i in range(n):
        for j in range(n):
            system[i, j] = -matrix[i, j]
        h11[i] = aa[i] + bb[i]
    if not complex_solve(system, h11):
        return False
    h_re = np.empty(n)
    h_im = np.empty(n)
    for i in range(n):
        h_re[i] = h20[i].real
        h_im[i] = h20[i].imag
    t_re = np.empty(n)
    t_im = np.empty(n)
    second(form2, u, p, scale, a, h_re, x, y, t_re)
    second(form2, u, p, scale, b, h_im, x, y, aa)
    second(form2, u, p, scale, a, h_im, x, y, t_im)
    second(form2, u, p, scale, b, h_re, x, y, bb)
    for i in range(n):
        t_re[i] += aa[i]
        t_im[i] -= bb[i]
        h_re[i] = h11[i].real
    through_20 = dot(p_re, p_im, t_re, t_im)
    size = length(t_re, t_im)
    second(form2, u, p, scale, a, h_re, x, y, t_re)
    second(form2, u, p, scale, b, h_re, x, y, t_im)
    through_11 = 2.0 * dot(p_re, p_im, t_re, t_im)
    size += 2.0 * length(t_re, t_im)
    for i in range(n):
        x[i] = scale[i] * a[i]
        y[i] = scale[i] * b[i]
    call6(form3, u, p, x, x, x, t_re)
    call6(form3, u, p, x, y, y, aa)
    call6(form3, u, p, x, x, y, t_im)
    call6(form3, u, p, y, y, y, bb)
    for i in range(n):
        t_re[i] = (t_re[i] + aa[i]) / scale[i]
        t_im[i] = (t_im[i] + bb[i]) / scale[i]
    cubic = dot(p_re, p_im, t_re, t_im)
    terms[0] = cubic + through_20 + through_11
    terms[1] = omega + weight * (size + length(t_re, t_im))
    return True
