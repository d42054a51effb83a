from hydrohil.services.recorder.link_counts import Link, LinkCounts
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.messages import Command
from tests.support.recorder_trial import received

COMMANDS = Link("controller/command", "controller")


def commands(*numbers: int) -> list[Received]:
    return [received(COMMANDS.topic, Command((2048,) * 3), seq, 1000 + seq) for seq in numbers]


def test_several_gaps_of_a_link_between_two_calls_are_one_line_with_their_sum():
    links = LinkCounts()
    links.take(commands(0, 1, 4))
    links.take(commands(7))
    (event,) = links.gap_events()
    assert "4 missing on controller/command" in event.text
    assert links.gap_events() == []


def test_messages_without_a_gap_make_no_line():
    links = LinkCounts()
    links.take(commands(0, 1, 2))
    links.take(commands(3))
    assert links.gap_events() == []
    assert links.recorded()[COMMANDS].received == 4


def test_a_recording_counts_from_its_own_start_and_the_status_from_the_recorder_s():
    links = LinkCounts()
    links.take(commands(0, 2))
    links.begin_recording()
    links.take(commands(3, 6))
    assert (links.recorded()[COMMANDS].received, links.recorded()[COMMANDS].missing) == (2, 2)
    assert links.status()["controller/command controller"]["missing"] == 3
    assert links.missing() == {"controller/command": {"missing": 3, "unordered": 0}}
