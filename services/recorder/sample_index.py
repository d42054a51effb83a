"""Samples by their number: where a message belongs on the recording's timelines, by the sample that it is, answers or judges."""

from collections import OrderedDict
from typing import NamedTuple

from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.messages import NO_TRIAL, Sample

KEPT_SAMPLES = 8192  # as deep as the recorder's inbox: 8 s at 1 kHz


class IndexedSample(NamedTuple):
    """Number and times of a sample."""

    number: int
    trial_time_ns: int | None = None  # None outside a trial
    arrival_ns: int = 0  # recorder's monotonic clock; 0 = it has not come


class SampleIndex:
    """The last samples by number; bounded."""

    def __init__(self, kept: int = KEPT_SAMPLES) -> None:
        """No sample has come; keep the last `kept`."""
        self._kept = kept
        self._samples: OrderedDict[int, IndexedSample] = OrderedDict()
        self.newest = IndexedSample(-1)

    def add(self, sample: Sample, arrival_ns: int) -> IndexedSample:
        """Keep a sample."""
        in_trial = sample.tick != NO_TRIAL
        self.newest = IndexedSample(sample.number, sample.trial_time_ns if in_trial else None, arrival_ns)
        self._samples[sample.number] = self.newest
        if len(self._samples) > self._kept:
            self._samples.popitem(last=False)
        return self.newest

    def knows(self, number: int) -> bool:
        """Whether that sample is kept."""
        return number in self._samples

    def at(self, number: int) -> IndexedSample:
        """The sample of that number; one that never came, or is kept no more, has no times."""
        return self._samples.get(number) or IndexedSample(number)

    def clear(self) -> None:
        """Forget all samples: another plant counts its samples from its own start."""
        self._samples.clear()
        self.newest = IndexedSample(-1)


def sample_numbers(messages: list[Received]) -> list[int]:
    """The samples that a topic's messages belong to: their own number where they have one, else the one the frame echoes."""
    if messages and hasattr(messages[0].body, "number"):
        return [message.body.number for message in messages]
    return [message.header.echo_number for message in messages]
