"""A fuzzer on every decoder: frames of every topic, requests and answers, envelopes, experiments.

No input may raise, none may be accepted under a false type or sender, and no forgery may pass that the CRC should detect.
Of real frames of every topic it is shown for all errors of one and two bits and all bursts of up to 32 that the CRC detects
them (it is linear: by the syndromes of the single bits); those of one and two bits of a command are decoded one by one.

Example: python bench/fuzz.py --count 1000000 --seed 1
"""

import argparse
import collections
import itertools
import random
import sys
import time
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))  # the tests are not installed

from hydrohil.shared.contract.codec import Rejected, decode  # noqa: E402
from hydrohil.shared.contract.topics import BY_KEY, BY_SCHEMA  # noqa: E402
from tests.support import wire_fuzz as fuzz  # noqa: E402

FEW = 50  # one input in so many is an envelope and an experiment, which cost as much as fifty frames; and one a request
SHOWN = 10


def frames(count: int, rng: random.Random) -> tuple[collections.Counter[str], list[str]]:
    """Outcomes of `count` mutated frames, and what went wrong."""
    outcomes: collections.Counter[str] = collections.Counter()
    wrong = []
    topics = list(BY_SCHEMA.values())
    for i in range(count):
        fuzzed = fuzz.mutated(topics[i % len(topics)], rng)
        try:
            problem = fuzz.complaint(fuzzed)
        except Exception as error:
            problem = f"raised {type(error).__name__}: {error}"
        if problem:
            wrong.append(f"{fuzzed.topic.key}: {problem}: {fuzzed.frame.hex()}")
        found = decode(fuzzed.key, fuzzed.topic, fuzz.CELL, fuzzed.frame, 0)
        outcomes[found.cause if isinstance(found, Rejected) else "accepted: resealed and well-typed"] += 1
        outcomes["CRC not resealed"] += not fuzzed.sealed
    return outcomes, wrong


def tried(name: str, count: int, complaint: Callable[[], str]) -> list[str]:
    """What went wrong in `count` tries."""
    wrong = []
    for _ in range(count):
        try:
            problem = complaint()
        except Exception as error:
            problem = f"raised {type(error).__name__}: {error}"
        if problem:
            wrong.append(f"{name}: {problem}")
    return wrong


def bit_errors(rng: random.Random) -> tuple[int, list[str]]:
    """Patterns looked at one by one, and what the CRC does not see."""
    wrong = [f"{topic.key}: {words}" for topic in BY_SCHEMA.values() for words in fuzz.undetected(fuzz.syndromes(topic, rng))]
    topic = BY_KEY["controller/command"]
    key, frame = fuzz.real_frame(topic, rng)
    bits = range(8 * len(frame))
    patterns = [*itertools.combinations(bits, 1), *itertools.combinations(bits, 2)]
    for pattern in patterns:
        if not isinstance(decode(key, topic, fuzz.CELL, fuzz._flip(frame, [*pattern]), 0), Rejected):
            wrong.append(f"{topic.key}: bits {pattern} of {frame.hex()}")
    return len(patterns), wrong


def main() -> int:
    line = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    line.add_argument("--count", type=int, default=1_000_000, help="inputs (1000000)")
    line.add_argument("--seed", type=int, default=1)
    given = line.parse_args()
    rng, began = random.Random(given.seed), time.monotonic()
    text, data = fuzz.loads()
    few = given.count // FEW
    outcomes, wrong = frames(given.count - 2 * few, rng)
    wrong += tried("load", few, lambda: fuzz.load_complaint(text, data, rng))
    wrong += tried("request", few, lambda: fuzz.request_complaint(rng))
    looked_at, undetected = bit_errors(rng)
    wrong += undetected
    for name, times in outcomes.most_common():
        print(f"{times:9d} frames: {name}")
    print(f"{few:9d} envelopes and experiments, and as many requests")
    print(f"{looked_at:9d} errors of one and two bits of a command, each decoded; all of every topic by their syndromes")
    odds = outcomes["CRC not resealed"] / 2**32
    print(f"seed {given.seed}, {time.monotonic() - began:.0f} s; the CRC's own odds on these: {odds:.1g} forgeries")
    print("\n".join(wrong[:SHOWN]) or "no exception, no forgery accepted")
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
