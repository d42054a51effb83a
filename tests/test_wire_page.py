"""The page of the wire against the code: tables, the frame, and the controller in another language."""

import json
import re
import sys
from types import SimpleNamespace
from typing import Any

import pytest

from hydrohil.shared.contract import messages
from hydrohil.shared.contract.codec import WIRE_VERSION, Header, Received, decode, encode
from hydrohil.shared.contract.messages import NO_TRIAL, Command, ControllerState, Sample
from hydrohil.shared.contract.topics import ANSWER, ASK, BY_KEY, BY_SCHEMA, TOPICS, expression
from hydrohil.shared.machine.description import Channel, Drive, Gauge, Geometry, MachineDescription, MotionBounds, machine_id
from hydrohil.shared.transport.endpoints import LISTENERS
from tests.support.machines import description
from tests.support.pages import DOCS, blocks, rows

WIRE = (DOCS / "reference" / "wire.md").read_text()
CELL = "left"
NS_PER_PERIOD = 4_500_000


def field_names(column: str) -> list[str]:
    """Names in a table's cell: `q, q_set`."""
    return [name.strip() for name in column.split(",")]


def test_the_table_names_every_key_schema_message_publisher_and_deadline() -> None:
    written = {row[0]: row[1:5] for row in rows(WIRE, "key after the prefix")}
    for key, topic in BY_KEY.items():
        assert written[key] == [
            str(topic.schema),
            topic.message.__name__,
            topic.publisher,
            topic.deadline or "-",
        ]
    assert written["operator/request/<service>"][0] == f"{ASK.schema}, answer {ANSWER.schema}"


def test_the_wire_page_lists_the_header_in_order() -> None:
    names = [row[1].replace(" ", "_") for row in rows(WIRE, "element")]
    assert [name.replace("echo_time", "echo_time_ns") for name in names] == [*Header._fields, "body"]


@pytest.mark.parametrize("topic", TOPICS, ids=lambda topic: str(topic.key))
def test_the_wire_page_lists_every_field_in_order(topic: Any) -> None:
    section = WIRE[WIRE.index(f"### {topic.key}\n") :]
    names = [name for row in rows(section, "field") for name in field_names(row[0])]
    assert names == list(topic.message._fields)


def test_the_wire_page_lists_every_field_of_a_machine_in_order() -> None:
    names = [name for row in rows(WIRE, "of `machine`") for name in field_names(row[0])]
    assert names == list(MachineDescription._fields)
    for kind in (Channel, Drive, Geometry, Gauge, MotionBounds):
        (row,) = [row for row in rows(WIRE, "part") if row[0] == kind.__name__]
        assert re.findall(r"(\w+) \((?:str|int|float)", row[1]) == list(kind._fields)


@pytest.mark.parametrize("causes", [messages.GateCause, messages.TripCause])
def test_the_wire_page_lists_every_cause(causes: Any) -> None:
    text = " ".join(WIRE[WIRE.index("### Causes") :].split("\n\n## ")[0].split())
    assert ", ".join(f"{int(cause)} {cause.name.lower().replace('_', ' ')}" for cause in causes) in text


def test_the_frame_printed_is_what_the_codec_makes() -> None:
    key = expression("cell", "controller/command")
    header = Header(
        version=WIRE_VERSION,
        schema=5,
        cell="cell",
        run=7,
        experiment=b"",
        sender="controller",
        epoch=3,
        arming_id=11,
        seq=0,
        echo_number=42,
        echo_time_ns=189_000_000,
    )
    assert bytes.fromhex(blocks(WIRE, "hex")[0]) == encode(key, header, Command((2048, 2048, 2048)))


@pytest.fixture
def still() -> SimpleNamespace:
    """The foreign controller's module, without its transport."""
    (code,) = blocks(WIRE, "python")
    names: dict[str, Any] = {"__name__": "still"}
    exec(compile(code, "docs/reference/wire.md", "exec"), names)  # the block that a reader would save
    return SimpleNamespace(**names)


def sample_frame(arming_id: int = 11) -> bytes:
    zero = (2048, 2048, 2048)
    sample = Sample(
        number=42,
        time_ns=42 * NS_PER_PERIOD,
        tick=NO_TRIAL,
        trial_time_ns=0,
        encoder_counts=(1, 2, 3, 4, 5),
        force_counts=22,
        dac_counts=zero,
        gate=0,
        gate_cause=1,
        gate_open_samples=0,
        recover_signs=(0, 0, 0),
        command_number=41,
        command_late_substeps=0,
        command_age_ns=0,
    )
    header = Header(
        version=WIRE_VERSION,
        schema=1,
        cell=CELL,
        run=0,
        experiment=b"",
        sender="plant",
        epoch=5,
        arming_id=arming_id,
        seq=42,
        echo_number=42,
        echo_time_ns=42 * NS_PER_PERIOD,
    )
    return encode(expression(CELL, "plant/sample"), header, sample)


