"""Demos of AUTO-07p: homoclinic and heteroclinic orbits beside what the manual prints."""

import json

import numpy as np
import pytest

from tests.cli.auto_demos.results import FOLDER, branches_of, result_of
from tests.cli.calls import call


def test_mirror_images_end_at_one_homoclinic_orbit_where_their_folds_accumulate():
    """tor: p - p* falls by exp(-pi k/q) from fold to fold; Aitken's rule, twice, on the last six of them."""
    branches = branches_of("tor")
    assert len(branches["other"]["ends"]) == 2
    for end in branches["other"]["ends"]:
        # folds at nu = -0.7604069193, -0.7188420834, -0.7316358380, -0.7281537738, -0.7291632519, -0.7288774659, ...
        assert abs(end["at"]["nu"] + 0.728941008) < end["error"] < 3e-7


@pytest.mark.long
def test_a_heteroclinic_orbit_of_five_equations_is_where_the_manual_has_it():
    """she: AUTO prints mu = 0.136505 at sigma = 0.452847, and 0.387300 at 0.859097."""
    (branch,) = result_of("she")["branches"]
    assert [p["values"]["mu"] for p in branch["points"]] == pytest.approx([0.136505, 0.387300], abs=6e-7)


@pytest.mark.seldom
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


@pytest.mark.long
def test_an_orbit_flip_in_an_invariant_plane():
    """san: at mu = m = 0 the plane z = 0 is invariant, and its orbit x^2 (1 - x) = y^2 has no leading part."""
    (branch,) = result_of("san")["branches"]
    (point,) = branch["points"]
    assert point["type"] == "OFS"
    assert (point["values"]["mu"], point["values"]["m"]) == pytest.approx((0, 0), abs=1e-8)


@pytest.mark.seldom
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


@pytest.mark.parametrize("name", [pytest.param("p2c", marks=pytest.mark.long), "pcl"])  # the same orbit
@pytest.mark.seldom
def test_the_origin_is_connected_with_a_cycle_where_the_manual_has_it(name):
    """AUTO's manual has rho = 24.0579 at sigma = 10 and beta = 8/3 (demo pcl)."""
    heart = {branch["name"]: branch for branch in result_of(name)["branches"]}["heart"]
    (point,) = [p for p in heart["points"] if p["type"] == "UZ"]
    assert point["values"]["rho"] == pytest.approx(24.0579, abs=5e-5)


@pytest.mark.seldom
def test_the_orbit_from_a_cycle_to_the_other_equilibrium_is_where_reversed_trajectories_change_sides(tmp_path, capsys):
    """pci: nu1 = 0.7411891805(1), by bisection with Dormand and Prince's method of order 8, backwards along the stable
    manifold of the equilibrium. The curve is called by its ends, and ends where a multiplier of the cycle is 1."""
    out = tmp_path / "out.json"
    call("run", str(FOLDER / "pci.yaml"), "--json", str(out))
    assert "link  locus of orbits from a cycle to an equilibrium in nu1 and nu2" in capsys.readouterr().out
    (link,) = (branch for branch in json.loads(out.read_text())["branches"] if branch["name"] == "link")
    (point,) = link["points"]
    assert abs(point["values"]["nu1"] - 0.7411891805) < 1e-10 + point["error"] < 2e-9
    assert "passes the unit circle" in link["ends"][0]["text"]
    assert link["columns"]["multiplier"][0] == pytest.approx(1.0, abs=0.1)
    assert max(link["columns"]["multiplier"]) < 1.0
    assert min(link["columns"]["phi.min"][k] - x for k, x in enumerate(link["columns"]["phi.saddle2"])) > 0.0


@pytest.mark.long
def test_pulses_of_two_turns_have_the_speed_of_one():
    """fnb: turns are far apart, so that speeds differ by exp(-time between them); a double root at rest at DRS."""
    one, two = (branches_of("fnb")[name] for name in ("one", "two"))
    at = {(b["name"], p["type"]): p for b in (one, two) for p in b["points"]}
    first, second = at["one", "UZ"], at["two", "UZ"]
    assert abs(first["values"]["c"] - second["values"]["c"]) <= first["error"] + second["error"] < 1e-7
    a, c = (at["one", "DRS"]["values"][name] for name in ("a", "c"))
    roots = np.sort_complex(np.roots([1, -c, -a, -0.0025 / c]))  # of x^3 = c x^2 + a x + eps/c
    assert abs(roots[0] - roots[1]) < 1e-4


@pytest.mark.long
def test_folds_of_orbits_homoclinic_to_a_cycle_have_errors():
    """c2c: the cycle is a saddle along the curve; a fold is where its manifolds are tangent."""
    loop = branches_of("c2c")["loop"]
    assert loop["kind"] == "connection"
    folds = [p for p in loop["points"] if p["type"] == "LP"]
    assert folds
    assert all(0.0 < p["error"] < 1e-6 for p in folds)
    assert max(loop["columns"]["multiplier"]) < 1.0 < min(loop["columns"]["multiplier2"])
