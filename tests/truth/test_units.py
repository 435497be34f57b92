"""Every verb in other units of states, time and parameters: the same labels, stability, ends and numbers.

Short: everything in extreme units at once. Long (`-m long`): each alone, and all pairs; the table is in the ledger.
"""

from __future__ import annotations

import os
from collections import Counter
from pathlib import Path

import pytest

import contin
from tests.truth.further_unit_checks import FURTHER
from tests.truth.ledger import Ledger
from tests.truth.unit_checks import CHECKS, SLOW
from tests.truth.unit_models import TWISTED
from tests.truth.units import LONG, ORDINARY, ROUGH, SMOOTH, Units, Verbs, compare

EXTREME = (Units(1e15, 1e12, 1e3), Units(1e-9, 1e-9, 1e12))
MIXED = Units(1e-6, 1e12, 1e-9, mixed=True)
"""Neighbouring states 1e12 apart."""
ALL = CHECKS | FURTHER
_ordinary = {}


def differences(name: str, units: Units) -> list[str]:
    model, check = ALL[name]
    if name not in _ordinary:
        _ordinary[name] = check(Verbs(model, ORDINARY))
    rel = ROUGH if "sweep" in name or "scan" in name else SMOOTH
    return compare(_ordinary[name], check(Verbs(model, units)), {}, rel)


@pytest.mark.parametrize("name", [n for n in ALL if n not in SLOW])
def test_extreme_units_change_nothing(name):
    units = EXTREME[list(ALL).index(name) % 2]  # the long version takes both, and each alone
    assert {str(units): found for units in [units] if (found := differences(name, units))} == {}


def test_mixed_units_change_nothing_in_an_algebraic_system():
    assert differences("an algebraic system", MIXED) == []


@pytest.mark.parametrize("units", [ORDINARY, *EXTREME], ids=str)
def test_the_stated_error_of_a_doubling_is_a_small_part_of_the_range_in_all_units(units):
    verbs = Verbs(TWISTED, units)
    family = contin.continuation(contin.periodic_orbit(verbs.model), "p")
    (point,) = family.points
    place, error = (float(v) * verbs.unit("p") for v in (point.values["p"], point.error))
    assert (point.type, abs(place) <= error, error < 1e-8) == ("PD", True, True)


@pytest.mark.long
def test_units_change_nothing(tmp_path):
    """Writes its table to the folder CONTIN_TRUTH_TABLES, where that is set."""
    ledger = Ledger()
    for name in ALL:
        counts = ledger.counts.setdefault(name, Counter())
        for units in LONG:
            counts["systems"] += 1
            try:
                found = differences(name, units)
            except (contin.ContinError, KeyError) as error:
                found = [f"{type(error).__name__}: {error}"]
            counts["expected"] += 1
            counts["wrong" if found else "found"] += 1
            ledger.complaints += [f"{name} {units}: wrong: {text}" for text in found]
    folder = Path(os.environ.get("CONTIN_TRUTH_TABLES", tmp_path))
    ledger.write(folder / "units.md", {"machine": "tests/truth/test_units.py", "version": contin.__version__})
    ledger.assert_clean()
