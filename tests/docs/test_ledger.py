"""Every claim of the ledger: our number against the paper's, and the verdict that stands in the data."""

import sys

import pytest

from tests.docs.test_pages import DOCS

sys.path.insert(0, str(DOCS / "metronomes"))
ledger = pytest.importorskip("ledger")
ENTRIES = ledger.entries()


@pytest.mark.parametrize("name", ENTRIES)
def test_the_verdict_follows_from_the_numbers(name):
    """confirmed: our numbers are the paper's; differs or slip: they are not."""
    ours, printed = ledger.CLAIMS[name]()
    entry = ENTRIES[name]
    agrees = ledger.agree(ours, printed, float(entry.get("tolerance", 1e-7)))
    assert agrees == (entry["verdict"] == "confirmed"), (ours, printed)


def test_every_function_has_its_entry_and_every_entry_is_whole():
    assert set(ledger.CLAIMS) == set(ENTRIES)
    for name, entry in ENTRIES.items():
        assert entry["verdict"] in ledger.VERDICTS, name
        assert all(entry[key] for key in ("where", "says", "command")), name
        assert entry["verdict"] == "confirmed" or entry.get("ours"), f"{name}: what is right instead?"
