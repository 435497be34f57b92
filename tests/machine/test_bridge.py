"""Calls of machine code from Python: both ways to pack arguments agree, and refuse what is not declared."""

import numpy as np
import pytest

from contin.kernels.dense import lu_factor, lu_solve
from contin.machine import bridge
from contin.machine.engine import ENGINE

PLAN = bridge.Plan(
    bridge.codes_of([(bridge.REAL,), (bridge.INTEGER,), (bridge.TRUTH,), bridge.array_codes("float64", 2),
                     bridge.codes_of([bridge.array_codes("int64", 1), (bridge.REAL,)])]),
    12,
    (bridge.INTEGER, bridge.REAL, bridge.TRUTH),
)  # fmt: skip
TEXT = """
define void @echo_for_this_test(ptr %words) {
  store i64 0, ptr %words
  %x = getelementptr i64, ptr %words, i64 4
  %i = getelementptr i64, ptr %words, i64 5
  %b = getelementptr i64, ptr %words, i64 6
  %stride = getelementptr i64, ptr %words, i64 10
  %y = getelementptr i64, ptr %words, i64 15
  %r1 = getelementptr i64, ptr %words, i64 1
  %r2 = getelementptr i64, ptr %words, i64 2
  %r3 = getelementptr i64, ptr %words, i64 3
  %iv = load i64, ptr %i
  %sv = load i64, ptr %stride
  %sum = add i64 %iv, %sv
  store i64 %sum, ptr %r1
  %xv = load double, ptr %x
  %yv = load double, ptr %y
  %total = fadd double %xv, %yv
  store double %total, ptr %r2
  %bv = load i64, ptr %b
  store i64 %bv, ptr %r3
  ret void
}
"""


@pytest.fixture(scope="module")
def calls():
    ENGINE.add_text(TEXT, optimise=False)
    entry = ENGINE.address("echo_for_this_test")
    return bridge.make_call("echo", entry, PLAN), bridge.slow_call(entry, PLAN)


def test_both_ways_pack_the_same_words_and_make_the_same_results(calls):
    for call in calls:
        got = call(1.5, -7, True, np.zeros((3, 5)), (np.zeros(4, np.int64), 2.25))
        assert got == (33, 3.75, True)  # -7 + 40 bytes a row
        assert [type(value) for value in got] == [int, float, bool]
        assert call(1, np.int64(2), 0, np.zeros((1, 1)), (np.zeros(0, np.int64), np.float64(-1))) == (10, 0.0, False)


GOOD = (1.5, -7, True, np.zeros((3, 5)), (np.zeros(4, np.int64), 2.25))


@pytest.mark.parametrize(
    ("place", "wrong"),
    [
        (0, "1.5"),
        (1, 2.5),
        (3, np.zeros(3)),
        (3, np.zeros((3, 5), np.float32)),
        (3, np.zeros((3, 10))[:, ::2]),
        (3, np.zeros((3, 5), ">f8")),
        (3, [[1.0]]),
        (4, (np.zeros(4), 2.25)),
        (4, (np.zeros(4, np.int64),)),
        (4, [np.zeros(4, np.int64), 2.25]),
    ],
)
def test_what_the_signature_does_not_state_is_refused(calls, place, wrong):
    arguments = [*GOOD]
    arguments[place] = wrong
    for call in calls:
        with pytest.raises(TypeError):
            call(*arguments)


def test_a_read_only_array_is_refused_since_a_kernel_may_write_into_it(calls):
    fixed = np.zeros((3, 5))
    fixed.flags.writeable = False
    for call in calls:
        with pytest.raises(TypeError, match="declared type"):
            call(1.5, -7, True, fixed, GOOD[4])


def test_numbers_of_arguments_are_checked(calls):
    for call in calls:
        with pytest.raises(TypeError):
            call(*GOOD[:-1])


def test_a_kernel_solves_and_says_which_of_its_arguments_does_not_fit():
    a = np.array([[2.0, 1.0], [1.0, 3.0]])
    x, pivots = np.array([3.0, 4.0]), np.zeros(2, np.int64)
    assert lu_factor(a, pivots) == 1
    lu_solve(a, pivots, x)
    np.testing.assert_allclose(x, [1.0, 1.0], atol=1e-15)
    with pytest.raises(TypeError, match=r"dense.lu_solve\(f2, i1, f1\) got .*array of int64, 1 axes"):
        lu_solve(a, pivots, np.array([3, 4]))


def test_the_layout_of_arrays_is_the_one_that_the_bridge_reads():
    assert bridge.layout_is_known()  # on CPython with a global lock; elsewhere calls are slower, and this test tells
