"""The models of the benchmarks."""

from __future__ import annotations

from contin.model.model import Model


def pair() -> Model:
    """Two metronomes on a movable platform, averaged, in polar form, typed from the paper (Kato and Kori)."""
    rest = "sqrt((3*a + sqrt(9*a^2 - 48*pi*b*beta))/(4*b))"
    return Model(
        "pair",
        states={"r1": 2, "r2": 2, "psi": {"value": 0, "period": "2*pi"}},
        parameters={"mu": 8, "beta": 0.8, "a": 4, "b": 1},
        equations={
            "r1": "(-6*pi*mu*r2*sin(psi) - 6*pi*beta*r1 + 3*a*r1^3 - 2*b*r1^5)/(12*pi)",
            "r2": "(6*pi*mu*r1*sin(psi) - 6*pi*beta*r2 + 3*a*r2^3 - 2*b*r2^5)/(12*pi)",
            "psi": "(16*mu*(r1/r2 - r2/r1)*cos(psi) + 6*a*(r1^2 - r2^2) - 5*b*(r1^4 - r2^4))/32",
        },
        symmetries={"exchange": {"r1": "r2", "r2": "r1", "psi": "-psi"}},
        starts={
            "in-phase": {"r1": rest, "r2": rest, "psi": 0},
            "anti-phase": {"r1": rest, "r2": rest, "psi": "pi"},
        },
    )


def reactor() -> Model:
    """A -> B, Uppal, Ray and Poore (1974): AUTO's demo ab."""
    return Model(
        "ab", states={"u1": 0, "u2": 0}, parameters={"p1": 0, "p2": 14, "p3": 2},
        equations={"u1": "-u1 + p1*(1 - u1)*exp(u2)", "u2": "-u2 + p1*p2*(1 - u1)*exp(u2) - p3*u2"},
    )  # fmt: skip


def two_reactions() -> Model:
    """A -> B -> C, Doedel and Heinemann (1983): AUTO's demo abc."""
    return Model(
        "abc", states={"u": 0, "v": 0, "w": 0}, parameters={"D": 0, "a": 1, "be": 1.55, "B": 8, "s": 0.04},
        definitions={"E": "exp(w)"},
        equations={
            "u": "-u + D*(1 - u)*E", "v": "-v + D*E*(1 - u - s*v)",
            "w": "-w - be*w + D*B*E*(1 - u + a*s*v)",
        },
    )  # fmt: skip


def roessler() -> Model:
    """x = a z, y = -z and the smaller root z of a z^2 - c z + b = 0 is the equilibrium."""
    z = "(c - sqrt(c^2 - 4*a*b))/(2*a)"
    return Model(
        "roessler", states={"x": f"a*{z}", "y": f"-{z}", "z": z}, parameters={"a": 0.05, "c": 4, "b": 2},
        equations={"x": "-y - z", "y": "x + a*y", "z": "b + z*(x - c)"},
    )  # fmt: skip


def brusselator() -> Model:
    return Model(
        "bru2", states={"x": 1, "y": 1.5}, parameters={"B": 1.5, "A": 1},
        equations={"x": "A - (B + 1)*x + x^2*y", "y": "B*x - x^2*y"},
    )  # fmt: skip


def two_brusselators() -> Model:
    """Coupled by diffusion; the homogeneous state has the Hopf point of one."""
    return Model(
        "cbr4", states={"x": 1, "y": 1.5, "u": 1, "v": 1.5}, parameters={"B": 1.5, "A": 1, "D": 0.5},
        equations={
            "x": "A - (B + 1)*x + x^2*y + D*(u - x)", "y": "B*x - x^2*y + D*(v - y)",
            "u": "A - (B + 1)*u + u^2*v + D*(x - u)", "v": "B*u - u^2*v + D*(y - v)",
        },
    )  # fmt: skip


def brusselator_on_a_line(n: int, length: float, a: float, b: float, dx: float, dy: float) -> Model:
    """With diffusion, n / 2 points between ends at the homogeneous state; L is the parameter."""
    m = n // 2
    equations = {}
    for i in range(m):
        left = (f"x{i - 1}", f"y{i - 1}") if i else ("A", "B/A")
        right = (f"x{i + 1}", f"y{i + 1}") if i < m - 1 else ("A", "B/A")
        reaction = f"x{i}^2*y{i}"
        c = f"{(m + 1) ** 2}/L^2"
        equations[f"x{i}"] = f"{reaction} - (B + 1)*x{i} + A + Dx*{c}*({left[0]} - 2*x{i} + {right[0]})"
        equations[f"y{i}"] = f"B*x{i} - {reaction} + Dy*{c}*({left[1]} - 2*y{i} + {right[1]})"
    states = {**{f"x{i}": a for i in range(m)}, **{f"y{i}": b / a for i in range(m)}}
    parameters = {"L": length, "A": a, "B": b, "Dx": dx, "Dy": dy}
    return Model(f"brx{n}", states=states, parameters=parameters, equations=equations)


def lorenz() -> Model:
    return Model(
        "lor3", states={"x": "sqrt(b*(rho - 1))", "y": "sqrt(b*(rho - 1))", "z": "rho - 1"},
        parameters={"rho": 20, "b": "8/3", "s": 10},
        equations={"x": "s*(y - x)", "y": "rho*x - y - x*z", "z": "x*y - b*z"},
    )  # fmt: skip
