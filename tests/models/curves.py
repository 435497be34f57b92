"""Equilibria in closed form, derived by hand from the equations of the sources; see the comments in the model files.

`m` is math or mpmath, `c` holds the parameters as attributes.
"""

from tests.models.closed_curves import Curve


def morris_lecar(v, c, m):
    calcium = (1 + m.tanh((v - c.v1) / c.v2)) / 2
    w = (1 + m.tanh((v - c.v3) / c.v4)) / 2
    return {"V": v, "w": w, "I": c.gL * (v - c.VL) + c.gCa * calcium * (v - c.VCa) + c.gK * w * (v - c.VK)}


def hodgkin_huxley(v, c, m):
    def gate(a, b):
        return a / (a + b)

    sodium = gate((v + 40) / 10 / (1 - m.exp(-(v + 40) / 10)), 4 * m.exp(-(v + 65) / 18))
    h = gate(7 * m.exp(-(v + 65) / 20), 100 / (1 + m.exp(-(v + 35) / 10)))
    n = gate((v + 55) / 100 / (1 - m.exp(-(v + 55) / 10)), m.exp(-(v + 65) / 80) / 8)
    current = c.gNa * sodium**3 * h * (v - c.VNa) + c.gK * n**4 * (v - c.VK) + c.gL * (v - c.VL)
    return {"V": v, "m": sodium, "h": h, "n": n, "I": current}


def lorenz_84(u, c, m):
    x = (c.delta - c.T / u) / c.gamma
    # (x - 1) y - beta x z = -G and beta x y + (x - 1) z = 0
    square = (x - 1) ** 2 + (c.beta * x) ** 2
    y, z = -c.G * (x - 1) / square, c.G * c.beta * x / square
    return {"X": x, "Y": y, "Z": z, "U": u, "F": x + (y**2 + z**2 + c.gamma * u**2) / c.alpha}


def roessler(shift, c, m):
    x = shift + c.c
    a = -shift * x / c.b
    return {"x": x, "y": -x / a, "z": x / a, "a": a}


def prey_alone(u, c, m):
    return {"u1": u, "u2": 0 * u, "p1": c.p2 * u * (1 - u) / (1 - m.exp(-c.p3 * u))}


def reactor_ab(u, c, m):
    t = c.p2 * u / (1 + c.p3)
    return {"u1": u, "u2": t, "p1": u * m.exp(-t) / (1 - u)}


def reactor_abc(s, c, m):
    e = m.exp(s)
    u1 = e / (1 + e)
    u2 = u1 / (1 + c.sigma * e)
    u3 = c.B * e * (1 - u1 + c.alpha * c.sigma * u2) / (1 + c.beta)
    return {"u1": u1, "u2": u2, "u3": u3, "D": e * m.exp(-u3)}


def bazykin(x, c, m):
    y = (1 - c.epsilon * x) * (1 + c.alpha * x)
    return {"x": x, "y": y, "delta": (x / (1 + c.alpha * x) - c.gamma) / y}


CURVES = {
    "morris-lecar": Curve("I", -79.3, 60.7, morris_lecar),
    "hodgkin-huxley": Curve("I", -69.13, -20.17, hodgkin_huxley),
    "lorenz-84": Curve("F", -0.9, -0.0101, lorenz_84),
    "roessler": Curve("a", -3.999, -0.0001, roessler),
    "predator-prey": Curve("p1", 0.05, 0.99, prey_alone),
    "reactor-ab": Curve("p1", 0.001, 0.999, reactor_ab),
    "reactor-abc": Curve("D", -7.01, 5.99, reactor_abc),
    "bazykin": Curve("delta", 1.01, 99.1, bazykin),
}
