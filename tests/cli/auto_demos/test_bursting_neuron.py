"""Plant's bursting neuron, AUTO-07p's demo pla: Hopf points from the equations, and a homoclinic limit by two ways."""

from math import exp, expm1

import numpy as np
import pytest
from scipy.optimize import brentq

from tests.cli.auto_demos.results import FOLDER, branches_of, result_of_file


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


@pytest.mark.seldom
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
