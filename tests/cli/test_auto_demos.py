"""Demos of AUTO-07p as run files: what they find beside closed forms and published numbers."""

import json
from functools import cache
from math import acosh, cos, e, exp, expm1, pi, sin, sqrt
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from scipy.integrate import solve_bvp, solve_ivp
from scipy.optimize import brentq

from tests.cli.calls import call

FOLDER = Path(__file__).parents[2] / "examples" / "auto"
FOLDS_OF_AB = [u / (1 - u) * exp(-14 * u / 3) for u in ((1 - sqrt(1 / 7)) / 2, (1 + sqrt(1 / 7)) / 2)]
FOLD = 2 / (3 * sqrt(3))  # of mu + x - x^3
BRATU = 3.513830719125161  # 8 k^2 / cosh(k)^2 where k tanh(k) = 1
HEIGHT_TWO = 8 * acosh(e) ** 2 / e**2  # Bratu's solution 2 log(cosh(k)/cosh(k (1 - 2 t))) of height 2


def saturation(slope: float, low: float, high: float) -> float:
    """s0 = s + 100 R(s) where R(s) = s/(1 + s + s^2) has this slope, between two values of s."""
    s = brentq(lambda s: (1 - s * s) / (1 + s + s * s) ** 2 - slope, low, high, xtol=1e-15)
    return float(s + 100 * s / (1 + s + s * s))


def turning_of_tor(nu: float) -> float:
    """Routh and Hurwitz's condition of (s + a)(s^2 + b s + 1) - c s, the circuit at rest."""
    a, b, c = (0.5 + nu) / 0.6, 0.5 - 0.6, 0.25 / 0.6
    return (a + b) * (1 + a * b - c) - a


def turning_of_ops(l3: float) -> float:
    """The same for (l1 s - l4 (1 - l3^2) + 1/l2)(s + 1/l2) s + s + 1/l2 - s/l2^2, times l1^2: of the circuit ops."""
    l1, l2, l4 = 0.5, 4.0, 2.0
    a, b = (l4 * (l3 * l3 - 1) + 1 / l2) / l1, 1 / l2
    first, second, third = a + b, a * b + 1 / l1 - b * b / l1, b / l1
    return first * second - third


def trace_of_plp(rho: float) -> float:
    """Of the enzyme's equilibrium, between a = 50 and 110; s from s0 - s = 0.2 (500 - a)."""

    def balance(s: float) -> float:
        a = 500 - (110 - s) / 0.2
        return 110 - s - rho * s * a / (1 + s + 0.1 * s * s)

    s = brentq(balance, 10.5 if rho > 4.2 else 25.0, 26.0 if rho > 4.2 else 35.0, xtol=1e-14)
    a, d = 500 - (110 - s) / 0.2, 1 + s + 0.1 * s * s
    return float(-1 - rho * (a * d - s * a * (1 + 0.2 * s)) / d**2 - 0.2 - rho * s / d)


def turning_of_wav(p3: float) -> float:
    """det(J - k^2 D + i c k) = 0, k^2 = tr J/(1 + beta), of the enzyme's state with u near 27."""

    def off(u: float) -> float:
        v = p3 - (145 - u) / 0.2
        return 145 - u - 210 * v / (3.4 + v) * u / (1 + u + 0.023 * u * u)

    u = brentq(off, 25.0, 30.0, xtol=1e-14)
    v, d = p3 - (145 - u) / 0.2, 1 + u + 0.023 * u * u
    r1, r2 = 210 * v / (3.4 + v) * (1 - 0.023 * u * u) / d**2, 210 * 3.4 / (3.4 + v) ** 2 * u / d
    j = -3 * np.array([[r1 + 1, r2], [r1, r2 + 0.2]])
    square = np.trace(j) / 6
    return float((j[0, 0] - square) * (j[1, 1] - 5 * square) - j[0, 1] * j[1, 0] - 0.05**2 * square)


