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
    Topic("plant/ground_truth", 21, messages.GroundTruth, "plant", True, "", False),
    Topic("plant/gate", 20, messages.GateEvent, "plant", False, "", False),
    Topic("plant/description", 4, messages.PlantDescription, "plant", False, "", False),
    Topic("controller/command", 5, messages.Command, "controller", True, "1 lease", True),
    Topic("controller/state", 22, messages.ControllerState, "controller", True, "1 lease", False),
    Topic("supervisor/permit", 7, messages.Permit, "supervisor", True, "1 lease", True),
    Topic("plant/link_stats", 10, messages.LinkStats, "plant", False, "", False),
    Topic("controller/link_stats", 11, messages.LinkStats, "controller", False, "", False),
    Topic("supervisor/link_stats", 12, messages.LinkStats, "supervisor", False, "", False),
    Topic("controller/sample_dropped", 13, messages.SampleDropped, "controller", False, "", False),
    Topic("supervisor/sample_dropped", 14, messages.SampleDropped, "supervisor", False, "", False),
    Topic("plant/fault", 15, messages.FaultEvent, "plant", False, "", False),
    Topic("controller/parameter_change", 16, messages.ParameterEvent, "controller", False, "", False),
)
WARMUP = Topic("plant/warmup", 17, messages.Sample, "plant", False, "", True)  # tells nothing new: nobody records it
ASK = Topic("operator/request", 8, messages.Ask, "operator", False, "", False)
ANSWER = Topic("operator/answer", 9, messages.Answer, "", False, "", False)
BY_KEY = {topic.key: topic for topic in (*TOPICS, WARMUP)}
BY_SCHEMA = {topic.schema: topic for topic in (*TOPICS, WARMUP, ASK, ANSWER)}

SERVICES = ("plant", "controller", "supervisor", "recorder")


def expression(cell: str, key: str) -> str:
    """Key expression of a topic on the network."""
    return f"hydrohil/{cell}/{key}"
