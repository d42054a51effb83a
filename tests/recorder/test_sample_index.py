from hydrohil.services.recorder.sample_index import IndexedSample, SampleIndex, sample_numbers
from hydrohil.shared.contract.messages import NO_TRIAL, Command, Sample
from tests.support.recorder_trial import received, trial


def samples(ticks: int = 5) -> list[Sample]:
    return [m.body for m in trial(ticks) if isinstance(m.body, Sample)]


def test_a_sample_of_a_trial_has_its_trial_time_and_one_outside_has_none():
    index = SampleIndex()
    outside, inside = samples()[0], samples()[-1]
    assert outside.tick == NO_TRIAL
    assert index.add(outside, 1).trial_time_ns is None
    assert index.add(inside, 2) == IndexedSample(inside.number, inside.trial_time_ns, 2) == index.newest


def test_what_never_came_has_a_number_and_no_time():
    assert SampleIndex().at(17) == IndexedSample(17, None, 0)


def test_the_index_keeps_as_many_samples_as_asked_and_no_more():
    index, every = SampleIndex(kept=3), samples()[-4:]
    for sample in every:
        index.add(sample, 1)
    assert [index.knows(s.number) for s in every] == [False, True, True, True]


def test_a_message_without_a_number_belongs_to_the_sample_it_echoes():
    command = received("controller/command", Command((1, 2, 3)), 0, echo=42)
    sample = received("plant/sample", samples()[0], 0, echo=42)
    assert sample_numbers([command]) == [42]
    assert sample_numbers([sample]) == [samples()[0].number]
    assert sample_numbers([]) == []
