"""Every topic in one table: key, message, publisher, nominal rate, deadline. Watchdogs, recorder and README derive from it."""

from typing import Any, NamedTuple

from hydrohil.shared.contract import messages


class Topic(NamedTuple):
    """One row. Keys on the network are `hydrohil/<cell>/<key>`."""

    key: str
    schema: int  # a new field is a new number
    message: Any  # its NamedTuple class
    publisher: str
    per_sample: bool  # once a sample; otherwise on change
    deadline: str  # in sample periods or leases; "" = none
    loop: bool  # carries the control loop: real-time priority


TOPICS = (
    Topic("plant/sample", 1, messages.Sample, "plant", True, "1 period", True),
    Topic("plant/truth", 2, messages.Truth, "plant", True, "", False),
    Topic("plant/gate", 20, messages.GateEvent, "plant", False, "", False),
    Topic("plant/about", 4, messages.About, "plant", False, "", False),
    Topic("controller/command", 5, messages.Command, "controller", True, "1 lease", True),
    Topic("controller/state", 6, messages.ControllerState, "controller", True, "1 lease", False),
    Topic("supervisor/permit", 7, messages.Permit, "supervisor", True, "1 lease", True),
    Topic("plant/reception", 10, messages.Reception, "plant", False, "", False),
    Topic("controller/reception", 11, messages.Reception, "controller", False, "", False),
    Topic("supervisor/reception", 12, messages.Reception, "supervisor", False, "", False),
    Topic("controller/passed", 13, messages.Passed, "controller", False, "", False),
    Topic("supervisor/passed", 14, messages.Passed, "supervisor", False, "", False),
    Topic("plant/fault", 15, messages.FaultEvent, "plant", False, "", False),
    Topic("controller/changed", 16, messages.ParameterEvent, "controller", False, "", False),
)
HERALD = Topic("plant/herald", 17, messages.Sample, "plant", False, "", True)  # tells nothing new: nobody records it
ASK = Topic("operator/request", 8, messages.Ask, "operator", False, "", False)
ANSWER = Topic("operator/answer", 9, messages.Answer, "", False, "", False)
BY_KEY = {topic.key: topic for topic in (*TOPICS, HERALD)}
BY_SCHEMA = {topic.schema: topic for topic in (*TOPICS, HERALD, ASK, ANSWER)}

SERVICES = ("plant", "controller", "supervisor", "recorder")


def expression(cell: str, key: str) -> str:
    """Key expression of a topic on the network."""
    return f"hydrohil/{cell}/{key}"
