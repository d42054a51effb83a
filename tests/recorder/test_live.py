import socket
import threading

import numpy as np
import pytest

from hydrohil.services.recorder import live
from hydrohil.services.recorder.drawing import Drawn, draw
from hydrohil.services.recorder.live import Live
from hydrohil.services.recorder.rows import Rows, times_of
from hydrohil.services.recorder.sample_index import IndexedSample


def drawn() -> Drawn:
    return draw(Rows("figure/force", "scalars", times_of([IndexedSample(1, 0, 0)]), np.zeros((1, 3))))


@pytest.fixture
def port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def test_a_port_in_use_is_named(port: int):
    with socket.socket() as other:
        other.bind(("127.0.0.1", port))
        other.listen()
        with pytest.raises(OSError, match=f"port {port}"):
            Live(port)


def test_a_viewer_that_hangs_costs_the_oldest_rows_and_no_waiting(port: int, monkeypatch: pytest.MonkeyPatch):
    hung, taken = threading.Event(), threading.Event()

    def hang(stream: object, rows: Drawn) -> None:
        taken.set()
        hung.wait()

    monkeypatch.setattr(live, "send", hang)
    with Live(port) as view:
        view.send(drawn())
        assert taken.wait(10.0)  # the feeding thread now hangs with one batch in its hands
        for _ in range(live.KEPT_BATCHES):
            view.send(drawn())
        assert view.dropped == 0
        view.send(drawn())
        assert view.dropped == 1
        hung.set()


def test_everything_queued_is_fed_before_it_closes(port: int, monkeypatch: pytest.MonkeyPatch):
    fed: list[Drawn] = []
    monkeypatch.setattr(live, "send", lambda stream, rows: fed.append(rows))
    with Live(port) as view:
        for _ in range(100):
            view.send(drawn())
    assert len(fed) == 100


def test_the_layout_of_the_live_view_is_accepted_and_rows_flow(port: int):
    with Live(port) as view:
        view.send(drawn())
    assert view.dropped == 0
