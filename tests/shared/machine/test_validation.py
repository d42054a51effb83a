"""A machine description is taken like a configuration: each number on its bound passes, just past it and NaN do not."""

import math

import msgpack
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hydrohil.shared.contract.codec import Received, Rejected, crc, decode
from hydrohil.shared.contract.description import described, description_problem
from hydrohil.shared.contract.topics import BY_KEY, expression
from hydrohil.shared.machine.description import machine_hash, machine_id
from hydrohil.shared.machine.unimate import UNIMATE
from hydrohil.shared.machine.validation import machine_problem
from tests.support.machines import description
from tests.support.wire_scene import CELL, header

TOPIC = BY_KEY["plant/description"]
KEY = expression(CELL, TOPIC.key)
HEAD = header(TOPIC.key, seq=1)
PLANT = description()


def with_channel(table: str, index: int, **changes: object):
    channels = list(getattr(UNIMATE, table))
    channels[index] = channels[index]._replace(**changes)
    return UNIMATE._replace(**{table: tuple(channels)})


def nested(part: str, **changes: object):
    return UNIMATE._replace(**{part: getattr(UNIMATE, part)._replace(**changes)})


def decoded(body: object) -> Received | Rejected:
    packed = msgpack.packb([*HEAD, body])
    return decode(KEY, TOPIC, CELL, packed + crc(KEY, packed), 0)


def test_the_unimate_is_a_machine():
    assert machine_problem(UNIMATE) == ""
    assert description_problem(PLANT) == ""


def test_the_hash_names_every_number_and_the_id_its_first_48_bits():
    digest = machine_hash(UNIMATE)
    assert len(digest) == 32 and digest == machine_hash(UNIMATE)
    assert machine_hash(nested("motion", tip_count_m=math.nextafter(1.5e-3, 1.0))) != digest
    assert 0 < machine_id(digest) < 2**48 and f"{machine_id(digest):012x}" == digest.hex()[:12]


