"""What the plant counts."""

from hydrohil.services.plant.counters import _KEPT, Counters


def test_the_worst_wake_up_is_remembered_when_its_percentiles_have_left_it_behind():
    counters = Counters()
    counters.woke(9_000_000, shifts=True)
    for _ in range(_KEPT):
        counters.woke(50_000, shifts=False)
    summary = counters.summary()
    assert summary["lateness_us"] == {"p50": 50.0, "p99": 50.0, "max": 50.0}
    assert (summary["worst_lateness_us"], summary["grid_shifts"]) == (9000.0, 1)
    counters.reset()
    assert counters.summary()["worst_lateness_us"] == 0.0
