"""What every test may count on: a live cell writes its trip reports into a folder of the tests, not among the user's."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest


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
