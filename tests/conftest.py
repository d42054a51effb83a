"""What every test may count on: live cells report trips into a folder of the tests, and what they start hears Ctrl-C."""

import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

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
