"""Normal forms beside a diffusive chain, in sparse coordinates that mix their states with the chain's."""

import numpy as np
import scipy.sparse as sp

import contin

STATIC = (3 - np.sqrt(5)) / 2  # answer x_0 of an endless chain x' = D x - x + e_0, which falls by this part a place


def chain(m):
    line = sp.diags_array([np.ones(m - 1), -3 * np.ones(m), np.ones(m - 1)], offsets=[-1, 0, 1])
    return line.tocsc()


def beside_chain(core, source, start, at, m, mass=False):
    """w' = core(w, x_0, p), x' = D x - x + source(w) e_0 in u with (w, x) = T u, T^-1 u' or (`mass`) T u' given.

    T is made of blocks of two: a state of the core and one far down the chain, or two of the chain.
    """
    k = len(start)
    n = k + m
    order = np.argsort(np.where(np.arange(n) < k, 2 * np.arange(n) * (n // (2 * k)), np.arange(n)), kind="stable")
    block = sp.block_diag([np.array([[1.0, 0.3], [-0.2, 0.9]])] * (n // 2) + [np.eye(1)] * (n % 2))
    place = sp.csc_matrix((np.ones(n), (order, np.arange(n))), (n, n))
    change = (place @ block @ place.T).tocsc()
    back = (place @ sp.linalg.inv(block.tocsc()) @ place.T).tocsc()
    line = chain(m)

    def field(y, p):
        x = line @ y[k:]
        x[0] = x[0] + source(y[:k])
        return np.concatenate([core(y[:k], y[k], p), x])

    def residual(u, p):
        value = field(change @ u, p)
        return value if mass else back @ value

    def jacobian(u, p):
        y = change @ u
        small = np.zeros((k + 1, k + 1))
        for j in range(k + 1):
            moved = y[: k + 1].astype(complex)
            moved[j] += 1e-30j
            small[:k, j] = np.imag(core(moved[:k], moved[k], p)) / 1e-30
            small[k, j] = np.imag(source(moved[:k])) / 1e-30 + 0.0 * small[k, j]
        rows, columns = np.indices(small.shape)
        own = sp.csc_matrix((small.ravel(), (rows.ravel(), columns.ravel())), (n, n))
        whole = own + sp.block_diag([sp.csc_matrix((k, k)), line], format="csc")
        return (whole @ change if mass else back @ whole @ change).tocsc()

    u0 = back @ np.concatenate([start, np.zeros(m)])
    options = {"mass": change} if mass else {}
    return contin.FunctionProblem(residual, u0, dict(at), jacobian=jacobian, **options)


def turned(a, b, growth, turn):
    return [growth * a - turn * b, growth * b + turn * a]


def double_hopf(m, omegas=(1.0, 2.3), **options):
    """p11, p12, p21, p22 = -1.3 + G/2, -0.6 + G, 0.4 + G/4, -0.7 + G/2 with G = STATIC for w1 of frequency omega1."""
    one, two = omegas

    def core(w, x, p):
        s, t = w[0] ** 2 + w[1] ** 2, w[2] ** 2 + w[3] ** 2
        slow = p["p"] - 0.5 * p["q"] - 0.7 * s + 0.4 * t + 0.25 * x
        fast = p["q"] + 0.25 * p["p"] - 0.6 * s - 1.3 * t + 0.5 * x
        return np.array([*turned(w[0], w[1], slow, one), *turned(w[2], w[3], fast, two + 0.3 * t)])

    return beside_chain(core, lambda w: w[2] ** 2 + w[3] ** 2 + 2 * (w[0] ** 2 + w[1] ** 2), (0.0,) * 4,
                        {"p": -0.9, "q": -0.1}, m, **options)  # fmt: skip


def zero_hopf(m, **options):
    """w' = p + w^2 - |z|^2 + x w/2, z' = (q + 0.8 w + w^2 + 0.7 x + 1.4 i) z, x the chain's answer to |z|^2 + 2 w^2."""

    def core(w, x, p):
        s = w[1] ** 2 + w[2] ** 2
        growth = p["q"] + 0.8 * w[0] + w[0] ** 2 + 0.7 * x
        return np.array([p["p"] + w[0] ** 2 - s + 0.5 * x * w[0], *turned(w[1], w[2], growth, 1.4)])

    start = (-0.5, 0.0, 0.0)
    at = {"p": -0.25 + 0.25 * STATIC / 2, "q": -0.1}
    return beside_chain(core, lambda w: w[1] ** 2 + w[2] ** 2 + 2 * w[0] ** 2, start, at, m, **options)


def on_plane(m, **options):
    """w' = w (p + 0.6 w - 0.9 |z|^2 + x/2), z' = (q - 0.5 w - 0.3 |z|^2 + x/4 + 1.4 i) z, x that to |z|^2."""

    def core(w, x, p):
        s = w[1] ** 2 + w[2] ** 2
        growth = p["q"] - 0.5 * w[0] - 0.3 * s + 0.25 * x
        return np.array([w[0] * (p["p"] + 0.6 * w[0] - 0.9 * s + 0.5 * x), *turned(w[1], w[2], growth, 1.4)])

    return beside_chain(core, lambda w: w[1] ** 2 + w[2] ** 2, (0.0,) * 3, {"p": -0.5, "q": -0.3}, m, **options)
