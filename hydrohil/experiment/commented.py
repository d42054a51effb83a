"""An experiment as TOML for people: behind each value its unit and bounds, or what else it can be."""

import re

from hydrohil.experiment.experiment import Experiment
from hydrohil.experiment.json_schema import at, experiment_schema, in_words

_TABLE = re.compile(r"\[\[?([^\]]+)\]\]?")
_VALUE = re.compile(r"([A-Za-z0-9_]+) = ")


def commented_toml(experiment: Experiment) -> str:
    """The experiment with every default spelled out and commented; `load` reads it back as it is."""
    table: tuple[str, ...] = ()
    lines = []
    for line in experiment.to_toml().splitlines():
        comment = ""
        if heading := _TABLE.fullmatch(line):
            table = tuple(heading[1].split("."))
        elif value := _VALUE.match(line):
            words = in_words(at(experiment_schema(), (*table, value[1])))
            comment = f"  # {words}" if words else ""
        lines.append(line + comment)
    return "\n".join(lines) + "\n"
