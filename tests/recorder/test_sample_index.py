from hydrohil.services.recorder.sample_index import Place, SampleIndex, sample_numbers
from hydrohil.shared.contract.messages import NO_TRIAL, Command, Sample
from tests.support.recorder_trial import received, trial


def samples(ticks: int = 5) -> list[Sample]:
    return [m.body for m in trial(ticks) if isinstance(m.body, Sample)]


def test_a_sample_of_a_trial_has_its_trial_time_and_one_outside_has_none():
    places = SampleIndex()
    outside, inside = samples()[0], samples()[-1]
    assert outside.tick == NO_TRIAL
    assert places.add(outside, 1).trial_time_ns is None
    assert places.add(inside, 2) == Place(inside.number, inside.trial_time_ns, 2) == places.newest


def test_what_never_came_has_a_number_and_no_time():
    assert SampleIndex().at(17) == Place(17, None, 0)


def test_the_map_keeps_as_many_as_it_was_told_and_no_more():
    places, every = SampleIndex(kept=3), samples()[-4:]
    for sample in every:
        places.add(sample, 1)
    assert [places.knows(s.number) for s in every] == [False, True, True, True]


def test_a_message_without_a_number_belongs_to_the_sample_it_echoes():
    command = received("controller/command", Command((1, 2, 3)), 0, echo=42)
    sample = received("plant/sample", samples()[0], 0, echo=42)
    assert sample_numbers([command]) == [42]
    assert sample_numbers([sample]) == [samples()[0].number]
    assert sample_numbers([]) == []
