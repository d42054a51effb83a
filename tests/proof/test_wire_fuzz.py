"""A few thousand of the million inputs of bench/fuzz.py, and what the CRC sees of every frame."""

import itertools
import random

import pytest

from hydrohil.shared.contract.codec import Rejected, decode
from hydrohil.shared.contract.topics import BY_KEY, BY_SCHEMA
from tests.support.wire_fuzz import (
    CELL,
    complaint,
    independent,
    load_complaint,
    loads,
    mutated,
    real_frame,
    request_complaint,
    syndromes,
    undetected,
)


@pytest.mark.parametrize("topic", BY_SCHEMA.values(), ids=lambda topic: topic.key)
def test_no_frame_that_was_tampered_with_is_accepted_and_none_raises(topic):
    rng = random.Random(topic.schema)
    assert not [said for _ in range(300) if (said := complaint(mutated(topic, rng)))]


def test_no_envelope_no_experiment_and_no_request_raises_or_is_left_without_words():
    rng, (text, data) = random.Random(5), loads()
    assert not [said for _ in range(60) if (said := load_complaint(text, data, rng))]
    assert not [said for _ in range(300) if (said := request_complaint(rng))]


@pytest.mark.parametrize("topic", BY_SCHEMA.values(), ids=lambda topic: topic.key)
def test_the_crc_sees_every_error_of_one_and_two_bits_and_every_burst_of_up_to_32(topic):
    assert not list(undetected(syndromes(topic, random.Random(topic.schema))))


def test_the_crc_sees_every_error_of_three_bits_of_a_command():
    found = syndromes(BY_KEY["controller/command"], random.Random(5))
    every = set(found)
    assert not any(a ^ b in every for a, b in itertools.combinations(found, 2))


def test_syndromes_are_those_of_the_decoder():
    rng = random.Random(3)
    topic = BY_KEY["controller/command"]
    key, frame = real_frame(topic, rng)
    for _ in range(2000):
        flipped = bytearray(frame)
        for bit in rng.sample(range(8 * len(frame)), rng.choice((1, 2, 3))):
            flipped[bit // 8] ^= 1 << bit % 8
        assert isinstance(decode(key, topic, CELL, bytes(flipped), 0), Rejected)


def test_what_the_crc_would_not_see_is_found():
    assert independent([1, 2, 4])
    assert not independent([1, 2, 3])
    found = syndromes(BY_KEY["plant/gate"], random.Random(1))
    assert "two bits" in undetected([*found[:50], found[7], *found[51:]])
    assert "a burst from bit 19" in undetected([*found[:50], found[49] ^ found[48], *found[51:]])