GRAZED = (2 + sqrt(8.5)) / 6
A_OF_FHN = sqrt(1 - 0.8 / 9) * (1 - 0.8 + 0.8 * (1 - 0.8 / 9) / 3)  # a = x + b (x^3/3 - x)
OPS = brentq(turning_of_ops, 0.8, 1.0)
WANTED = {
    "cusp": {"line.LP": ("mu", [-FOLD, FOLD]), "folds.CP": ("mu", [0])},
    "ab": {"line.LP": ("p1", FOLDS_OF_AB)},
    # Doedel and Heinemann (1983), to the digits of AUTO's own output
    "abc": {"line.HB": ("p1", [0.2041845, 0.2298390, 0.2599579, 0.3462085])},
    "dd2": {"line.PD": ("p1", [3]), "two.PD": ("p1", [1 + sqrt(6)])},
    # OEIS A086181, A091517: 3.5440903595519, 3.5644072660954, and the fifth doubling
    "log": {"one.PD": ("mu", [3]), "two.PD": ("mu", [1 + sqrt(6)]), "four.PD": ("mu", [3.5440903595519])},
    # Hopf points at s (s + b + 3)/(s - b - 1); the homoclinic orbit as Barrio, Shilnikov and Shilnikov (2012)
    "lrz": {"rest.BP": ("rho", [1]), "states.HB": ("rho", [470 / 19] * 2), "cycles.HOM": ("rho", [13.926557407])},
    "pp2": {"none.BP": ("p1", [0.6]), "prey.BP": ("p1", [2 / 3 / (1 - exp(-5 / 3))])},
    "exp": {"line.LP": ("p1", [BRATU])},
    "int": {"line.LP": ("p1", [11.9237902])},
    "bvp": {"zero.BP": ("p1", [1, 2, 3, 4, 5])},
    "ezp": {"line.BP": ("p1", [BRATU])},
    "opt": {"one.EX": ("x2", [-sqrt(1 / 2), sqrt(1 / 2)]), "two.EX": ("x2", [-sqrt(1 / 3), sqrt(1 / 3)]),
        "three.EX": ("x2", [-1 / 2, 1 / 2])},
    "pvl": {"line.UZ": ("p1", [HEIGHT_TWO])},
    "phs": {"line.HB": ("lambda", [0])},
    # the sum of both compartments turns where 1 + 100 R' = 0, their difference grows where 3 + 100 R' = 0
    "enz": {
        "line.LP": ("s0", [saturation(-1 / 100, 1.0, 1.5), saturation(-1 / 100, 5.0, 20.0)]),
        "line.BP": ("s0", [saturation(-3 / 100, 1.0, 1.5), saturation(-3 / 100, 2.0, 10.0)]),
    },
    # multipliers exp(+-i theta) on beta = 1: x = -cos(theta), alpha = 2 x + x^2; the fold's curve meets x = 0 at -1
    "hen": {
        "tori.R1": ("alpha", [-1]), "tori.R2": ("alpha", [3]), "tori.R3": ("alpha", [1.25]), "tori.R4": ("alpha", [0]),
        "folds.R1": ("alpha", [-1]), "folds.LPPD": ("alpha", [0]),
    },
    "pp3": {"start.BP": ("p1", [3 / 4])},  # (4 - 1/4)/5
    "apbp": {"one.BP": ("p2", [1]), "folds.LP": ("p3", [1 / 4])},
    "lcbp": {"cycles.BPC": ("p1", [2])},
    "vhb": {"rest.HB": ("p", [0]), "cycles.HOM": ("p", [0])},
    "nep": {"zero.BP": ("p", [n * n * pi * pi / 2 for n in (1, 2, 3)])},
    "sspg": {"bare.BP": ("s", [1 / (1 - exp(-1))])},
    "ext": {"zero.BP": ("lam", [1, 2, 3])},
    "tim": {"line.BP": ("p", [BRATU])},
    # u = (1 + exp(z/sqrt 6))^-2 at c = 5/sqrt 6, its steepest slope
    "fsh": {"front.UZ": ("v.max", [8 / 27 / sqrt(6), 0.04998011])},
    "nag": {"front.UZ": ("c", [sqrt(2) / 4, -sqrt(2) / 4])},
    "ppp": {"two.BP": ("p1", [0.55]), "prey.BP": ("p1", [1.25 / 6 / (1 - exp(-5 / 6))])},
    # x = (b1 - 1)/(2 b1); and y = 1/8 on the prey's nullcline 8 (1 - x) (1 + 3 x) = 5
    "tfc": {"two.HB": ("d1", [5 / 6]), "two.BP": ("d1", [5 * GRAZED / (1 + 3 * GRAZED)])},
    "tor": {"rest.BP": ("nu", [-1 / 2]), "rest.HB": ("nu", [brentq(turning_of_tor, -0.7, -0.55)])},
    "ops": {"rest.HB": ("l3", [-OPS, OPS])},
    "plp": {"rest.HB": ("rho", [brentq(trace_of_plp, 3.2, 3.8), brentq(trace_of_plp, 4.3, 5.0)])},
    # tested below; the doubled rotations of period 68 are at 0.17362879276
    "pen": {"turns.PD": ("I", [0.17916378]), "doubled.HOM": ("I", [0.17362879276])},
    # where the folds of cycles turn in p2 two families cross, and there the curve in three parameters begins
    "abcb": {"folds.EX": ("p2", [0.98218259, 1.26865801]), "across.BPC": ("p2", [0.98218259])},
    # x^2 = 1 - b/c^2 where the trace is zero; x^2 = (1 - b)/b where l1 is, of x" + (c (x^2 - 1) + b/c) x' + x - a - b x
    # + b x^3/3 = 0, as 2 c g' = 4 b c x^2
    "fhn": {"rest.HB": ("a", [-A_OF_FHN, A_OF_FHN]), "turning.GH": ("a", [-2 / 15, 2 / 15])},
    # u = sqrt(15/8)/cosh(x/sqrt 8)^2 at P = -5/2, and its image
    "rev": {"even.UZ": ("u.min", [-sqrt(15 / 8)])},
    # q = 2 k^2/cosh(k x)^2, k^2 = 3/4 (2 b + 1), where a = 3/5 (2 b + 1)(b - 2): Champneys and Groves (1997)
    "kdv": {"wave.UZ": ("q.max", [1.5 + 3 * (3 + sqrt(65)) / 4])},
    "ph1": {"rest.HB": ("rho", [brentq(trace_of_plp, 3.2, 3.8), brentq(trace_of_plp, 4.3, 5.0)])},
    # a wave of speed c: frequency^2 = trace/(1 + beta), and the determinant
    "wav": {"rest.HB": ("p3", [brentq(turning_of_wav, 635, 636)])},
}  # fmt: skip


