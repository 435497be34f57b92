"""Cores with points of codimension two of fixed points of maps: random coefficients, every event in closed form."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from tests.truth.codim2_of_flows import first, n, number, off, size_of
from tests.truth.planted_curves import Core, Event, Hidden

Random = np.random.Generator
Check = Callable[[Any, Hidden], str]


def turned(size: str, angle: str, state: int = 0) -> list[str]:
    """z -> size e^(i angle) z, z = w_k + i w_(k + 1)."""
    a, b = f"w{state}", f"w{state + 1}"
    return [
        f"({size})*(cos({angle})*{a} - sin({angle})*{b})", f"({size})*(sin({angle})*{a} + cos({angle})*{b})",
    ]  # fmt: skip


def _growth(gap: float) -> tuple[str, list[float]]:
    return ("B", [0.0]) if gap == 0.0 else (f"(B^2 - {n(gap * gap)})", [-gap, gap])


def _name(label: str, curve: str, gap: float) -> str:
    return f"{label} on {curve}" if gap == 0.0 else f"two {label} on {curve}, {2 * gap:.0e} apart"


def _reals(polynomial: list[float]) -> list[float]:
    return [float(root.real) for root in np.roots(polynomial) if abs(root.imag) < 1e-9]


def cusp(random: Random) -> Core:
    c = number(random)

    def check(point: Any, hidden: Hidden) -> str:
        return off(point, "c", c / np.linalg.norm(hidden.image(1.0)) ** 2)

    return Core(
        "CP on LP", "LP", [f"w0 + A + B*w0 + {n(c)}*w0^3"], lambda s: (2 * c * s**3, -3 * c * s**2),
        [Event("CP", 0.0, check)], 0.3, lambda a, b: [c, 0.0, b, a], lambda s: s, kind="map",
    )  # fmt: skip


def resonance_1(random: Random, type_: str) -> Core:
    """w0 -> w0 + w1, w1 -> w1 + A + B w1 + a w0^2 + b w0 w1; folds A = 0, circles B = (2 a - b) w0."""
    a = number(random)
    b = number(random) + 2 * a * float(random.choice([0.0, 1.0]))
    b = b if abs(b - 2 * a) > 0.3 else b + 0.6

    def check(point: Any, hidden: Hidden) -> str:
        sign, found = int(np.sign(a * (b - 2 * a))), point.normal_form.get("s")
        size = np.linalg.norm(hidden.image(1.0))
        wrong = "" if found == sign else f"s = {found}, not {sign}"
        return first(wrong, off(point, "a", a / size, sign=False), off(point, "b", b / size, sign=False))

    equations = ["w0 + w1", f"w1 + A + B*w1 + {n(a)}*w0^2 + {n(b)}*w0*w1"]
    if type_ == "LP":  # multipliers 1 and 1 + s
        events = [Event("R1", 0.0, check), Event("LPPD", -2.0)]
        return Core("R1 on LP", "LP", equations, lambda s: (0.0, s), events, 0.35, lambda p, q: [a, 0.0, p],
                    kind="map", born={"R1": ["NS"]})  # fmt: skip
    events = [Event("R1", 0.0, check), Event("R2", -2 / a), Event("R3", -1.5 / a), Event("R4", -1 / a)]
    start = -0.15 * np.sign(a) / max(1.0, abs(a))
    return Core(
        "R1 on NS", "NS", equations, lambda w: (-a * w * w, (2 * a - b) * w), events, float(start),
        lambda p, q: [a, 0.0, p], lambda w: w, kind="map", span=(-0.2, 0.2), born={"R1": ["LP"]},
    )  # fmt: skip


def generalised_flip(random: Random, gap: float = 0.0) -> Core:
    e = number(random)
    growth, ats = _growth(gap)

    def check(point: Any, hidden: Hidden) -> str:
        return off(point, "e", e / np.linalg.norm(hidden.image(1.0)) ** 4)

    return Core(
        _name("GPD", "PD", gap), "PD", [f"-(1 + A)*w0 + {growth}*w0^3 + {n(e)}*w0^5"], lambda s: (0.0, s),
        [Event("GPD", s, check) for s in ats], 0.35, kind="map",
    )  # fmt: skip


def resonance_2(random: Random, type_: str) -> Core:
    """w0 -> -w0 + w1, w1 -> -w1 + A w0 + B w1 + C w0^3 + D w0^2 w1; flips A = 0, circles A = -B."""
    C, D = number(random), number(random)

    def check(point: Any, hidden: Hidden) -> str:
        size = np.linalg.norm(hidden.image(1.0)) ** 2
        return first(off(point, "C", C / size), off(point, "D", D / size))

    equations = ["-w0 + w1", f"-w1 + A*w0 + B*w1 + {n(C)}*w0^3 + {n(D)}*w0^2*w1"]
    if type_ == "PD":
        return Core("R2 on PD", "PD", equations, lambda s: (0.0, s), [Event("R2", 0.0, check), Event("LPPD", 2.0)],
                    -0.35, kind="map", born={"R2": ["NS"]})  # fmt: skip
    events = [Event("R2", 0.0, check), Event("R3", 1.0), Event("R4", 2.0)]
    return Core("R2 on NS", "NS", equations, lambda s: (-s, s), events, 0.35, kind="map", born={"R2": ["PD"]})


def fold_flip(random: Random, type_: str, gap: float = 0.0) -> Core:
    """w0 -> w0 + A + a w0^2 + s w1^2, w1 -> -(1 + B + k w0) w1 + c w1^3."""
    a, s, k, c = (number(random) for _ in range(4))
    growth, ats = _growth(gap)

    def check(point: Any, hidden: Hidden) -> str:
        size = float(np.linalg.norm(hidden.image(0.0, 1.0))) ** 2
        A, b, d = -a / k, -k * s, 2.0 * c * (a - k) / k
        found = first(off(point, "a", A), off(point, "b", b / size), off(point, "d", d / size))
        return first(found, off(point, "L_NS", -A * (2.0 * A * b + 3.0 * b + d) / size))

    equations = [f"w0 + A + {n(a)}*w0^2 + {n(s)}*w1^2", f"-(1 + {growth} + {n(k)}*w0)*w1 + {n(c)}*w1^3"]
    if type_ == "LP":
        events = [Event("LPPD", t, check) for t in ats]
        return Core(_name("LPPD", "LP", gap), "LP", equations, lambda t: (0.0, t), events,
                    0.35, lambda p, q: [a, 0.0, p], kind="map", born={"LPPD": ["PD"]})  # fmt: skip
    events = [Event("LPPD", 0.0, check), Event("GPD", -k * s / (2 * a * c)), Event("R2", -1 / a)]
    return Core(
        "LPPD on PD", "PD", equations, lambda w: (-a * w * w, -k * w), events, 0.3, lambda p, q: [a, 0.0, p],
        lambda w: w, kind="map", span=(-0.9 / abs(a), 0.9 / abs(a)), born={"LPPD": ["LP"]},
    )  # fmt: skip


def fold_circle(random: Random, type_: str, gap: float = 0.0) -> Core:
    """w0 -> w0 + A + a w0^2 + s R, z -> e^(i t) (1 + B + k w0 + d R) z, R = |z|^2."""
    a, s, k, d = (number(random) for _ in range(4))
    angle = random.uniform(0.4, 1.2)
    growth, ats = _growth(gap)
    r = "(w1^2 + w2^2)"

    def check(point: Any, hidden: Hidden) -> str:
        theta, b = k / a, d * (k - a) / (s * a * a)
        sign, found = int(np.sign(a * s)), point.normal_form.get("s")
        wrong = "" if found == sign else f"s = {found}, not {sign}"
        E = b - 1.5 * theta**2 + theta
        return first(wrong, off(point, "theta", theta), off(point, "E", E), off(point, "c", 0.0))

    equations = [
        f"w0 + A + {n(a)}*w0^2 + {n(s)}*{r}", *turned(f"1 + {growth} + {n(k)}*w0 + {n(d)}*{r}", n(angle), 1),
    ]  # fmt: skip
    if type_ == "LP":
        events = [Event("LPNS", t, check) for t in ats]
        return Core(_name("LPNS", "LP", gap), "LP", equations, lambda t: (0.0, t), events,
                    0.35, lambda p, q: [a, 0.0, p], kind="map", born={"LPNS": ["NS"]})  # fmt: skip
    # |z| -> |z| (1 + (d + k h) R), h = -s/(2 a w)
    events = [Event("LPNS", 0.0, check), Event("CH", k * s / (2 * a * d)), Event("PDNS", -1 / a)]
    return Core(
        "LPNS on NS", "NS", equations, lambda w: (-a * w * w, -k * w), events, 0.3, lambda p, q: [a, 0.0, p],
        lambda w: w, kind="map", span=(-0.9 / abs(a), 0.9 / abs(a)), born={"LPNS": ["LP"]},
    )  # fmt: skip


def interaction(point: Any, p: list[list[float]], lengths: tuple[float, float]) -> str:
    """Of PDNS and NSNS: p_jk of amplitudes that are measured in these lengths."""
    places = [(j, k) for j in range(2) for k in range(2)]
    found = [off(point, f"p{j + 1}{k + 1}", p[j][k] / lengths[k] ** 2) for j, k in places]
    return first(*found, off(point, "theta", p[0][1] / p[1][1]), off(point, "delta", p[1][0] / p[0][0]))


def flip_circle(random: Random, type_: str, gap: float = 0.0) -> Core:
    p11, p12, p21, p22 = (number(random) for _ in range(4))
    mix, angle = number(random, 0.2, 0.5), random.uniform(0.4, 1.2)
    growth, ats = _growth(gap)
    r = "(w1^2 + w2^2)"
    flip = f"-(1 + A)*w0 + {n(p11)}*w0^3 + {n(p12)}*w0*{r}"

    def check(point: Any, hidden: Hidden) -> str:
        lengths = float(np.linalg.norm(hidden.image(1.0))), size_of(hidden, 1)
        return interaction(point, [[-p11, -p12], [p21, p22]], lengths)

    circle = turned(f"1 + {growth} + {n(mix)}*A + {n(p21)}*w0^2 + {n(p22)}*{r}", n(angle), 1)
    if type_ == "PD":
        return Core(_name("PDNS", "PD", gap), "PD", [flip, *circle], lambda t: (0.0, t),
                    [Event("PDNS", t, check) for t in ats], 0.35, kind="map", born={"PDNS": ["NS"]})  # fmt: skip
    return Core("PDNS on NS", "NS", [flip, *circle], lambda t: (t, -mix * t), [Event("PDNS", 0.0, check)], 0.35,
                kind="map", born={"PDNS": ["PD"]})  # fmt: skip


def two_circles(random: Random) -> Core:
    p11, p12, p21, p22 = (number(random) for _ in range(4))
    mix, angle, other = number(random, 0.2, 0.5), random.uniform(0.3, 0.9), random.uniform(1.1, 1.4)
    one, two = "(w0^2 + w1^2)", "(w2^2 + w3^2)"
    equations = [
        *turned(f"1 + A + {n(p11)}*{one} + {n(p12)}*{two}", n(angle)),
        *turned(f"1 + B + {n(mix)}*A + {n(p21)}*{one} + {n(p22)}*{two}", n(other), 2),
    ]

    def check(point: Any, hidden: Hidden) -> str:  # the larger angle comes first
        return interaction(point, [[p22, p21], [p12, p11]], (size_of(hidden, 2), size_of(hidden)))

    return Core("NSNS on NS", "NS", equations, lambda t: (0.0, t), [Event("NSNS", 0.0, check)], 0.35, kind="map",
                born={"NSNS": ["NS"]})  # fmt: skip


def chenciner(random: Random, gap: float = 0.0) -> Core:
    """z -> e^(i t) z (1 + A + (growth + i e) R + l R^2)."""
    e, l2, angle = number(random), number(random), random.uniform(0.4, 1.2)
    growth, ats = _growth(gap)
    r = "(w0^2 + w1^2)"
    u, v = f"(1 + A + {growth}*{r} + {n(l2)}*{r}^2)", f"({n(e)}*{r})"
    c, s = n(float(np.cos(angle))), n(float(np.sin(angle)))
    equations = [
        f"({u}*{c} - {v}*{s})*w0 - ({u}*{s} + {v}*{c})*w1", f"({u}*{s} + {v}*{c})*w0 + ({u}*{c} - {v}*{s})*w1",
    ]  # fmt: skip

    def check(point: Any, hidden: Hidden) -> str:
        return off(point, "l2", (l2 + 0.5 * e * e) / size_of(hidden) ** 4)

    return Core(_name("CH", "NS", gap), "NS", equations, lambda t: (0.0, t), [Event("CH", t, check) for t in ats],
                0.35, kind="map")  # fmt: skip


def resonance_3(random: Random) -> Core:
    """z -> (1 + A) e^(i (2 pi/3 + B)) z + b conj(z)^2 + c z |z|^2; Re of the coefficient: Re(e^-it c) - |b|^2."""
    b, c = complex(number(random), number(random)), complex(number(random), number(random))
    angle = 2.0 * np.pi / 3.0
    linear = turned("1 + A", f"{n(angle)} + B")
    r = "(w0^2 + w1^2)"
    equations = [
        f"{linear[0]} + {n(b.real)}*(w0^2 - w1^2) + 2*{n(b.imag)}*w0*w1 + {r}*({n(c.real)}*w0 - {n(c.imag)}*w1)",
        f"{linear[1]} + {n(b.imag)}*(w0^2 - w1^2) - 2*{n(b.real)}*w0*w1 + {r}*({n(c.imag)}*w0 + {n(c.real)}*w1)",
    ]

    def check(point: Any, hidden: Hidden) -> str:
        back = np.exp(-1j * angle)
        a = (3 * back * c - 3 * abs(b) ** 2).real / abs(3 * b) ** 2
        return off(point, "a", float(a))

    ratio = abs(b) ** 2 / abs(c)
    events = [Event("R3", 0.0, check), Event("R4", -np.pi / 6)]
    events += [
        Event("CH", float((np.angle(c) - sign * np.arccos(ratio) - angle + np.pi) % (2 * np.pi) - np.pi))
        for sign in ((1, -1) if ratio < 1.0 else ())
    ]
    return Core("R3 on NS", "NS", equations, lambda t: (0.0, t), events, 0.3, kind="map", span=(-1.0, 0.8))


def resonance_4(random: Random) -> Core:
    """z -> (1 + A) e^(i (pi/2 + B)) z + c z |z|^2 + d conj(z)^3."""
    c, d = complex(number(random), number(random)), complex(number(random), number(random))
    angle = 0.5 * np.pi
    linear = turned("1 + A", f"{n(angle)} + B")
    r, x, y = "(w0^2 + w1^2)", "(w0^3 - 3*w0*w1^2)", "(w1^3 - 3*w0^2*w1)"  # conj(z)^3 = x + i y
    equations = [
        f"{linear[0]} + {r}*({n(c.real)}*w0 - {n(c.imag)}*w1) + {n(d.real)}*{x} - {n(d.imag)}*{y}",
        f"{linear[1]} + {r}*({n(c.imag)}*w0 + {n(c.real)}*w1) + {n(d.imag)}*{x} + {n(d.real)}*{y}",
    ]

    def check(point: Any, hidden: Hidden) -> str:
        exact, form = -4j * c / abs(-4j * d), point.normal_form
        away = abs(complex(*form["A0"]) - exact)
        allowed = form["errors"]["A0"]
        return "" if away <= allowed else f"A0 = {form['A0']}, not {exact}: off by {away:.1e}, stated {allowed:.1e}"

    events = [Event("R4", 0.0, check), Event("R3", np.pi / 6)]
    for half in (0.5, -0.5):  # Re(e^-it c) = 0
        events.append(Event("CH", float((np.angle(c) + half * np.pi - angle + np.pi) % (2 * np.pi) - np.pi)))
    return Core("R4 on NS", "NS", equations, lambda t: (0.0, t), events, 0.3, kind="map", span=(-0.9, 0.9))


def alone(random: Random) -> Iterator[Core]:
    """One point of each type on each curve that it lies on."""
    yield cusp(random)
    yield from (resonance_1(random, t) for t in ("LP", "NS"))
    yield generalised_flip(random)
    yield from (resonance_2(random, t) for t in ("PD", "NS"))
    yield from (fold_flip(random, t) for t in ("LP", "PD"))
    yield from (fold_circle(random, t) for t in ("LP", "NS"))
    yield from (flip_circle(random, t) for t in ("PD", "NS"))
    yield two_circles(random)
    yield chenciner(random)
    yield resonance_3(random)
    yield resonance_4(random)


def close(random: Random, gap: float) -> Iterator[Core]:
    """Two points a distance of 2 `gap` apart."""
    yield generalised_flip(random, gap)
    yield chenciner(random, gap)
    yield fold_flip(random, "LP", gap)
    yield fold_circle(random, "LP", gap)
    yield flip_circle(random, "PD", gap)
