"""Tests of the command compare what it says word for word: the line about a machine's first run is over before them."""

import pytest


@pytest.fixture(scope="session", autouse=True)
def _compiled():
    from tests.warm import warm_up

    warm_up()
