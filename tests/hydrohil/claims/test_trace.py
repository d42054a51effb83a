import numpy as np

from hydrohil.claims.trace import Trace, rows, window

PERIOD_S = 4.5e-3


def standing(duration_s: float) -> Trace:
    """A rig that stands at zero, sampled every 4.5 ms, both ends included."""
    n = round(duration_s / PERIOD_S) + 1
    tick = np.arange(n)
    of_links = ("q", "q_set", "qd", "qd_set", "x_m", "x_set_m", "x_nominal_m", "current_a")
    return Trace(
        tick=tick,
        t_s=tick * PERIOD_S,
        force_n=np.zeros(n),
        force_set_n=np.zeros(n),
        mode=np.full(n, 2),
        sample_age_s=np.zeros(n),
        encoder_counts=np.zeros((n, 5), dtype=np.int64),
        force_counts=np.zeros(n, dtype=np.int64),
        dac_counts=np.full((n, 3), 2048),
        **{name: np.zeros((n, 3)) for name in of_links},
    )


def link(values: np.ndarray, number: int) -> np.ndarray:
    """Values of one link (or axis), the other two at zero."""
    table = np.zeros((len(values), 3))
    table[:, number - 1] = values
    return table


def test_a_window_includes_both_ends_and_nothing_beyond():
    trace = standing(1.0)
    start_s, end_s = trace.t_s[10], trace.t_s[20]
    assert window(trace, start_s, end_s).tick.tolist() == list(range(10, 21))
    assert window(trace, np.nextafter(start_s, 1.0), np.nextafter(end_s, 0.0)).tick.tolist() == list(range(11, 20))


def test_chosen_rows_are_taken_from_every_column():
    trace = standing(1.0)
    chosen = rows(trace, trace.tick % 2 == 0)
    assert {len(column) for column in chosen} == {len(trace.tick[::2])}
