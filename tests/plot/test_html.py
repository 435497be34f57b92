"""The interactive page: one file, no network, names are data and never markup."""

import json
import re

from contin.plot.html import html_page
from contin.plot.series import from_branches
from tests.plot.sample import bautin, branch, hysteresis


def data_of(page):
    [text] = re.findall(r'<script id="data" type="application/json">(.*?)</script>', page, re.S)
    return json.loads(text)


def test_the_page_loads_nothing_and_forbids_loading():
    page = html_page(from_branches(bautin()), title="b")
    addresses = set(re.findall(r"https?://[^\"'\s<>]+", page))
    assert addresses == {"http://www.w3.org/2000/svg"}  # the name of the SVG namespace, never fetched
    assert "default-src 'none'" in page
    assert not re.search(r"<(link|img|iframe|script[^>]+src)\b", page)


def test_names_from_files_cannot_become_markup():
    evil = '</script><script>alert("x")</script><!--'
    page = html_page(
        from_branches([branch(evil, {"p": [0.0, 1.0], "x": [0.0, 1.0], "stable": [True, True]})]), title=evil
    )
    assert page.count("<script") == 2  # the data and the viewer
    assert data_of(page)["title"] == evil
    assert data_of(page)["branches"][0]["name"] == evil


def test_the_page_holds_every_row_mark_and_stability():
    [states] = data_of(html_page(from_branches(hysteresis()), title="s"))["branches"]
    assert len(states["columns"]["x"]) == len(states["columns"]["p"]) == 113
    assert len(states["stable"]) == 112
    assert [mark["label"] for mark in states["marks"]] == ["LP1", "LP2"]
    turns = [i for i in range(1, 112) if states["stable"][i] != states["stable"][i - 1]]
    assert turns == [mark["row"] for mark in states["marks"]]


def test_gaps_are_null_and_orbits_have_both_strands():
    page = data_of(html_page(from_branches(bautin()), title="b"))
    assert {"x.min", "x.max", "period"} <= set(page["branches"][1]["columns"])
    assert page["views"] == [{"x": "p", "y": "x"}, {"x": "p", "y": "q"}]
    gap = data_of(html_page(from_branches([branch("g", {"p": [0.0, 1.0], "x": [float("nan"), 1.0]})]), title="g"))
    assert gap["branches"][0]["columns"]["x"] == [None, 1.0]