WITH_ORBITS = ("ffn", "lor", "rev")


@cache
def result_of(name):
    """The results of a demo's run file, which several tests look at."""
    with TemporaryDirectory() as folder:
        return result_of_file(FOLDER / f"{name}.yaml", folder, *(["--orbits"] if name in WITH_ORBITS else []))


def result_of_file(path, folder, *options):
    out = Path(folder) / "out.json"
    call("run", str(path), "--quiet", *options, "--json", str(out))
    return json.loads(out.read_text())


def branches_of(name):
    """The branches of a demo's run file, by name."""
    return {branch["name"]: branch for branch in result_of(name)["branches"]}


@pytest.mark.parametrize("name", sorted(WANTED))
def test_a_demo_of_auto(name):
    branches = branches_of(name)
    for place, (parameter, expected) in WANTED[name].items():
        branch, type_ = place.split(".")
        found = sorted(p["values"][parameter] for p in branches[branch]["points"] if p["type"] == type_)
        assert found == pytest.approx(sorted(expected), rel=3e-7, abs=1e-7), place


def test_the_fold_of_a_complex_equation_has_two_null_vectors_and_no_coefficients():
    """F(u + iv) is analytic: its derivative vanishes on q and on i q at once."""
    (point,) = result_of("ezp")["branches"][0]["points"]
    assert point["normal_form"] == {"kind": "degenerate", "kernel": 2}


def test_an_eigenvalue_under_a_condition():
    """u = a sin(k (1 - t)), k = pi p1, with u(0) = p2 and integral(u^2) = a^2 (1/2 - sin(2 k)/(4 k)) = 1/2."""
    columns = branches_of("lin")["eigenvalue"]["columns"]
    for p1, p2 in zip(columns["p1"], columns["p2"], strict=True):
        k = pi * p1
        assert p2 == pytest.approx(abs(sin(k)) / sqrt(1 - sin(2 * k) / (2 * k)), abs=1e-6)


