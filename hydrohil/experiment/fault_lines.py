"""A fault in one line, as the command line takes it: `stuck force at=1.0 for=0.5`, `offset encoder_rotate value=40 at=2`."""

from hydrohil.experiment.errors import ExperimentError
from hydrohil.shared.contract.faults import Fault, value_missing

EXPECTED = "expected KIND TARGET [value=V] [at=SECONDS] [for=SECONDS], such as 'stuck force at=1.0 for=0.5'"
_FIELDS = {"value": "value", "at": "at_s", "for": "lasts_s"}


def fault_of(line: str, where: str) -> Fault:
    """The fault that `line` says; its names and bounds are not judged here. Raises ExperimentError; `where` names the origin."""
    words = line.split()
    if len(words) < 2 or any("=" in word for word in words[:2]):
        raise ExperimentError([f"{where} {line!r}: {EXPECTED}"])
    numbers: dict[str, float] = {}
    for word in words[2:]:
        name, _, text = word.partition("=")
        try:
            numbers[_FIELDS[name]] = float(text)
        except (KeyError, ValueError):
            raise ExperimentError([f"{where} {line!r}: {word!r}: {EXPECTED}"]) from None
    fault = Fault(words[0], words[1], **numbers)
    if "value" not in numbers and (what := value_missing(fault)):
        raise ExperimentError([f"{where} {line!r}: {what}: write value=V"])
    return fault
