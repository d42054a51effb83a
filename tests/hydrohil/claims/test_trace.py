import numpy as np
import pytest

from hydrohil.claims.trace import Trace, load, rows, save, window

PERIOD_S = 4.5e-3


def standing(duration_s: float) -> Trace:
    """A rig that stands at zero, sampled every 4.5 ms, both ends included."""
    n = round(duration_s / PERIOD_S) + 1
    still = np.zeros((n, 3))
    tick = np.arange(n)
    return Trace(
        tick,
        tick * PERIOD_S,
        *(still.copy() for _ in range(7)),
        np.zeros(n),
        np.zeros(n),
        still.copy(),
        np.full(n, 2),
        np.zeros(n),
        np.zeros((n, 5), dtype=np.int64),
        np.zeros(n, dtype=np.int64),
        np.full((n, 3), 2048),
    )


def link(values: np.ndarray, number: int) -> np.ndarray:
    """Values of one link (or axis), the other two at zero."""
    table = np.zeros((len(values), 3))
    table[:, number - 1] = values
    return table


def test_a_saved_trace_is_read_back_bit_for_bit(tmp_path):
    trace = standing(1.0)._replace(force_n=np.random.default_rng(1).normal(size=len(standing(1.0).t_s)))
    save(trace, tmp_path / "trial")
    again = load(tmp_path / "trial")
    for name, column, other in zip(Trace._fields, trace, again, strict=True):
        assert np.array_equal(column, other) and column.dtype == other.dtype, name


def test_a_file_without_a_column_is_refused_by_name(tmp_path):
    columns = standing(0.1)._asdict()
    del columns["force_n"]
    np.savez(tmp_path / "trial.npz", **columns)
    with pytest.raises(ValueError, match="no column force_n"):
        load(tmp_path / "trial.npz")


def test_a_window_includes_both_ends_and_nothing_beyond():
    trace = standing(1.0)
    start_s, end_s = trace.t_s[10], trace.t_s[20]
    assert window(trace, start_s, end_s).tick.tolist() == list(range(10, 21))
    assert window(trace, np.nextafter(start_s, 1.0), np.nextafter(end_s, 0.0)).tick.tolist() == list(range(11, 20))


def test_chosen_rows_are_taken_from_every_column():
    trace = standing(1.0)
    chosen = rows(trace, trace.tick % 2 == 0)
    assert {len(column) for column in chosen} == {len(trace.tick[::2])}
