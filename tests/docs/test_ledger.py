"""Every claim of the ledger: our number against the paper's, and the verdict that stands in the data.

A check that cannot fail checks nothing: each number that it expects is altered, one at a time, and the check must fail;
and our numbers must come from contin.
"""

import sys
from pathlib import Path

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


# A third of a second and more: every day the page of the ledger computes them, and asserts that their verdicts follow.
DEAR = """
    a-kick-from-anti-phase-quenches average-in-general-amplitude averaging-in-phase-asks-for-eps-mu-only
    case-iii-has-states-if-wide figure-3b figure-4-blue figure-4-blue-only figure-4-green figure-4-red
    figure-4-white figure-5b flow-i flow-ii flow-iii fold-of-the-in-phase-orbit in-phase-is-quenched-earlier
    linear-rational-solutions mu-c-approaches-the-average mu-c-at-second-order no-synchrony-beyond-the-fold
    oscillation-stops-i-and-ii rest-of-the-pair-is-stable rest-stays-on-the-way-down solutions-ii
    stable-and-unstable-i stable-and-unstable-i-wide stable-and-unstable-iii sweep-i-agrees sweep-ii-agrees
    sweep-linear-rational-agrees two-states-i-narrow two-states-i-only-if-wide
""".split()


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.long if name in DEAR else ()) for name in ENTRIES]
)
def test_the_verdict_follows_from_the_numbers_and_from_no_others(name):
    assert calls_contin(name), "our numbers do not come from contin"
    ledger.assert_follows(name)


def test_every_function_has_its_entry_and_every_entry_is_whole():
    assert set(ledger.CLAIMS) == set(ENTRIES)
    for name, entry in ENTRIES.items():
        assert entry["verdict"] in ledger.VERDICTS, name
        assert all(entry[key] for key in ("where", "says", "command")), name
        assert entry["verdict"] == "confirmed" or entry.get("ours"), f"{name}: what is right instead?"


def test_the_ledger_is_whole():
    """The statements of the paper and its supplement that can be computed: an independent reading counted 141."""
    assert len(ENTRIES) >= 141
