"""Which cell a run finds: links come up one by one, and go one by one."""

import pytest

from hydrohil.cell import connection

ALL = {"plant", "controller", "supervisor"}


class Network:
    """A bus that hears of other services at each look; of the last for good."""

    def __init__(self, *looks: set[str]):
        self.looks = list(looks)

    def alive(self) -> set[str]:
        return self.looks.pop(0) if len(self.looks) > 1 else self.looks[0]


@pytest.fixture(autouse=True)
def fast(monkeypatch):
    monkeypatch.setattr(connection, "_POLL_S", 0.001)
    monkeypatch.setattr(connection, "_LINKS_S", 0.05)
    monkeypatch.setattr(connection, "_PARTIAL_S", 0.1)


@pytest.mark.parametrize(
    ("looks", "found"),
    [
        ([set()], set()),
        ([ALL | {"recorder"}], ALL),
        ([{"plant"}, {"plant", "supervisor"}, ALL], ALL),
        ([{"plant", "supervisor"}, {"plant"}, set()], set()),
        ([{"plant", "supervisor"}], {"plant", "supervisor"}),
    ],
    ids=["no cell", "a cell", "links come up", "a cell ends", "a service is missing for good"],
)
def test_what_is_found_is_what_stays(looks, found):
    assert connection.find_services(Network(*looks)) == found  # type: ignore[arg-type]


def test_a_cell_on_other_hosts_may_take_longer_to_be_found():
    late = [set()] * 60 + [ALL]  # a look a millisecond, at best
    assert connection.find_services(Network(*late), patience_s=0.05) == set()  # type: ignore[arg-type]
    assert connection.find_services(Network(*late), patience_s=10.0) == ALL  # type: ignore[arg-type]
