"""What every test may count on: live cells report trips into a folder of the tests, and what they start hears Ctrl-C."""

import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

SCHEDULING = (os.sched_getscheduler(0), os.sched_getparam(0))
signal.signal(signal.SIGINT, signal.default_int_handler)  # in the background of a shell it is ignored, and inherited so


@pytest.fixture(scope="module", autouse=True)
def live_cells_write_into_a_folder_of_their_own(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[None]:
    if request.node.get_closest_marker("live") is None:
        yield
        return
    before = Path.cwd()
    os.chdir(tmp_path_factory.mktemp("live"))
    yield
    os.chdir(before)


@pytest.fixture(autouse=True)
def every_test_begins_with_the_scheduling_of_the_first() -> None:
    """A load sets it for every thread of its process, here that of the tests: the next one's children would inherit it."""
    if os.sched_getscheduler(0) != SCHEDULING[0]:
        os.sched_setscheduler(0, *SCHEDULING)