def test_a_problem_that_depends_on_the_place_ends_where_its_trajectory_does():
    columns = branches_of("non")["line"]["columns"]
    for row in (len(columns["p1"]) // 2, -1):
        p1 = columns["p1"][row]
        start = [0.0, columns["u2.start"][row]]
        end = solve_ivp(lambda x, u, p1=p1: [u[1], -p1 * exp(x**3 * u[0])], (0, 1), start, rtol=1e-11, atol=1e-12)
        assert end.y[:, -1] == pytest.approx([0.0, columns["u2.end"][row]], abs=1e-7)


def test_rotations_of_pendula_double_where_their_difference_turns_by_half():
    """pen: the rotation by its return to a = 2 pi, the difference's multipliers along it, by simulation."""

    def rates(_, y, drive):
        a, u, d1, e1, d2, e2 = y
        pull = -(cos(a) + 0.35)
        return [u, -0.1 * u - sin(a) + drive, e1, pull * d1 - 0.1 * e1, e2, pull * d2 - 0.1 * e2]

    def turn(drive, speed):
        once = lambda t, y, drive: y[0] - 2 * pi  # noqa: E731
        once.terminal = True
        found = solve_ivp(rates, (0, 50), [0, speed, 1, 0, 0, 1], args=(drive,), events=once, rtol=1e-11, atol=1e-12)
        return found.y[:, -1]

    def off(drive):
        speed = brentq(lambda v: turn(drive, v)[1] - v, 2.0, 4.0, xtol=1e-11)
        _, _, d1, e1, d2, e2 = turn(drive, speed)
        return (d1 + 1) * (e2 + 1) - d2 * e1

    branches = branches_of("pen")
    (point,) = [p for p in branches["turns"]["points"] if p["type"] == "PD"]
    assert point["values"]["I"] == pytest.approx(brentq(off, 0.17, 0.19, xtol=1e-10), abs=1e-8)


def test_mirror_images_end_at_one_homoclinic_orbit_where_their_folds_accumulate():
    """tor: p - p* falls by exp(-pi k/q) from fold to fold; Aitken's rule, twice, on the last six of them."""
    branches = branches_of("tor")
    for end in branches["other"]["ends"]:
        # folds at nu = -0.7604069193, -0.7188420834, -0.7316358380, -0.7281537738, -0.7291632519, -0.7288774659, ...
        assert abs(end["at"]["nu"] + 0.728941008) < end["error"] < 3e-7


@pytest.mark.long
def test_a_heteroclinic_orbit_of_five_equations_is_where_the_manual_has_it():
    """she: AUTO prints mu = 0.136505 at sigma = 0.452847, and 0.387300 at 0.859097."""
    (branch,) = result_of("she")["branches"]
    assert [p["values"]["mu"] for p in branch["points"]] == pytest.approx([0.136505, 0.387300], abs=6e-7)


def test_homoclinic_orbits_to_saddle_nodes_are_where_the_manual_has_them():
    """mtn: AUTO prints (K, Z) = (7.09217, 0.158708), (11.0181, 0.280980); non-central (5.18032, 0.0638551)."""
    branches = branches_of("mtn")
    at = {p["type"]: p["values"] for name in ("cycles", "loop") for p in branches[name]["points"]}
    assert [at[type_]["Z"] for type_ in ("HOM", "UZ")] == pytest.approx([0.158708, 0.280980], abs=6e-7)
    assert at["NCH"]["K"] == pytest.approx(5.18032, abs=2e-5)
    assert at["NCH"]["Z"] == pytest.approx(0.0638551, abs=2e-7)


@pytest.mark.long
def test_inclination_flips_are_where_the_manual_has_them():
    """kpr: AUTO prints (lambda, k) = (-1.80166, -0.200266) and (-1.56876, -0.439547), from lambda = -1.851185."""
    result = result_of("kpr")
    assert result["notes"] == []
    branches = {branch["name"]: branch for branch in result["branches"]}
    (start,) = branches["cycles"]["points"]
    assert start["values"]["lambda"] == pytest.approx(-1.851185, abs=6e-7)
    flips = sorted(p["values"]["k"] for p in branches["loop"]["points"] if p["type"] == "IFS")
    assert flips == pytest.approx([-0.439547, -0.200266], abs=1e-6)


UNSTABLE = {  # rates, radius of the circle and of the sphere
    "um2": (lambda u: [0.1 * u[0] - u[1] ** 3, u[1] + u[0] ** 3], 0.1, 0.6),
    "um3": (lambda u: [0.01 * u[0] - u[1] ** 3 + u[2] ** 3, u[1] + u[0] ** 3, u[0] ** 2 - u[2]], 0.03, 1.0),
}


@pytest.mark.parametrize("name", UNSTABLE)
def test_orbits_of_an_unstable_manifold_reach_the_sphere_when_they_do_by_integration(name):
    """um2, um3: `free: [T]` takes the place of the radius, which was solved for in the runs before."""
    rates, small, large = UNSTABLE[name]
    branches = branches_of(name)
    assert branches["slower"]["free"] == branches["round"]["free"] == ["T"]
    columns, angles = branches["round"]["columns"], [0.3, 1.0, 2.0, 2.9]
    assert {"T", "theta"} <= set(columns)
    for angle in angles:
        row = int(np.argmin(np.abs(np.array(columns["theta"]) - angle)))
        theta, time = columns["theta"][row], columns["T"][row]
        start = [small * cos(theta), small * sin(theta), 0.0][: len(rates([0.1, 0.1, 0.1]))]
        path = solve_ivp(lambda t, u: rates(u), (0, time), start, "DOP853", rtol=1e-12, atol=1e-14)
        assert np.linalg.norm(path.y[:, -1]) == pytest.approx(large, abs=1e-6)


def test_the_stable_manifold_of_lorenz_equations_leads_to_the_origin():
    """man: points of its orbits, integrated forwards, come near the origin."""
    columns = branches_of("man")["ws"]["columns"]
    points = np.array([columns[name] for name in ("x", "y", "z")])
    points = points[:, :: points.shape[1] // 12]

    def lorenz(_, flat):  # all points at once
        x, y, z = flat.reshape(points.shape)
        return np.concatenate([10 * (y - x), 28 * x - y - x * z, x * y - 8 / 3 * z])

    path = solve_ivp(lorenz, (0, 4), points.ravel(), "DOP853", rtol=1e-11, atol=1e-12, max_step=0.01)
    distances = np.linalg.norm(path.y.reshape(*points.shape, -1), axis=0)
    # what is 1e-8 off the surface grows by exp(11.8 t), and is carried past the origin at a hundredth of its way
    assert np.all(distances.min(axis=1) < 1e-2 * distances[:, 0])


@pytest.mark.long
def test_solitary_waves_have_belyakov_points_where_a_discriminant_vanishes():
    """fhh: l^3 - c l^2 - a l - eps/c at rest; a = -eps/c^2 at the Hopf point."""
    branches = branches_of("fhh")
    (hopf,) = [point for point in branches["rest"]["points"] if point["type"] == "HB"]
    assert hopf["values"]["a"] == pytest.approx(-0.0025 / 0.21**2, rel=1e-9)
    found = [point["values"] for point in branches["waves"]["points"] if point["type"] == "DRS"]
    assert len(found) == 2
    for values in found:
        a, c, e0 = values["a"], values["c"], 0.0025 / values["c"]
        terms = [18 * a * c * e0 * -1, -4 * c**3 * e0, a * a * c * c, 4 * a**3, -27 * e0 * e0]
        assert sum(terms) == pytest.approx(0.0, abs=1e-8 * max(map(abs, terms)))


def plant(v):
    """gI, and the other states, of Plant's neuron at rest at the voltage v; and its rates."""
    s = (127 * v + 115 * 75 - 12 * 30) / 105
    am, an = 0.1 * (50 - s) / expm1((50 - s) / 10), 0.01 * (55 - s) / expm1((55 - s) / 10)
    ah, bm = 0.07 * exp((25 - s) / 20), 4 * exp((25 - s) / 18)
    bn, bh = 0.125 * exp((45 - s) / 80), 1 / (exp((55 - s) / 10) + 1)
    m, n, h = am / (am + bm), an / (an + bn), ah / (ah + bh)
    t = 1 / (1 + exp(-0.15 * (50 + v)))
    c = 0.0085 * t * (140 - v)
    outward = (0.3 * n**4 + 0.03 * c / (0.5 + c)) * (75 + v) + 0.003 * (40 + v)
    return (outward / (30 - v) - 0.01 * t) / (m**3 * h), (t, n, h, c), (m, (an, bn), (ah, bh))


def real_part_of_plant(v):
    """Of the pair of eigenvalues at rest; differences of the equations."""
    conductance, others, _ = plant(v)
    rest = np.array([v, *others])

    def rates(u):
        _, (t, _, _, _), (m, (an, bn), (ah, bh)) = plant(u[0])
        inward = (conductance * m**3 * u[3] + 0.01 * u[1]) * (30 - u[0])
        outward = (0.3 * u[2] ** 4 + 0.03 * u[4] / (0.5 + u[4])) * (75 + u[0]) + 0.003 * (40 + u[0])
        slow = 0.0003 * (0.0085 * u[1] * (140 - u[0]) - u[4])
        gates = (an - (an + bn) * u[2]) / 12.5, (ah - (ah + bh) * u[3]) / 12.5
        return np.array([inward - outward, (t - u[1]) / 235, *gates, slow])

    steps = 1e-6 * np.maximum(np.abs(rest), 1.0) * np.eye(5)
    matrix = np.array([(rates(rest + d) - rates(rest - d)) / (2 * d.max()) for d in steps]).T
    values = np.linalg.eigvals(matrix)
    return float(values[np.argmax(np.abs(values.imag))].real)


HOPF_POINTS_OF_PLANT = [(-56, -54), (-11, -10)]


def slow_cycles_of_plant(folder):
    """The branch at rest for gI > 0, with one of its two Hopf points, and the family from there."""
    text = (FOLDER / "pla.yaml").read_text().replace("range: [-120, 60]", "range: [0, 60]")
    narrow = folder / "narrow.yaml"
    narrow.write_text(text[: text.index("  - {name: first")] + "  - {name: second, from: rest.HB1, parameter: gI}\n")
    return {branch["name"]: branch for branch in result_of_file(narrow, folder)["branches"]}


def homoclinic_limit(family):
    """The last orbits of the family are where its limit is said to be."""
    (limit,) = [point for point in family["points"] if point["type"] == "HOM"]
    assert family["columns"]["period"][-1] > 2e4
    assert limit["values"]["gI"] == pytest.approx(family["columns"]["gI"][-1], abs=2e-5)
    return limit


def test_cycles_of_a_bursting_neuron_end_at_a_homoclinic_orbit(tmp_path):
    """pla: with the third rate of the saddle, 0.0059, 0.012 and 0.00015 among them, two orbits of period 985 agreed on
    27.6329, and the family goes on."""
    branches = slow_cycles_of_plant(tmp_path)
    (hopf,) = [point for point in branches["rest"]["points"] if point["type"] == "HB"]
    places = [plant(brentq(real_part_of_plant, *between))[0] for between in HOPF_POINTS_OF_PLANT]
    assert hopf["values"]["gI"] == pytest.approx(max(places), rel=1e-6)
    homoclinic_limit(branches["second"])


@pytest.mark.long
def test_a_bursting_neuron_has_two_hopf_points_and_one_limit_by_two_ways(tmp_path):
    branches = branches_of("pla")
    hopf = [point["values"]["gI"] for point in branches["rest"]["points"] if point["type"] == "HB"]
    places = [plant(brentq(real_part_of_plant, *between))[0] for between in HOPF_POINTS_OF_PLANT]
    assert hopf == pytest.approx(places, rel=1e-6)
    limit, other = homoclinic_limit(branches["second"]), homoclinic_limit(slow_cycles_of_plant(tmp_path)["second"])
    assert other["values"]["gI"] == pytest.approx(limit["values"]["gI"], abs=limit["error"] + other["error"])


def test_cycles_at_one_of_two_equilibria_begin_in_closed_form():
    """snh: nu1 = -sin(phi) at phi = 2 pi - acos(0.73); (2 cos(phi) + nu2)^2 has a double zero there."""
    branches = branches_of("snh")
    (hopf,) = branches["rest"]["points"]
    assert hopf["values"]["nu1"] == pytest.approx(sqrt(1 - 0.73**2), rel=1e-9)
    assert [point["type"] for point in branches["cycles"]["points"]] == ["LPC", "NS"]


@pytest.mark.long
def test_an_orbit_flip_in_an_invariant_plane():
    """san: at mu = m = 0 the plane z = 0 is invariant, and its orbit x^2 (1 - x) = y^2 has no leading part."""
    (branch,) = result_of("san")["branches"]
    (point,) = branch["points"]
    assert point["type"] == "OFS"
    assert (point["values"]["mu"], point["values"]["m"]) == pytest.approx((0, 0), abs=1e-8)


@pytest.mark.long
def test_the_optimum_of_three_parameters_is_stationary_by_shooting():
    """obv: the manual names three extrema in one parameter; in three, the cost's gradient vanishes."""
    branches = branches_of("obv")
    assert sum(point["type"] == "EX" for point in branches["one"]["points"]) == 3
    (best,) = [point["values"] for point in branches["three"]["points"] if point["type"] == "EX"]

    def cost(l1, l2, l3):
        rates = lambda t, y: [y[1], -l1 * exp(y[0] + l2 * y[0] ** 2 + l3 * y[0] ** 4), (y[0] - 1) ** 2]  # noqa: E731
        shot = lambda v: solve_ivp(rates, (0, 1), [0, v, 0], "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]  # noqa: E731
        slope = brentq(lambda v: shot(v)[0], 0.97 * best["v.start"], 1.03 * best["v.start"], xtol=1e-13)
        return shot(slope)[2] + (l1 * l1 + l2 * l2 + l3 * l3) / 10

    place = np.array([best["l1"], best["l2"], best["l3"]])
    assert cost(*place) == pytest.approx(best["cost"], abs=1e-10)
    for step in 1e-3 * np.eye(3):
        assert abs(cost(*(place + step)) - cost(*(place - step))) / 2e-3 < 1e-6


def test_lorenz_cycles_double_where_their_monodromy_matrix_says_so():
    """lor: the orbit closes, and has the multiplier -1, by Dormand and Prince's method."""
    (branch,) = result_of("lor")["branches"]
    points = [p for p in branch["points"] if p["type"] == "PD"]
    assert len(points) == 2  # of both images under (x, y) -> -(x, y)
    for point in points:
        rho, start = point["values"]["rho"], [point["orbit"][name][0] for name in "xyz"]

        def rates(_, w, rho=rho):
            x, y, z = w[:3]
            matrix = np.array([[-10, 10, 0], [rho - z, -1, -x], [y, x, -8 / 3]])
            flow = [10 * (y - x), rho * x - y - x * z, x * y - 8 / 3 * z]
            return np.concatenate([flow, (matrix @ w[3:].reshape(3, 3)).ravel()])

        whole = np.concatenate([start, np.eye(3).ravel()])
        end = solve_ivp(rates, (0, point["values"]["period"]), whole, "DOP853", rtol=1e-11, atol=1e-11).y[:, -1]
        assert end[:3] == pytest.approx(start, abs=1e-3)
        assert np.abs(np.linalg.eigvals(end[3:].reshape(3, 3)) + 1).min() < 1e-4


def test_the_speed_of_a_sharp_wave_is_that_of_a_shot_from_the_other_end():
    """stw at lam = 1/2: the unstable manifold of (1, 0) passes the saddle (0, c) on one side or the other."""

    def beyond(c):
        rate = (c + sqrt(c * c + 10)) / 2  # of the linearisation [[0, 5/2], [1, c]]
        start = [1 - 1e-7, -1e-7 * rate / 2.5]

        def rates(_, y):
            u, v = y
            return [(2 * u + u * u / 2) * v, c * v - (1 + u / 2) * v * v - u * (1 - u)]

        near = lambda t, y: y[0] - 1e-9  # noqa: E731
        near.terminal = True
        return solve_ivp(rates, (0, 200), start, events=[near], rtol=1e-11, atol=1e-13).y[1, -1] - c

    (wave,) = result_of("stw")["branches"]
    (point,) = [p for p in wave["points"] if p["type"] == "UZ"]
    assert point["values"]["c"] == pytest.approx(brentq(beyond, -0.6, -0.58, xtol=1e-9), abs=1e-6)


def test_connections_between_two_saddles_are_called_heteroclinic(capsys):
    call("run", str(FOLDER / "stw.yaml"))
    assert "wave  locus of heteroclinic orbits in lam and c" in capsys.readouterr().out


@pytest.mark.long
def test_homoclinic_orbits_of_a_circuit_are_where_the_manual_has_them():
    """cir: what AUTO prints (on 35 intervals), and what each label says of the eigenvalues at rest."""
    (branch,) = result_of("cir")["branches"]
    at = {p["type"]: (p["values"]["nu"], p["values"]["beta"]) for p in branch["points"]}
    printed = {"DRS": (-0.7590583, 0.7428734), "NSF": (-0.7204001, 0.5912315), "NDS": (-0.7256925, 0.4535645)}
    for type_, place in printed.items():
        assert at[type_] == pytest.approx(place, abs=2e-5), type_
    assert at["SH"][1] == pytest.approx(0, abs=1e-6)

    def characteristic(nu, beta):
        return np.poly([[-(beta + nu) / 0.6, beta / 0.6, 0], [beta, -beta, -1], [0, 1, 0]])

    _, a, b, c = characteristic(*at["DRS"])  # a double root
    assert a * a * b * b - 4 * b**3 - 4 * a**3 * c - 27 * c * c + 18 * a * b * c == pytest.approx(0, abs=1e-7)
    _, a, b, c = characteristic(*at["NSF"])  # roots -s +- i w and s, whose sum is -s: s = a
    assert 2 * a**3 + a * b + c == pytest.approx(0, abs=1e-7)
    assert characteristic(*at["NDS"])[1] == pytest.approx(0, abs=1e-7)  # the sum of all three


def test_antisymmetric_orbits_are_those_of_another_solver():
    """rev at P = 0, by scipy's collocation: from the unstable eigenspace of u'''' = u^3 - u to u = u'' = 0."""
    odd = {branch["name"]: branch for branch in result_of("rev")["branches"]}["odd"]
    point = next(p for p in odd["points"] if abs(p["values"]["P"]) < 1e-9)
    orbit = {name: np.array(values) for name, values in point["orbit"].items()}
    matrix = np.array([[0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1], [-1, 0, 0, 0.0]])
    values, vectors = np.linalg.eig(matrix.T)
    away = vectors[:, np.argmin(values.real)]  # of a stable eigenvalue: no part along it
    middle = int(np.argmax(np.abs(orbit["v"])))
    t, guess = orbit["t"][: middle + 1], np.array([orbit[name][: middle + 1] for name in "uvwy"])
    keep = np.append(np.diff(t) > 0, True)
    ends = lambda a, b: [away.real @ a, away.imag @ a, b[0], b[2]]  # noqa: E731
    found = solve_bvp(lambda _, z: [z[1], z[2], z[3], z[0] ** 3 - z[0]], ends, t[keep], guess[:, keep], tol=1e-6)
    assert found.success
    assert abs(found.y[1, -1]) == pytest.approx(abs(point["values"]["v.min"]), rel=1e-6)


def test_a_driven_cell_oscillates_where_the_divergence_vanishes_on_average():
    """ffn: at a Neimark-Sacker point of two equations det M = 1; the response by Dormand and Prince's method."""
    points = [p for branch in result_of("ffn")["branches"] for p in branch["points"] if p["type"] == "NS"]
    assert len(points) == 2  # as the amplitude grows, and as a does
    for point in points:
        amp, a = point["values"]["amp"], point["values"]["a"]

        def rates(t, y, amp=amp, a=a):
            x, y, _ = y
            growth = 3 * (1 - x * x) - 0.8 / 3
            return [3 * (x - x**3 / 3 + y - amp * cos(10 * t)), -(x - a + 0.8 * y) / 3, growth]

        start = [point["orbit"]["x"][0], point["orbit"]["y"][0], 0.0]
        end = solve_ivp(rates, (0, pi / 5), start, "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
        assert end == pytest.approx(start, abs=1e-6)


def test_a_simulation_settles_where_prey_and_predators_rest():
    """ivp: (1/3, 2) where nothing is harvested."""
    (simulation,) = result_of("ivp")["simulations"]
    assert [simulation["columns"][name][-1] for name in "uv"] == pytest.approx([1 / 3, 2], abs=1e-5)


def test_a_cycle_of_the_enzyme_has_the_period_of_a_simulation():
    """ph1 at rho = 4, where it attracts."""
    branches = branches_of("ph1")
    (point,) = [p for p in branches["cycles"]["points"] if p["type"] == "UZ"]

    def rates(_, y):
        eaten = 4 * y[0] * y[1] / (1 + y[0] + y[0] ** 2 / 10)
        return [110 - y[0] - eaten, (500 - y[1]) / 5 - eaten]

    up = lambda t, y: y[0] - 20  # noqa: E731
    up.direction = 1
    found = solve_ivp(rates, (0, 120), [20, 100], "LSODA", events=up, rtol=1e-10, atol=1e-10)
    assert np.diff(found.t_events[0])[-3:] == pytest.approx(point["values"]["period"], rel=1e-7)


@pytest.mark.parametrize("name", ["p2c", "pcl"])
def test_the_origin_is_connected_with_a_cycle_where_the_manual_has_it(name):
    """AUTO's manual has rho = 24.0579 at sigma = 10 and beta = 8/3 (demo pcl)."""
    heart = {branch["name"]: branch for branch in result_of(name)["branches"]}["heart"]
    (point,) = [p for p in heart["points"] if p["type"] == "UZ"]
    assert point["values"]["rho"] == pytest.approx(24.0579, abs=5e-5)
