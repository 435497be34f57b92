"""Fixed points of maps with a planted fold, flip or Neimark-Sacker point, in skewed coordinates u = M w."""

import numpy as np
import pytest

import contin
from contin.model.model import Model

RANGE = (-0.53, 0.61)
BEGIN = 0.6


def planted(seed):
    """(type, place, sign of the cubic term, model); other states are slaved, w_k -> m_k w_k + 0.3 w_0^2."""
    generator = np.random.default_rng(seed)
    kind, n = ["LP", "PD", "NS"][seed % 3], int(generator.integers(2, 4))
    at, sign = float(generator.uniform(-0.3, 0.3)), float(generator.choice([-1.0, 1.0]))
    a = float(generator.uniform(0.3, 0.7))
    left, right = (np.linalg.qr(generator.normal(size=(n, n)))[0] for _ in range(2))
    matrix = left @ np.diag(np.geomspace(1.0, 10.0 ** -generator.uniform(0.0, 4.5), n)) @ right
    inverse, rates = np.linalg.inv(matrix), generator.uniform(-0.8, 0.8, n)
    definitions = {f"w{i}": " + ".join(f"({float(inverse[i, j])!r})*u{j}" for j in range(n)) for i in range(n)}
    definitions["q"] = f"p - ({at!r})"
    core = np.zeros(n)
    if kind == "LP":
        images = [f"w0 + q - {a!r}*w0^2"]
        core[0] = np.sqrt((BEGIN - at) / a)
        core[1:] = 0.3 * np.square(core[0]) / (1.0 - rates[1:])
    elif kind == "PD":
        images = [f"-(1 + q)*w0 + ({sign * a!r})*w0^3"]
    else:
        angle = generator.uniform(0.4, 2.0)
        c, s = float(np.cos(angle)), float(np.sin(angle))
        definitions["r"] = f"1 + q + ({sign * a!r})*(w0^2 + w1^2)"
        images = [f"r*({c!r}*w0 - {s!r}*w1)", f"r*({s!r}*w0 + {c!r}*w1)"]
    images += [f"({float(rates[k])!r})*w{k} + 0.3*w0^2" for k in range(len(images), n)]
    definitions |= {f"g{k}": image for k, image in enumerate(images)}
    equations = {f"u{i}": " + ".join(f"({float(matrix[i, j])!r})*g{j}" for j in range(n)) for i in range(n)}
    start = {f"u{i}": float(value) for i, value in enumerate(matrix @ core)}
    model = Model(
        "planted", kind="map", states=start, parameters={"p": BEGIN}, definitions=definitions, equations=equations
    )
    return kind, at, sign, model


def complaints(seed):
    kind, at, sign, model = planted(seed)
    branch = contin.continuation(contin.equilibrium(model), "p", RANGE)
    points = [point for point in branch.points if (point.type, kind) != ("PD", "LP")]  # at 1 - 2 a w = -1
    if [point.type for point in points] != [kind]:
        return [f"{[point.label for point in branch.points]}, not {kind}; {branch.notes}"]
    found, point = [], points[0]
    if not abs(point.values["p"] - at) <= point.error:
        found.append(f"{point.values['p'] - at:.1e} off, {point.error:.1e} stated")
    word = str(point.normal_form.get("criticality", ""))
    super_sign = {"PD": 1.0, "NS": -1.0}.get(kind)
    wanted = "supercritical" if sign == super_sign else "subcritical"
    if super_sign is not None and word not in (wanted, "degenerate"):
        found.append(f"{word}, not {wanted}")
    return found + [f"unexplained {branch.unexplained}"] * bool(branch.unexplained)


@pytest.mark.parametrize("count", [18, pytest.param(600, marks=pytest.mark.long)])
def test_planted_points_of_maps_are_found_within_their_errors(count):
    assert {seed: found for seed in range(count) if (found := complaints(seed))} == {}
