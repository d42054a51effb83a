"""`hydrohil reproduce` in a cell, of which only the trips are here: the rest needs one."""

import pytest

from hydrohil.cell.session import Live
from hydrohil.reproduction import live as reproduce_live
from hydrohil.reproduction.plan import find_figure, groups


class Silent:
    """A bus on which nothing may be asked."""

    def ask(self, *request: object) -> None:
        raise AssertionError(f"asked {request}")


def test_after_a_trip_nothing_is_reset_and_nothing_else_is_played(monkeypatch: pytest.MonkeyPatch):
    seeds = []

    def tripping(bus: object, experiment: object, seed: int, *_: object, unqualified: bool) -> Live:
        seeds.append(seed)
        return Live(None, "", "force above its limit" if seed == 1 else "", {}, ())

    monkeypatch.setattr(reproduce_live, "run_live", tripping)
    chosen = groups((find_figure("fig-4-24"),))
    done = reproduce_live.reproduce_live(Silent(), chosen, 3, "real", lambda name, seed: None)  # type: ignore[arg-type]
    found = {one.job.seed: one.found[0] for one in done}
    assert seeds == [0, 1]
    assert "force above its limit" in found[1].tripped and found[1].gap == ""
    assert "not played" in found[2].gap and not any(verdict.holds for verdict in found[2].verdicts)
