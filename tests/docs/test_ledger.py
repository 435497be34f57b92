"""Every claim of the ledger: our number against the paper's, and the verdict that stands in the data.

A check that cannot fail checks nothing: each number that it expects is altered, one at a time, and the check must fail;
and our numbers must come from contin.
"""

import sys
from pathlib import Path

import numpy as np
import pytest

import contin
from tests.docs.test_pages import DOCS

sys.path.insert(0, str(DOCS / "metronomes"))
ledger = pytest.importorskip("ledger")
ENTRIES = ledger.entries()
PACKAGE = str(Path(contin.__file__).parent)


def calls_contin(name) -> bool:
    """Whether a function of contin takes part in the claim's numbers, which are computed here for the first time."""
    called = False

    def see(frame, event, _):
        nonlocal called
        if event == "call" and frame.f_code.co_filename.startswith(PACKAGE):
            called = True
            sys.setprofile(None)  # it slows everything down

    sys.setprofile(see)
    try:
        ledger.result(name)
    finally:
        sys.setprofile(None)
    return called


def altered(expected, tolerance):
    """The expected numbers or words with each of them altered in turn."""
    flat = np.asarray(expected, dtype=object).ravel()
    for k, value in enumerate(flat):
        other = flat.copy()
        if isinstance(value, str):
            other[k] = f"not {value}"
        elif isinstance(value, bool | np.bool_):
            other[k] = not value
        else:
            other[k] = value + 10.0 * tolerance * (abs(value) or 1.0)
        yield np.array(other.tolist()).reshape(np.shape(np.asarray(expected, dtype=object)))


@pytest.mark.parametrize("name", ENTRIES)
def test_the_verdict_follows_from_the_numbers_and_from_no_others(name):
    assert calls_contin(name), "our numbers do not come from contin"
    ours, own = ledger.result(name)
    assert ledger.holds(name), (ours, own)
    entry = ENTRIES[name]
    if entry["verdict"] == "confirmed":
        for other in altered(own[0], float(entry.get("tolerance", ledger.TOLERANCE))):
            assert not ledger.holds(name, printed=other), other
    for other in altered(own[1], ledger.RIGHT) if len(own) > 1 else ():
        assert not ledger.holds(name, right=other), other


def test_every_function_has_its_entry_and_every_entry_is_whole():
    assert set(ledger.CLAIMS) == set(ENTRIES)
    for name, entry in ENTRIES.items():
        assert entry["verdict"] in ledger.VERDICTS, name
        assert all(entry[key] for key in ("where", "says", "command")), name
        assert entry["verdict"] == "confirmed" or entry.get("ours"), f"{name}: what is right instead?"


def test_the_ledger_is_whole():
    """The statements of the paper and its supplement that can be computed: an independent reading counted 141."""
    assert len(ENTRIES) >= 141
