import math
from itertools import groupby

import numpy as np
import pytest

from hydrohil.services.recorder.rows import Rows
from hydrohil.services.recorder.scene import FORCE, TIP
from hydrohil.services.recorder.topic_rows import ANSWER_LATENCY
from hydrohil.services.recorder.writer import Writer
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.messages import Command, ControllerState, InboxCounts, LinkStats, Permit, Sample
from hydrohil.shared.machine.unimate import UNIMATE
from tests.support.recorder_trial import FIRST_NUMBER, PERIOD_NS, TARE_TICKS, exact, received, trial


def write(messages: list[Received], batch_rows: int = 50) -> list[Rows]:
    written: list[Rows] = []
    writer = Writer(written.append, batch_rows)
    for message in messages:
        writer.take(message)
    writer.flush(everything=True)
    return written


def of(written: list[Rows], entity: str) -> list[Rows]:
    return [rows for rows in written if rows.entity == entity and rows.times is not None]


def matrix(written: list[Rows], entity: str) -> np.ndarray:
    return np.concatenate([rows.values for rows in of(written, entity)])


@pytest.mark.parametrize(
    "topic", ["plant/sample", "plant/ground_truth", "controller/state", "controller/command", "supervisor/permit"]
)
def test_every_message_is_written_once_in_order_and_exactly(topic: str):
    messages = list(trial(150))
    written = write(messages)
    expected = exact([m for m in messages if m.topic == topic])
    np.testing.assert_array_equal(matrix(written, f"topic/{topic}"), expected)


def test_no_batch_mixes_rows_inside_and_outside_a_trial():
    written = write(list(trial(20)))
    batches = of(written, "topic/plant/sample")
    outside = [rows for rows in batches if rows.times.trial_ns is None]
    inside = [rows for rows in batches if rows.times.trial_ns is not None]
    assert sum(len(rows.values) for rows in outside) == 30
    times = np.concatenate([rows.times.trial_ns for rows in inside])
    np.testing.assert_array_equal(times, PERIOD_NS * np.arange(-TARE_TICKS, 20))


def placed(written: list[Rows], entity: str) -> list[tuple[int, int]]:
    inside = [rows.times for rows in of(written, entity) if rows.times.trial_ns is not None]
    return [(n, t) for times in inside for n, t in zip(times.samples, times.trial_ns, strict=True)]


@pytest.mark.parametrize("topic", ["plant/ground_truth", "controller/command"])
def test_a_message_that_overtakes_its_sample_waits_for_it(topic: str):
    messages = list(trial(100))
    overtaken = sorted(messages, key=lambda m: m.header.seq + (0.5 if m.topic == "plant/sample" else 0.0))
    times = placed(write(overtaken, 7), f"topic/{topic}")
    assert times == placed(write(messages, 7), f"topic/{topic}")
    assert len(times) == 100 + TARE_TICKS


def test_those_that_wait_for_their_sample_are_looked_at_once_a_batch(monkeypatch: pytest.MonkeyPatch):
    looks = []
    monkeypatch.setattr(Writer, "_flush_topic", lambda _writer, topic, everything: looks.append((topic, everything)))
    writer = Writer(lambda _rows: None, batch_rows=10)
    for seq in range(25):
        writer.take(received("controller/command", Command((2048,) * 3), seq, 1000 + seq))
    assert looks == [("controller/command", False), ("controller/command", True)]


def test_messages_taken_together_are_written_as_those_taken_one_by_one():
    messages = sorted(trial(60, trip_tick=40), key=lambda m: m.topic != "plant/sample")
    written: list[Rows] = []
    writer = Writer(written.append, 50)
    for _, run in groupby(messages, lambda m: m.topic):
        writer.take(*run)
    writer.flush(everything=True)
    for topic in ("plant/sample", "controller/command", "supervisor/permit", "plant/ground_truth"):
        entity = f"topic/{topic}"
        np.testing.assert_array_equal(matrix(written, entity), matrix(write(messages), entity))
        assert placed(written, entity) == placed(write(messages), entity)


def test_counters_are_written_several_at_a_time_and_none_is_left_behind():
    written: list[Rows] = []
    writer = Writer(written.append, count_rows=3)
    for message in trial(1, outside=2):
        writer.take(message)
        if isinstance(message.body, Sample):
            writer.scalar("missing/plant/sample/plant", float(message.body.number))
    before = len(of(written, "missing/plant/sample/plant"))
    writer.flush()
    assert len(of(written, "missing/plant/sample/plant")) == before  # a slow batch waits until it is full
    writer.flush(everything=True)
    rows = of(written, "missing/plant/sample/plant")
    np.testing.assert_array_equal(np.concatenate([r.values[:, 0] for r in rows]), FIRST_NUMBER + np.arange(3 + TARE_TICKS))
    assert {len(r.values) for r in rows} <= {1, 2, 3}
    assert all((r.times.trial_ns is None) == (r.times.samples[0] < FIRST_NUMBER + 2) for r in rows)


def test_what_answers_a_sample_that_never_came_is_written_without_a_time():
    messages = [m for m in trial(50) if not (isinstance(m.body, Sample) and m.header.seq == 500)]
    written = write(messages)
    orphan = [
        r for r in of(written, "topic/controller/command") if r.times.trial_ns is None and FIRST_NUMBER + 500 in r.times.samples
    ]
    assert len(orphan) == 1 and len(orphan[0].values) == 1
    latency = matrix(written, ANSWER_LATENCY)
    assert np.isnan(latency).sum() == 1
    assert sum(len(r.values) for r in of(written, "topic/controller/command")) == 50 + TARE_TICKS + 30


