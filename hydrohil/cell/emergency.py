"""Whether an emergency stop is confirmed: by the gate's codes, and by the converter's own where they can be read back."""

import json

from hydrohil.shared.contract.converters import ZERO_CODE
from hydrohil.shared.contract.messages import Answer

_ZERO = [ZERO_CODE] * 3
_CUT = "cut the hydraulic supply"
_THEN = "`hydrohil reset` when the cause is gone"


def outcome(answer: Answer | None) -> tuple[bool, str]:
    """Whether the plant has confirmed zero current, and one line to the operator; without an answer nothing is confirmed."""
    values = json.loads(answer.values) if answer is not None and answer.accepted else {}
    if values.get("dac_counts") != _ZERO:
        return False, f"NOT CONFIRMED: the plant has not reported zero current; {_CUT}"
    if "dac_readback" not in values or values["dac_readback"] is None:
        return True, f"stopped: the gate has written zero current; this D/A cannot be read back: watch the machine; {_THEN}"
    if values["dac_readback"] != _ZERO:
        return False, f"NOT CONFIRMED: the gate has written zero current, but {drives(values['dac_readback'])}; {_CUT}"
    return True, f"stopped: zero current at the D/A, read back; {_THEN}"


def drives(codes: list[int]) -> str:
    """What a converter that does not hold the codes written to it gives to the valves."""
    return f"the D/A drives the valves with the codes {', '.join(map(str, codes))} ({ZERO_CODE} is zero current)"