@pytest.mark.parametrize(
    ("machine", "words"),
    [
        (UNIMATE._replace(name=""), "machine.name"),
        (UNIMATE._replace(title="x" * 65), "machine.title"),
        (UNIMATE._replace(name="a\nb"), "printable"),
        (UNIMATE._replace(encoders=UNIMATE.encoders[:4]), "machine.encoders: rotate, down_up, out_in, roll; expected"),
        (UNIMATE._replace(converters=()), "machine.converters: none"),
        (UNIMATE._replace(encoders=UNIMATE.encoders[::-1]), "machine.encoders: pitch"),
        (with_channel("encoders", 2, unit="rad"), "channel out_in has the unit 'rad'; expected 'm'"),
        (with_channel("encoders", 0, scale=0.0), "channel rotate: scale is 0"),
        (with_channel("encoders", 0, scale=math.nan), "channel rotate: scale is nan"),
        (with_channel("encoders", 1, offset=math.inf), "channel down_up: offset is inf"),
        (with_channel("encoders", 1, bits=0), "bits is 0; expected 1..32"),
        (with_channel("encoders", 1, bits=2**62), "bits is 4611686018427387904"),
        (with_channel("encoders", 1, low=2047), "counts go from 2047 to 2047"),
        (with_channel("encoders", 1, high=2048), "counts go from 0 to 2048"),
        (nested("force", name="gauge"), "machine.force: gauge; expected force"),
        (nested("force", scale=-math.inf), "channel force: scale"),
        (nested("geometry", hand_m=math.nan), "machine.geometry.hand_m is nan m"),
        (nested("geometry", offset_m=100.1), "machine.geometry.offset_m is 100.1 m"),
        (nested("geometry", retracted_m=-math.inf), "machine.geometry.retracted_m"),
        (nested("geometry", low_q=(math.nan, 0.0, 0.0)), "geometry.low_q of rotate is nan rad"),
        (nested("geometry", high_q=UNIMATE.geometry.low_q), "geometry.high_q of rotate"),
        (nested("gauge", noise_n=-1e-9), "gauge.noise_n"),
        (nested("gauge", range_n=9.9), "gauge.range_n is 9.9 N; expected 10.."),
        (nested("gauge", stiffness_n_per_m=0.0), "gauge.stiffness_n_per_m"),
        (nested("gauge", damping_ns_per_m=math.nan), "gauge.damping_ns_per_m"),
        (nested("gauge", quiet_counts=-1), "gauge.quiet_counts"),
        (nested("motion", full_speed=(0.5, 0.5, 0.5, 0.0)), "motion.full_speed[3] is 0"),
        (nested("motion", moves_down_a=(0.1, math.nan, 0.1)), "motion.moves_down_a[1] is nan A"),
        (nested("motion", moves_up_a=(0.1, 0.1, math.inf)), "motion.moves_up_a[2]"),
        (nested("motion", brakes_q=(-0.1, 0.1, 0.1)), "motion.brakes_q[0]"),
        (nested("motion", moves_within_ns=0), "motion.moves_within_ns"),
        (nested("motion", tip_count_m=0.0), "motion.tip_count_m"),
        (UNIMATE._replace(supply_low_pa=math.nan), "supply_low_pa"),
        (UNIMATE._replace(supply_high_pa=6.4e6), "supply_high_pa"),
        (nested("drive", counts_per_a=math.nan), "machine.drive has nan counts/A"),
        (nested("drive", a_per_code=-1.0), "machine.drive has"),
        (nested("drive", max_counts=0), "expected a range about 0"),
        (nested("drive", denominator=0), "reduces by 3/0"),
        (nested("drive", numerator=6), "reduces by 6/5"),
        (nested("drive", numerator=4), "drives 1.33333 A for each ampere that is written"),
        (nested("drive", zero_code=820), "zero_code is 820; expected inside 820..3276 of rotate"),
        (nested("drive", zero_code=2049), "state two currents for one code"),
        (with_channel("converters", 2, scale=UNIMATE.drive.a_per_code * 1.01), "converter out_in and machine.drive state two"),
    ],
)
def test_each_field_that_cannot_be_is_named(machine, words):
    assert words in machine_problem(machine)
    found = decoded(described(machine, **{name: value for name, value in PLANT._asdict().items() if name in PLANT._fields[2:]}))
    assert isinstance(found, Rejected)
    assert found.cause == "malformed" and words in found.detail


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"machine_hash": b""}, "machine_hash is"),
        ({"machine_hash": machine_hash(UNIMATE)[:31]}, "the hash of its machine"),
        ({"sample_period_ns": 0}, "samples are 0 ns apart"),
        ({"sample_period_ns": 10**9 + 1}, "ns apart"),
        ({"latch_ns": PLANT.sample_period_ns + 1}, "latch"),
        ({"permit_ttl_ns": -1}, "the leases are -1"),
        ({"command_ttl_ns": 10**10 + 1}, "the leases are"),
        ({"gate_force_limit_n": math.nan}, "gate_force_limit_n is nan"),
        ({"gate_force_limit_n": 0.0}, "gate_force_limit_n is 0"),
        ({"force_axis": 3}, "force_axis is 3"),
        ({"force_axis": -1}, "force_axis is -1"),
        ({"force_sign": 0.5}, "force_sign 0.5"),
        ({"force_sign": math.nan}, "force_sign nan"),
    ],
)
def test_what_stands_beside_the_machine_is_judged_too(changes, words):
    plant = PLANT._replace(**changes)
    assert words in description_problem(plant)
    assert isinstance(decoded(plant), Rejected)


def leaves(value: object, path: tuple[int, ...] = ()):
    if isinstance(value, tuple):
        for index, item in enumerate(value):
            yield from leaves(item, (*path, index))
    else:
        yield path, value


def put(value: tuple, path: tuple[int, ...], leaf: object):
    if not path:
        return leaf
    return (*value[: path[0]], put(value[path[0]], path[1:], leaf), *value[path[0] + 1 :])


LEAVES = list(leaves(PLANT))
ANY = {
    float: st.floats(),
    int: st.integers(-(2**63), 2**63 - 1),
    str: st.text(max_size=80),
    bytes: st.binary(max_size=40),
}


@settings(max_examples=300, deadline=None)
@given(st.data())
def test_no_description_with_any_value_in_any_place_raises_and_none_is_taken_whose_hash_is_another(data):
    path, value = data.draw(st.sampled_from(LEAVES))
    other = data.draw(ANY[type(value)])
    found = decoded(put(PLANT, path, other))
    in_machine = path[0] in (0, 1)
    if isinstance(found, Received) and in_machine:
        assert found.body.machine_hash == machine_hash(found.body.machine)


def test_a_description_fits_a_frame_with_room_to_spare():
    assert len(msgpack.packb(PLANT)) < 2048