def read(key: str, frame: bytes) -> Received:
    found = decode(expression(CELL, key), BY_KEY[key], CELL, frame, 0)
    assert isinstance(found, Received), found
    return found


def test_the_foreign_controller_imports_nothing_of_this_project() -> None:
    (code,) = blocks(WIRE, "python")
    imported = set(re.findall(r"^(?:import|from) (\w+)", code, re.MULTILINE))
    assert imported - set(sys.stdlib_module_names) == {"msgpack", "zenoh"}


def test_the_foreign_controller_answers_with_frames_that_the_codec_accepts(still: SimpleNamespace) -> None:
    command, state = still.Still(CELL).answer_sample(sample_frame())
    answer, thought = read("controller/command", command), read("controller/state", state)
    assert answer.body == Command((2048, 2048, 2048))
    assert isinstance(thought.body, ControllerState) and thought.body.ready == 1
    assert thought.body.machine_id == 0
    for header in (answer.header, thought.header):
        assert (header.arming_id, header.echo_number, header.echo_time_ns) == (11, 42, 42 * NS_PER_PERIOD)
        assert (header.sender, header.seq) == ("controller", 0)


def test_the_foreign_controller_states_the_machine_that_the_plant_describes(still: SimpleNamespace) -> None:
    controller, key, plant = still.Still(CELL), expression(CELL, "plant/description"), description()
    header = Header(
        version=WIRE_VERSION,
        schema=BY_KEY["plant/description"].schema,
        cell=CELL,
        run=0,
        experiment=b"",
        sender="plant",
        epoch=5,
        arming_id=0,
        seq=1,
        echo_number=-1,
        echo_time_ns=0,
    )
    controller.learn(encode(key, header, plant))
    thought = read("controller/state", controller.answer_sample(sample_frame())[1])
    assert thought.body.machine_id == machine_id(plant.machine_hash) != 0


def test_the_foreign_controller_counts_its_frames_on_each_topic(still: SimpleNamespace) -> None:
    controller = still.Still(CELL)
    sent = [controller.answer_sample(sample_frame()) for _ in range(3)]
    assert [read("controller/command", command).header.seq for command, _ in sent] == [0, 1, 2]
    assert [read("controller/state", state).header.seq for _, state in sent] == [0, 1, 2]


def test_the_foreign_controller_does_not_answer_a_corrupt_sample(still: SimpleNamespace) -> None:
    frame = bytearray(sample_frame())
    frame[20] ^= 1
    assert still.Still(CELL).answer_sample(bytes(frame)) is None


def test_the_foreign_controller_echoes_the_hash_of_a_load(still: SimpleNamespace) -> None:
    controller = still.Still(CELL)
    key = expression(CELL, f"{ASK.key}/controller")

    def ask(verb: str, to: int = controller.epoch, **arguments: str) -> Any:
        header = Header(
            version=WIRE_VERSION,
            schema=ASK.schema,
            cell=CELL,
            run=0,
            experiment=b"",
            sender="operator",
            epoch=9,
            arming_id=0,
            seq=0,
            echo_number=-1,
            echo_time_ns=0,
        )
        frame = encode(key, header, (verb, json.dumps({"to": to, **arguments}).encode()))
        answer = decode(key, ANSWER, CELL, controller.answer_request(key, frame), 0)
        assert isinstance(answer, Received), answer
        return answer.body

    loaded = ask("load", envelope='{"run": 7, "clock": "lockstep"}')
    digest = json.loads(loaded.values)["digest"]
    assert ask("commit", digest="00").accepted == 0
    assert ask("commit", to=controller.epoch + 1, digest=digest).accepted == 0
    assert ask("commit", digest=digest).accepted == 1
    header = read("controller/command", controller.answer_sample(sample_frame())[0]).header
    assert (header.run, header.experiment.hex()) == (7, digest)
    assert ask("sing").accepted == 0


def test_the_ports_are_those_of_the_bus() -> None:
    assert LISTENERS.index("plant") == 0 and LISTENERS.index("controller") == 1
    assert LISTENERS.index("supervisor") == 2 and LISTENERS.index("recorder") == 3
    assert "P+1 the controller's, P+2 the supervisor's, P+3 the recorder's" in WIRE


def test_every_schema_of_the_foreign_controller_is_the_table_s(still: SimpleNamespace) -> None:
    named = {
        still.SAMPLE: "plant/sample",
        still.COMMAND: "controller/command",
        still.DESCRIPTION: "plant/description",
        still.STATE: "controller/state",
    }
    assert named == {schema: BY_SCHEMA[schema].key for schema in named}
    assert {still.ASK: ASK.key, still.ANSWER: ANSWER.key} == {ASK.schema: ASK.key, ANSWER.schema: ANSWER.key}
