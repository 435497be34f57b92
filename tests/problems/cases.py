"""Systems with the exact set of labels that belongs to each, in closed form."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import e, exp, pi, sin, sqrt

Labels = list[tuple[str, float]]


@dataclass(frozen=True)
class Case:
    """d(states)/dt = equations, with the first parameter free in `range`; `expected` holds (type, parameter)."""

    equations: dict[str, str]
    states: dict[str, object]
    parameters: dict[str, object]
    range: tuple[float, float]
    expected: Labels
    ends: tuple[str, str] = ("bound", "bound")
    kernels: dict[float, int] = field(default_factory=dict)  # dimension of the kernel, where above 1
    also: dict[float, tuple[str, ...]] = field(default_factory=dict)

    def follow(self, **options):
        from tests.problems.follow import follow

        return follow(self.equations, self.states, self.parameters, self.range, **options)


R = (-1.0, 1.5)
AT = {"p": -1.0}


def oscillator(x: str, y: str, growth: str, omega: str = "1", cubic: str = "-1") -> dict[str, str]:
    """(x, y)' with x + i y =: w, w' = (growth + i omega) w + cubic w |w|^2."""
    g, square = f"({growth}) + ({cubic})*({x}^2 + {y}^2)", omega
    return {x: f"({g})*{x} - {square}*{y}", y: f"{square}*{x} + ({g})*{y}"}


def zeros(names: str) -> dict[str, object]:
    return dict.fromkeys(names.split(), 0.0)


FOLDS = {
    "one fold": Case({"x": "p - x^2"}, {"x": 1.0}, {"p": 1.0}, R, [("LP", 0.0)]),
    "hysteresis": Case(
        {"x": "p + 3*x - x^3"}, {"x": -2.5}, {"p": 2.5 * 3 - 2.5**3}, (-9.0, 9.0), [("LP", 2.0), ("LP", -2.0)]
    ),
    "quartic": Case(
        {"x": "p - x^4/4 + x^2/2"}, {"x": 2.0}, {"p": 2.0}, (-1.0, 2.5), [("LP", -0.25), ("LP", 0.0), ("LP", -0.25)]
    ),
    "explosion: p e^x = x": Case(
        {"x": "x - p*exp(x)"}, {"x": 0.01}, {"p": 0.01 * exp(-0.01)}, (0.005, 1.0), [("LP", 1 / e)]
    ),
    "folds 1e-5 apart": Case(
        {"x": "p - x^3 + 3*e*x"}, {"x": 1.0}, {"p": 1.0 - 3 * 2.5e-6 ** (2 / 3), "e": 2.5e-6 ** (2 / 3)}, R,
        [("LP", 5e-6), ("LP", -5e-6)],
    ),
    "a cusp is no fold": Case({"x": "p - x^3"}, {"x": -1.0}, {"p": -1.0}, R, []),
    "an inflection is no fold": Case({"x": "p - x^3 - x/1000000"}, {"x": -0.5}, {"p": -0.1250005}, R, []),
    "no fold where the parameter only pauses": Case({"x": "p - x - sin(x)"}, {"x": 0.0}, {"p": 0.0}, (-10.0, 10.0), []),
}  # fmt: skip

BRANCH_POINTS = {
    "transcritical": Case({"x": "p*x - x^2"}, {"x": 0.0}, AT, R, [("BP", 0.0)]),
    "pitchfork": Case({"x": "p*x - x^3"}, {"x": 0.0}, AT, R, [("BP", 0.0)]),
    "pitchfork from its side": Case({"x": "p*x - x^3"}, {"x": 1.0}, {"p": 1.0}, R, [("BP", 0.0)]),
    "subcritical pitchfork, with the folds of its side": Case(
        {"x": "p*x + 2*x^3 - x^5"}, {"x": sqrt(2.0)}, {"p": 0.0}, (-2.0, 1.0), [("LP", -1.0), ("BP", 0.0), ("LP", -1.0)]
    ),
    "branch point at a fold of its own branch": Case(
        {"x": "(p - x^2)*(p - 2*x)"}, {"x": 1.0}, {"p": 1.0}, R, [("BP", 0.0)]
    ),
    "branch points 1e-5 apart": Case(
        {"x": "x*((p - 0.5123)^2 - 0.000005^2) - x^3"}, {"x": 0.0}, AT, R, [("BP", 0.512295), ("BP", 0.512305)]
    ),
    "a vertical family: any x at p = -1": Case(
        {"x": "(p + 1)*x*(1 + x)"}, {"x": 0.0}, {"p": -2.0}, (-3.0, 1.5), [("BP", -1.0)]
    ),
    "amplitude equation odd in r": Case(
        {"r": "-p*r/2 + r*exp(-r^2)"}, {"r": 0.0}, {"p": 1.0}, (0.1, 4.0), [("BP", 2.0)]
    ),
    "three lines: x (p - x) (p + x)": Case({"x": "p^2*x - x^3"}, {"x": 0.0}, AT, R, [("BP", 0.0)]),
    "figure of eight: x^4 - x^2 + p^2 = 0": Case(
        {"x": "x^4 - x^2 + p^2"}, {"x": 1.0}, {"p": 0.0}, (-2.0, 2.0),
        [("BP", 0.0), ("LP", 0.5), ("LP", 0.5), ("LP", -0.5), ("LP", -0.5)], ("closed", "closed"),
    ),
    "twenty modes of a chain: p = 4 sin^2(k pi/42)": Case(
        {
            f"u{k}": f"p*u{k} - u{k}^3 - 2*u{k}"
            + (f" + u{k - 1}" if k > 1 else "")
            + (f" + u{k + 1}" if k < 20 else "")
            for k in range(1, 21)
        },
        {f"u{k}": 0.0 for k in range(1, 21)}, {"p": -0.1}, (-0.1, 4.1),
        [("BP", 4 * sin(k * pi / 42) ** 2) for k in range(1, 21)],
    ),
}  # fmt: skip

HOPF_POINTS = {
    "one Hopf point": Case(oscillator("x", "y", "p"), zeros("x y"), AT, R, [("HB", 0.0)]),
    "Hopf points 1e-5 apart": Case(
        oscillator("x", "y", "(p - 0.5123)^2 - 0.000005^2"), zeros("x y"), AT, R, [("HB", 0.512295), ("HB", 0.512305)]
    ),
    "slow and fast: frequencies 1e-3 and 1e3": Case(
        {**oscillator("x", "y", "p", "0.001"), **oscillator("u", "v", "p - 0.5", "1000")}, zeros("x y u v"), AT, R,
        [("HB", 0.0), ("HB", 0.5)],
    ),
    "Bogdanov-Takens unfolding, Hopf 1e-6 from the fold": Case(
        {"x": "y", "y": "p + 0.001*y + x^2 + x*y"}, {"x": -1.0, "y": 0.0}, AT, (-1.0, 1.0), [("LP", 0.0), ("HB", -1e-6)]
    ),
    "Bogdanov-Takens unfolding on the other side: a neutral saddle": Case(
        {"x": "y", "y": "p - 0.001*y + x^2 + x*y"}, {"x": -1.0, "y": 0.0}, AT, (-1.0, 1.0), [("LP", 0.0)]
    ),
    "Hopf point 1e-10 from a fold": Case(
        {**oscillator("x", "y", "z - 0.00001"), "z": "p - z^2"}, {**zeros("x y"), "z": 1.0}, {"p": 1.0}, R,
        [("LP", 0.0), ("HB", 1e-10)],
    ),
    "neutral saddle": Case({"x": "x + y*x", "y": "-(p + 2)*y"}, zeros("x y"), AT, (-1.8, 1.5), []),
    "neutral saddle and Hopf point at one place": Case(
        {"x": "x", "y": "-(p + 2)*y", **oscillator("u", "v", "p + 1")}, zeros("x y u v"), AT, (-1.8, 1.5),
        [("HB", -1.0)],
    ),
    "pair that touches the axis": Case(oscillator("x", "y", "-p^2"), zeros("x y"), AT, R, []),
    "unstable pair that touches the axis": Case(oscillator("x", "y", "p^2"), zeros("x y"), AT, R, []),
    "real pair that becomes complex": Case({"x": "y", "y": "-x - 2*p*y"}, zeros("x y"), {"p": 2.0}, (0.5, 3.0), []),
}  # fmt: skip

COINCIDENT = {
    "two pairs of different frequency": Case(
        {**oscillator("x", "y", "p"), **oscillator("u", "v", "p", "2")}, zeros("x y u v"), AT, R,
        [("HB", 0.0), ("HB", 0.0)],
    ),
    "two pairs of the same frequency": Case(
        {**oscillator("x", "y", "p"), **oscillator("u", "v", "p")}, zeros("x y u v"), AT, R, [("HB", 0.0)],
        kernels={0.0: 2},
    ),
    "two pairs that cross in opposite senses": Case(
        {**oscillator("x", "y", "p"), **oscillator("u", "v", "-p", "2")}, zeros("x y u v"), AT, R,
        [("HB", 0.0), ("HB", 0.0)],
    ),
    "fold with a pair": Case(
        {**oscillator("x", "y", "z"), "z": "p - z^2"}, {**zeros("x y"), "z": 1.0}, {"p": 1.0}, R, [("LP", 0.0)],
        also={0.0: ("ZH",)},
    ),
    "kernel of dimension 2": Case(
        {"x": "p*x - x^3", "y": "p*y - y^3"}, zeros("x y"), AT, R, [("BP", 0.0)], kernels={0.0: 2}
    ),
    "kernel of dimension 2, crossing in opposite senses": Case(
        {"x": "p*x - x^3", "y": "-p*y - y^3"}, zeros("x y"), AT, R, [("BP", 0.0)], kernels={0.0: 2}
    ),
    "kernel of dimension 3": Case(
        {"x": "p*x - x^3 + y*z", "y": "p*y - y^3 + x*z", "z": "p*z - z^3 + x*y"}, zeros("x y z"), AT, R, [("BP", 0.0)],
        kernels={0.0: 3},
    ),
    "ring of four: p = 2 d, twice, between 0 and 4 d": Case(
        {
            f"u{k}": f"p*u{k} - u{k}^3 + 0.2*(u{(k + 1) % 4} + u{(k - 1) % 4} - 2*u{k})" for k in range(4)
        },
        zeros("u0 u1 u2 u3"), AT, R, [("BP", 0.0), ("BP", 0.4), ("BP", 0.8)], kernels={0.4: 2},
    ),
    "ring of four oscillators": Case(
        {
            name: text
            for k in range(4)
            for name, text in {
                f"x{k}": f"p*x{k} - y{k} - x{k}*(x{k}^2 + y{k}^2) + 0.2*(x{(k + 1) % 4} + x{(k - 1) % 4} - 2*x{k})",
                f"y{k}": f"x{k} + p*y{k} - y{k}*(x{k}^2 + y{k}^2) + 0.2*(y{(k + 1) % 4} + y{(k - 1) % 4} - 2*y{k})",
            }.items()
        },
        zeros("x0 y0 x1 y1 x2 y2 x3 y3"), AT, R, [("HB", 0.0), ("HB", 0.4), ("HB", 0.8)], kernels={0.4: 2},
    ),
    "opposite senses, one eigenvalue twice as fast": Case(
        {"x": "p*x - x^3", "y": "-2*p*y - y^3"}, zeros("x y"), AT, R, [("BP", 0.0)], kernels={0.0: 2}
    ),
    "opposite senses beside a stable mode": Case(
        {"x": "p*x - x^3", "y": "-p*y - y^3", "z": "-z"}, zeros("x y z"), AT, R, [("BP", 0.0)], kernels={0.0: 2}
    ),
    "three pairs, one against the others": Case(
        {**oscillator("x", "y", "p"), **oscillator("u", "v", "-p", "2.1"), **oscillator("a", "b", "p", "3.3")},
        zeros("x y u v a b"), AT, R, [("HB", 0.0)] * 3,
    ),
    "opposite pairs 1e-3 apart": Case(
        {**oscillator("x", "y", "p"), **oscillator("u", "v", "0.001 - p", "2.1")}, zeros("x y u v"), AT, R,
        [("HB", 0.0), ("HB", 0.001)],
    ),
    "opposite pairs 1e-6 apart": Case(
        {**oscillator("x", "y", "p"), **oscillator("u", "v", "0.000001 - p", "2.1")}, zeros("x y u v"), AT, R,
        [("HB", 0.0), ("HB", 0.000001)],
    ),
    "opposite zeros 1e-3 apart": Case(
        {"x": "p*x - x^3", "y": "(0.001 - p)*y - y^3"}, zeros("x y"), AT, R, [("BP", 0.0), ("BP", 0.001)]
    ),
    "pitchfork and pair at once": Case(
        {**oscillator("x", "y", "p"), "z": "p*z - z^3"}, zeros("x y z"), AT, R, [("BP", 0.0)], also={0.0: ("ZH",)}
    ),
    "pitchfork and pair, 1e-5 apart": Case(
        {**oscillator("x", "y", "p"), "z": "(p - 0.00001)*z - z^3"}, zeros("x y z"), AT, R,
        [("HB", 0.0), ("BP", 0.00001)],
    ),
    "two transcritical points at once": Case(
        {"x": "p*x - x^2", "y": "p*y - y^2"}, zeros("x y"), AT, R, [("BP", 0.0)], kernels={0.0: 2}
    ),
    "two folds at once are a crossing": Case(
        {"x": "p - x^2", "y": "p - y^2"}, {"x": 1.0, "y": 1.0}, {"p": 1.0}, R, [("BP", 0.0)]
    ),
}  # fmt: skip

CONSERVATIVE = {
    "Duffing without damping: centres are no Hopf points": Case(
        {"x": "y", "y": "p*x - x^3"}, zeros("x y"), AT, R, [("BP", 0.0)]
    ),
    "pendulum under torque: a centre meets a saddle": Case(
        {"x": "y", "y": "p - sin(x)"}, {"x": {"value": 0.0, "period": "2*pi"}, "y": 0.0}, {"p": 0.0}, (-2.0, 2.0),
        [("LP", 1.0), ("LP", -1.0)], ("closed", "closed"),
    ),
    "predator and prey": Case({"x": "x*(p - y)", "y": "y*(x - 1)"}, {"x": 1.0, "y": 1.0}, {"p": 1.0}, (0.1, 3.0), []),
    "centre beside a Hopf point": Case(
        {"a": "2*b", "b": "-2*a - a^3", **oscillator("x", "y", "p")}, zeros("a b x y"), AT, R, [("HB", 0.0)]
    ),
    "centre with rounding errors beside a Hopf point": Case(
        {"a": "0.3*a + 1.7*b + c", "b": "-1.7*a - 0.3*b", "c": "-c", **oscillator("x", "y", "p")}, zeros("a b c x y"),
        AT, R, [("HB", 0.0)],
    ),
}  # fmt: skip

CLOSED = ("closed", "closed")
TWO_PI = "2*pi"
LOOPS = {
    "circle": Case({"x": "1 - x^2 - p^2"}, {"x": 1.0}, {"p": 0.0}, (-2.0, 2.0), [("LP", 1.0), ("LP", -1.0)], CLOSED),
    "flat ellipse": Case(
        {"x": "1 - x^2*1000000 - p^2"}, {"x": 0.001}, {"p": 0.0}, (-2.0, 2.0), [("LP", 1.0), ("LP", -1.0)], CLOSED
    ),
    "small circle in a wide range": Case(
        {"x": "1 - (x - 2)^2 - p^2"}, {"x": 3.0}, {"p": 0.0}, (-200.0, 200.0), [("LP", 1.0), ("LP", -1.0)], CLOSED
    ),
    "circle cut by the bound": Case(
        {"x": "1 - x^2 - p^2"}, {"x": 1.0}, {"p": 0.0}, (-2.0, 0.5), [("LP", -1.0)]
    ),
    "angle that winds once": Case(
        {"x": "p - 0.5*sin(x)"}, {"x": {"value": 0.0, "period": TWO_PI}}, {"p": 0.0}, (-1.0, 10.0),
        [("LP", 0.5), ("LP", -0.5)], CLOSED,
    ),
    "two angles, winding 2 and 1": Case(
        {"x": "sin(x - 2*y)", "y": "p - 0.5*sin(y)"},
        {"x": {"value": 0.0, "period": TWO_PI}, "y": {"value": 0.0, "period": TWO_PI}}, {"p": 0.0}, (-1.0, 1.0),
        [("LP", 0.5), ("LP", -0.5)], CLOSED,
    ),
    "two angles, winding 1 and 2: every fold twice": Case(
        {"x": "sin(x - y/2)", "y": "p - 0.5*sin(y)"},
        {"x": {"value": 0.0, "period": TWO_PI}, "y": {"value": 0.0, "period": TWO_PI}}, {"p": 0.0}, (-1.0, 1.0),
        [("LP", 0.5), ("LP", -0.5)] * 2, CLOSED,
    ),
    "angle carried along by the parameter does not close": Case(
        {"x": "sin(x - p)"}, {"x": {"value": 0.0, "period": TWO_PI}}, {"p": 0.0}, (-10.0, 10.0), []
    ),
}  # fmt: skip

ALL = {**FOLDS, **BRANCH_POINTS, **HOPF_POINTS, **COINCIDENT, **CONSERVATIVE, **LOOPS}
