"""Every topic in one table: key, message, publisher, rate, deadline. Watchdogs, recorder and wire page derive from it."""

from collections.abc import Callable
from typing import Any, NamedTuple

from hydrohil.shared.contract import messages
from hydrohil.shared.contract.description import description_problem


class Topic(NamedTuple):
    """One row. Keys on the network are `hydrohil/<cell>/<key>`."""

    key: str
    schema: int  # a new field is a new number
    message: Any  # its NamedTuple class
    publisher: str
    per_sample: bool = False  # once a sample; otherwise on change
    deadline: str = ""  # in sample periods or leases; "" = none
    loop: bool = False  # carries the control loop: real-time priority
    problem: Callable[[Any], str] | None = None  # why a body of the right types cannot be used, "" if it can


TOPICS = (
    Topic("plant/sample", 1, messages.Sample, "plant", per_sample=True, deadline="1 period", loop=True),
    Topic("plant/ground_truth", 21, messages.GroundTruth, "plant", per_sample=True),
    Topic("plant/gate", 20, messages.GateEvent, "plant"),
    Topic("plant/description", 23, messages.PlantDescription, "plant", problem=description_problem),
    Topic("controller/command", 5, messages.Command, "controller", per_sample=True, deadline="1 lease", loop=True),
    Topic("controller/state", 24, messages.ControllerState, "controller", per_sample=True, deadline="1 lease"),
    Topic("supervisor/permit", 25, messages.Permit, "supervisor", per_sample=True, deadline="1 lease", loop=True),
    Topic("plant/link_stats", 26, messages.LinkStats, "plant"),
    Topic("controller/link_stats", 27, messages.LinkStats, "controller"),
    Topic("supervisor/link_stats", 28, messages.LinkStats, "supervisor"),
    Topic("controller/sample_dropped", 29, messages.SampleDropped, "controller"),
    Topic("supervisor/sample_dropped", 30, messages.SampleDropped, "supervisor"),
    Topic("plant/fault", 15, messages.FaultEvent, "plant"),
    Topic("controller/parameter_change", 31, messages.ParameterEvent, "controller"),
)
WARMUP = Topic("plant/warmup", 32, messages.Sample, "plant", loop=True)  # repeats the last sample: it is not recorded
ASK = Topic("operator/request", 8, messages.Ask, "operator")
ANSWER = Topic("operator/answer", 9, messages.Answer, "")
BY_KEY = {topic.key: topic for topic in (*TOPICS, WARMUP)}
BY_SCHEMA = {topic.schema: topic for topic in (*TOPICS, WARMUP, ASK, ANSWER)}

SERVICES = ("plant", "controller", "supervisor", "recorder")


def expression(cell: str, key: str) -> str:
    """Key expression of a topic on the network."""
    return f"hydrohil/{cell}/{key}"
