"""What tests cost: `CONTIN_TEST_COST=20 pytest ...` tells the processor seconds of rooms and of the 20 dearest tests.

Seconds of a clock tell who else is at work. Processes that a test starts and waits for are counted; a fixture counts
for the test that asks first. Memory is the largest that a process of the tests ever had.
"""

from __future__ import annotations

import resource
from collections import Counter, defaultdict
from collections.abc import Iterator

import pytest

_began = {"at": 0.0}
_tests: list[tuple[float, str]] = []
_largest = {"MB": 0}


def processor_seconds() -> float:
    """Of this process and of those that it has waited for."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    _began["at"] = processor_seconds()
    return (yield)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_teardown(item: pytest.Item) -> None:
    """Where tests run; the process that reports may be another one."""
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
    item.user_properties.append(("cost", (processor_seconds() - _began["at"], memory)))


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    if report.when == "teardown":
        for seconds, memory in (value for name, value in report.user_properties if name == "cost"):
            _tests.append((seconds, report.nodeid))
            _largest["MB"] = max(_largest["MB"], memory)


def summary(most: int) -> Iterator[str]:
    """Lines: rooms, then the dearest tests."""
    rooms: dict[str, float] = defaultdict(float)
    counts = Counter(nodeid.split("/")[1] for _, nodeid in _tests)
    for seconds, nodeid in _tests:
        rooms[nodeid.split("/")[1]] += seconds
    whole = sum(rooms.values())
    yield f"{whole:.1f} processor seconds of {len(_tests)} tests, at most {_largest['MB']} MB in a process"
    for room, seconds in sorted(rooms.items(), key=lambda pair: -pair[1]):
        yield f"{seconds:9.1f} {counts[room]:5} {room}"
    for seconds, nodeid in sorted(_tests, reverse=True)[:most]:
        yield f"{seconds:9.2f} {nodeid}"
