"""Fast and slow states apart: a matrix with rates many orders of magnitude apart, brought into graded order.

The QR algorithm is backward stable with respect to the norm of the matrix, that is the fastest rate: a slow eigenvalue
beside a rate of 1e12 would have an error of 1e-4. For a balanced matrix whose large entries come first, its small
eigenvalues are found from the small entries alone (Parlett, The Symmetric Eigenvalue Problem, 1998, sec. 8.13; in
practice for nonsymmetric matrices too), with errors in proportion to the slow rates.
"""

import math

from contin.kernels.compile import kernel
from contin.kernels.eigen import balance

GRADED = 100.0  # ratio of the rows' sizes from which a matrix is brought into order


@kernel("f2, i -> f")
def row_size(a, i):
    """Largest entry of a row, by modulus."""
    size = 0.0
    for j in range(a.shape[0]):
        size = max(size, abs(a[i, j]))
    return size


@kernel("f2 -> b")
def is_graded(a):
    """True where the rows of `a` differ in size by more than GRADED."""
    smallest = math.inf
    largest = 0.0
    for i in range(a.shape[0]):
        size = row_size(a, i)
        if size > 0.0:
            smallest = min(smallest, size)
        largest = max(largest, size)
    return largest > GRADED * smallest


@kernel("f2, i, i -> f")
def coupling_size(work, i, first):
    """Rate of state i among those from `first` on: its own, or the geometric mean of a pair of couplings."""
    n = work.shape[0]
    size = abs(work[i, i])
    for j in range(first, n):
        size = max(size, math.sqrt(work[i, j] * work[j, i]))
    return size


@kernel("f2, i, i")
def exchange(a, i, j):
    """Swap states i and j: rows and columns."""
    n = a.shape[0]
    if i == j:
        return
    for k in range(n):
        swap = a[i, k]
        a[i, k] = a[j, k]
        a[j, k] = swap
    for k in range(n):
        swap = a[k, i]
        a[k, i] = a[k, j]
        a[k, j] = swap


@kernel("f2, f1, f2 -> b")
def grade(a, rates, work):
    """Balance `a` (n, n) and put fast states first, in place, where its rates are far apart; False where they are not.

    rates (n,) : falling; the k-th largest eigenvalue is known to some roundings of rates[k]. They are the pivots of a
    symmetric elimination of moduli, in which nothing cancels. work (n, n) : scratch.
    """
    n = a.shape[0]
    if not is_graded(a):
        return False
    balance(a)
    for i in range(n):
        for j in range(n):
            work[i, j] = abs(a[i, j])
    for k in range(n):
        best = k
        largest = -1.0
        for i in range(k, n):
            size = coupling_size(work, i, k)
            if size > largest:
                largest = size
                best = i
        exchange(work, k, best)
        exchange(a, k, best)
        rates[k] = largest
        if largest > 0.0:
            for i in range(k + 1, n):
                factor = work[i, k] / largest
                for j in range(k + 1, n):
                    work[i, j] += factor * work[k, j]
    for k in range(1, n):  # elimination may raise what is left: sort, fast ones first
        value = rates[k]
        i = k - 1
        while i >= 0 and rates[i] < value:
            rates[i + 1] = rates[i]
            i -= 1
        rates[i + 1] = value
    return True


@kernel("f1, f1, f1")
def uniform_rates(re, im, rates):
    """One rate for all: the size of the largest eigenvalue."""
    largest = 0.0
    for i in range(re.size):
        largest = max(largest, abs(re[i]) + abs(im[i]))
    for i in range(re.size):
        rates[i] = largest


@kernel("f1, f1, f1, i -> f")
def rate_of(re, im, rates, i):
    """The rate that belongs to eigenvalue i by its rank."""
    size = math.hypot(re[i], im[i])
    rank = 0
    for j in range(re.size):
        other = math.hypot(re[j], im[j])
        if other > size or (other == size and j < i):
            rank += 1
    return rates[rank]
