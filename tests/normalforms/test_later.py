"""Errors that are computed when they are read."""

import json
from copy import deepcopy

from contin.normalforms.later import Later, stated
from contin.store.json_format import plain


def test_errors_are_computed_once_when_they_are_first_read_and_equal_what_they_are():
    calls = []

    def compute():
        calls.append(1)
        return {"a": 2.0}

    later = Later(compute)
    assert stated(later) is later
    assert calls == []
    assert later == {"a": 2.0}
    assert dict(later) == {"a": 2.0}
    assert later.get("b") is None
    assert len(calls) == 1


def test_they_go_into_files_and_copies_as_numbers():
    later = Later(lambda: {"a": 2.0})
    assert json.dumps(plain({"errors": later})) == '{"errors": {"a": 2.0}}'
    copied = deepcopy(later)
    assert type(copied) is dict
    assert copied == {"a": 2.0}