def test_the_answer_latency_is_the_difference_of_the_two_arrivals():
    written: list[Rows] = []
    writer = Writer(written.append)
    sample = next(m for m in trial(1) if isinstance(m.body, Sample))
    writer.take(sample._replace(arrival_ns=5_000_000))
    writer.take(received("controller/command", Command((2048,) * 3), 0, sample.body.number, arrival_ns=7_250_000))
    writer.flush()
    assert matrix(written, ANSWER_LATENCY).tolist() == [[2.25]]


def test_states_are_written_on_change_and_again_where_the_trial_begins():
    written = write(list(trial(60, trip_tick=40)))
    states = [(text, rows.times.trial_ns is not None) for rows in of(written, "state/1_supervisor") for text in rows.values]
    assert states == [("disarmed", False), ("armed", True), ("running", True), ("tripped", True)]


def test_joints_follow_the_encoder_tables_and_the_scene_is_thinned():
    messages = list(trial(400))
    written = write(messages)
    joint = matrix(written, "scene/joint/down_up")
    shown = [m.body for m in messages if isinstance(m.body, Sample) and m.body.number % 4 == 0]
    channel = UNIMATE.encoders[1]
    np.testing.assert_allclose(joint, [s.encoder_counts[1] * channel.scale + channel.offset for s in shown], rtol=0, atol=1e-12)


def test_the_force_arrow_ends_in_the_tip_and_points_where_the_plate_pushes():
    written = write(list(trial(900)))
    arrows, tip = matrix(written, FORCE), matrix(written, TIP)
    np.testing.assert_allclose(arrows.sum(1), tip, atol=1e-12)
    assert arrows[:, 1, 2].max() > 0.05
    assert (arrows[:, 1, :2] == 0.0).all() and (arrows[:, 1, 2] >= 0.0).all()


def test_an_unknown_position_is_kept_in_the_rows_and_left_out_of_the_scene():
    unknown = (math.nan, math.nan, math.nan)
    messages = [m._replace(body=m.body._replace(x_m=unknown)) if isinstance(m.body, ControllerState) else m for m in trial(30)]
    written = write(messages)
    assert not of(written, TIP)
    assert np.isnan(matrix(written, "figure/position/z")[:, 2]).all()


def test_another_plant_counts_its_samples_anew_and_the_old_ones_are_forgotten():
    first, again = (
        list(trial(10)),
        [m._replace(header=m.header._replace(epoch=99)) for m in trial(20) if isinstance(m.body, Sample)],
    )
    written = write(first + again)
    assert len(matrix(written, "topic/plant/sample")) == 2 * (30 + TARE_TICKS) + 10 + 20


def test_another_plant_in_the_middle_of_what_is_taken_together_moves_no_sample_to_another_time():
    first = [m for m in trial(10) if isinstance(m.body, Sample)]
    again = [m._replace(header=m.header._replace(epoch=99), body=m.body._replace(trial_time_ns=7)) for m in first]
    written: list[Rows] = []
    writer = Writer(written.append)
    writer.take(*first, *again)
    writer.flush(everything=True)
    assert placed(written, "topic/plant/sample") == placed(write(first + again), "topic/plant/sample")
    assert len(placed(written, "topic/plant/sample")) == 2 * (10 + TARE_TICKS)


def test_names_are_written_once_and_again_in_the_next_recording():
    written: list[Rows] = []
    writer = Writer(written.append)
    for message in trial(10):
        writer.take(message)
    writer.begin_recording()
    for message in trial(10):
        writer.take(message)
    writer.flush(everything=True)
    assert sum(rows.kind == "names" and rows.entity == "topic/plant/sample" for rows in written) == 2


def test_a_message_with_nan_reaches_the_rows_unchanged():
    permit = next(m for m in trial(1) if isinstance(m.body, Permit))
    written = write([permit._replace(body=permit.body._replace(measured=math.nan))])
    rows = matrix(written, "topic/supervisor/permit")
    assert np.isnan(rows).sum() == 1


def test_the_counts_of_each_inbox_are_a_row_at_their_sample_and_a_line_where_they_grow():
    inbox = InboxCounts("controller/command", 100, *(0,) * 13)
    reports = [(1000, inbox), (1222, inbox._replace(accepted=322, crc=2))]
    messages = list(trial(300))
    for seq, (number, counts) in enumerate(reports):
        messages.append(received("plant/link_stats", LinkStats(number, (counts,)), seq, number))
    written = write(messages)
    entity = "link_stats/plant/controller/command"
    np.testing.assert_array_equal(matrix(written, entity), [inbox[1:], reports[1][1][1:]])
    assert [rows.times.samples.tolist() for rows in of(written, entity)] == [[1000], [1222]]
    assert [rows.values for rows in of(written, "log/plant")] == [[("WARN", "plant of controller/command: 2 crc")]]
    assert [rows.values for rows in written if rows.entity == entity and rows.kind == "names"] == [InboxCounts._fields[1:]]


def test_a_fourth_late_answer_in_a_row_is_one_warning():
    def worse(message):
        late = isinstance(message.body, Sample) and 10 <= message.body.tick < 16
        return message._replace(body=message.body._replace(command_late_substeps=3)) if late else message

    lines = [rows.values for rows in of(write([worse(m) for m in trial(30)]), "log/plant")]
    fourth = FIRST_NUMBER + 30 + TARE_TICKS + 13
    assert lines == [[("WARN", f"4 answers in a row were late or missing, up to sample {fourth}")]]
