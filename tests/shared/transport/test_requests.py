"""Requests at the level of frames: each acts once, and in that start of the service alone that it names."""

import pytest

from hydrohil.shared.contract.codec import Received, decode
from hydrohil.shared.contract.topics import ANSWER
from hydrohil.shared.transport import requests
from hydrohil.shared.transport.requests import Requests
from tests.support.wire_scene import CELL, EPOCHS, Query, ask_header

ACTING = ["reset", "arm", "start", "recover", "load", "inject"]
OPERATOR, OTHER = 5, 6  # epochs of two sessions


def started(epoch=EPOCHS["supervisor"]):
    return Requests(CELL, epoch, lambda topic: ask_header()._replace(schema=topic.schema, epoch=epoch))


def accepted(service, *queries):
    """Verbs that are handed to the service."""
    for query in queries:
        service.put(query)
    return [request.verb for request in service.take()]


def refusal(query):
    (frame,) = query.replies
    answer = decode(query.key_expr, ANSWER, CELL, frame, 0)
    assert isinstance(answer, Received) and not answer.body.accepted
    return answer.body.reason


def ask(verb, seq=0, epoch=OPERATOR, **arguments):
    return Query("supervisor", verb, seq, epoch, **arguments)


@pytest.mark.parametrize("verb", ACTING)
def test_a_replayed_request_is_refused_before_anyone_serves_it(verb):
    service, replayed = started(), ask(verb, 1)
    assert accepted(service, ask(verb, 1)) == [verb]
    assert accepted(service, replayed) == []
    assert "came before" in refusal(replayed)
    assert accepted(service, ask(verb, 2)) == [verb]


@pytest.mark.parametrize("verb", ACTING)
def test_a_request_that_was_recorded_before_a_restart_has_no_effect_after_it(verb):
    assert accepted(started(), ask(verb)) == [verb]
    restarted, recorded = started(epoch=99), ask(verb)
    assert accepted(restarted, recorded) == []
    assert "another start" in refusal(recorded)
    assert accepted(restarted, ask(verb, to=99)) == [verb]


@pytest.mark.parametrize("to", [None, "11", 11.0, True, [11]])
def test_a_request_that_names_no_epoch_is_refused_with_the_way_to_get_it(to):
    query = ask("arm", to=to)
    assert accepted(started(), query) == []
    assert "`status`" in refusal(query) and "`to`" in refusal(query)


@pytest.mark.parametrize("arguments", ["", "[]", "{", "5", "[" * 3000])
def test_arguments_that_are_no_object_are_refused(arguments):
    query = Query.of_text("supervisor", "arm", arguments)
    assert accepted(started(), query) == []
    assert "no JSON object" in refusal(query)


def test_a_frame_that_is_no_request_is_refused_with_its_cause():
    query = ask("arm")
    query.frame = query.frame[:-1] + bytes([query.frame[-1] ^ 1])
    assert accepted(started(), query) == []
    assert refusal(query) == "malformed request: crc: checksum differs"


def test_a_request_is_answered_once_with_its_outcome():
    service, accepted, refused = started(), ask("arm", 1), ask("start", 2)
    service.put(accepted)
    service.put(refused)
    first, second = service.take()
    first.reply({"mode": "ARMED"})
    second.refuse("not now")
    (frame,) = accepted.replies
    answer = decode(accepted.key_expr, ANSWER, CELL, frame, 0).body
    assert (answer.accepted, answer.reason, answer.values) == (1, "", b'{"mode": "ARMED"}')
    assert refusal(refused) == "not now"


def test_what_only_speaks_of_a_stop_is_no_stop_and_is_refused_once_if_it_is_no_request():
    service, broken = started(), ask("estop")
    broken.frame = broken.frame[:-1] + bytes([broken.frame[-1] ^ 1])
    service.put(broken)
    assert service.stops() == []
    assert "crc" in refusal(broken)
    assert service.take() == []


@pytest.mark.parametrize("verb", ["estop", "status"])
def test_a_stop_and_a_question_are_never_refused(verb):
    assert accepted(started(), ask(verb), ask(verb), ask(verb, to=None), ask(verb, to=99)) == [verb] * 4


def test_no_number_of_other_requests_lets_an_old_one_act_again():
    service = started()
    assert accepted(service, ask("start", 1)) == ["start"]
    for seq in range(2, 3000):
        assert accepted(service, ask("status", seq), ask("reset", seq, OTHER)) == ["status", "reset"]
    assert accepted(service, ask("start", 1)) == []


def test_the_numbers_of_one_session_do_not_bind_another_and_may_have_gaps():
    service = started()
    assert (
        accepted(service, ask("arm", 7), ask("arm", 3, OTHER), ask("start", 9), ask("start", 4, OTHER))
        == ["arm"] * 2 + ["start"] * 2
    )


def test_an_older_request_that_comes_late_is_refused():
    service, late = started(), ask("arm", 1)
    assert accepted(service, ask("stop", 2)) == ["stop"]
    assert accepted(service, late) == []
    assert "a later one" in refusal(late)


def test_the_numbers_of_a_session_begin_at_zero():
    assert accepted(started(), ask("arm", -1), ask("arm", 0)) == ["arm"]


def test_the_start_is_no_argument_of_the_verb():
    service = started()
    service.put(ask("arm", at=3))
    assert service.take()[0].arguments == {"at": 3}


def test_more_sessions_than_are_kept_are_refused_and_none_is_forgotten(monkeypatch):
    monkeypatch.setattr(requests, "MOST_SESSIONS", 3)
    service, one_more = started(), ask("arm", epoch=4)
    assert accepted(service, *(ask("arm", epoch=epoch) for epoch in (1, 2, 3))) == ["arm"] * 3
    assert accepted(service, one_more) == []
    assert "start it anew" in refusal(one_more)
    assert accepted(service, *(ask("arm", epoch=epoch) for epoch in (1, 2, 3))) == []
    assert accepted(service, ask("arm", 1, epoch=1), ask("estop", epoch=4)) == ["estop", "arm"]


def test_as_many_sessions_are_kept_as_fit_10_mb():
    assert requests.MOST_SESSIONS == 65_536


def test_what_is_refused_is_not_remembered(monkeypatch):
    monkeypatch.setattr(requests, "MOST_SESSIONS", 1)
    service = started()
    assert accepted(service, ask("arm", epoch=1, to=99), ask("status", epoch=2)) == ["status"]
    assert accepted(service, ask("arm", epoch=3)) == ["arm"]
