"""A fault in one line, as the command line takes it: `stuck force at=1.0 for=0.5`, `offset encoder_rotate value=40 at=2`."""

from collections.abc import Sequence

from hydrohil.experiment.errors import ExperimentError
from hydrohil.experiment.experiment import Experiment, from_plain, to_plain
from hydrohil.shared.contract.faults import Fault, value_missing

WHERE = "--inject"
EXPECTED = "expected KIND TARGET [value=V] [at=SECONDS] [for=SECONDS], such as 'stuck force at=1.0 for=0.5'"
_FIELDS = {"value": "value", "at": "at_s", "for": "lasts_s"}


def with_faults(experiment: Experiment, lines: Sequence[str]) -> Experiment:
    """`experiment` with these faults after its own, validated as if it had been written so. Raises ExperimentError."""
    if not lines:
        return experiment
    return from_plain(to_plain(experiment._replace(faults=experiment.faults + tuple(map(fault_of, lines)))), WHERE)


def fault_of(line: str) -> Fault:
    """The fault that `line` says; raises ExperimentError. Its names and bounds are not judged here."""
    words = line.split()
    if len(words) < 2 or any("=" in word for word in words[:2]):
        raise ExperimentError([f"{WHERE} {line!r}: {EXPECTED}"])
    numbers: dict[str, float] = {}
    for word in words[2:]:
        name, _, text = word.partition("=")
        try:
            numbers[_FIELDS[name]] = float(text)
        except (KeyError, ValueError):
            raise ExperimentError([f"{WHERE} {line!r}: {word!r}: {EXPECTED}"]) from None
    made = Fault(words[0], words[1], **numbers)
    if "value" not in numbers and (what := value_missing(made)):
        raise ExperimentError([f"{WHERE} {line!r}: {what}: write value=V"])
    return made
