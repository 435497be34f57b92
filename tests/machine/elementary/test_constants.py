"""The committed tables are what mpmath gives."""

from contin.machine.elementary import constants
from tests.machine.elementary.make_constants import constants as made


def test_constants_are_those_of_mpmath():
    for name, value in made().items():
        assert getattr(constants, name) == value, name
