"""Families of orbits that are narrow in the metric: past their top (a pitchfork of cycles) nothing is silent.

A circle of radius 1 beside x' = atan(k (x - c)) - a (x - c): the family with x off c meets that with x = c at a = k.
"""

import pytest

import contin


@pytest.mark.parametrize("c", [0, 1])
@pytest.mark.parametrize(("k", "beyond"), [(4.0, 0.3), (30.0, 0.01), (300.0, 0.01), (300.0, 0.3)])
def test_the_top_of_a_narrow_family_is_labelled_or_told(k, beyond, c):
    parts = {
        "name": "beside", "states": {"u": 1.0, "v": 0.0, "x": 1.0}, "parameters": {"a": 0.8},
        "equations": {
            "u": "u - v - u*(u^2 + v^2)", "v": "u + v - v*(u^2 + v^2)", "x": f"atan({k}*(x - {c})) - a*(x - {c})",
        },
    }  # fmt: skip
    orbit = contin.periodic_orbit(contin.load(parts), {"u": 1.0, "v": 0.0, "x": 1.5 + c})
    family = contin.continuation(orbit, "a", (0.4, k * (1.0 + beyond)))
    labels = [(p.type, p.values["a"], p.error) for p in family.points]
    assert all(type_ == "BPC" and abs(a - k) <= error + 1e-13 * k for type_, a, error in labels)
    assert labels or (family.unexplained and "gone over" in " ".join(family.notes))
