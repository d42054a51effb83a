import hashlib
import json
from typing import Annotated, NamedTuple

import pytest
from annotated_types import Interval

from hydrohil.services.controller.config import ControllerConfig
from hydrohil.services.plant.config import PlantConfig
from hydrohil.services.supervisor.config import SupervisorConfig
from hydrohil.shared.contract.envelope import seal, section, unseal


class Arm(NamedTuple):
    reach_m: Annotated[float, Interval(gt=0.0, le=3.0)] = 1.0
    bounds_m: tuple[float, float] = (0.0, 1.0)


def sealed(experiment=None, **changes):
    values = {"run": 1, "seed": 2, "clock": "real", "tare_ticks": 3, "duration_ticks": 4} | changes
    return seal(experiment if experiment is not None else {}, **values)


def test_what_is_sealed_is_what_is_opened_with_the_hash_of_the_text_as_sent():
    text = sealed({"plant": {"bias_s": 1.0}})
    envelope = unseal(text)
    assert envelope[1:] == (1, 2, "real", 3, 4, {"plant": {"bias_s": 1.0}})
    assert envelope.digest == hashlib.sha256(text.encode()).digest()
    assert unseal(" " + text).digest != envelope.digest


@pytest.mark.parametrize(
    "text",
    [
        "",
        "no JSON",
        "[]",
        "null",
        "5",
        "{}",
        '{"run": 1}',
        "[" * 100_000,
        "\ud800",
        sealed()[:-1] + ',"more":1}',
        sealed()[:-1] + ',"digest":1}',
    ],
    ids=lambda text: repr(text)[:20],
)
def test_what_is_no_envelope_is_refused_in_one_line(text):
    with pytest.raises(ValueError, match="the load is no envelope") as refused:
        unseal(text)
    assert len(str(refused.value).splitlines()) == 1


@pytest.mark.parametrize(
    "changes",
    [
        {"clock": "sundial"},
        {"clock": None},
        {"run": -1},
        {"run": 2**63},
        {"seed": 1.0},
        {"seed": True},
        {"tare_ticks": "3"},
        {"tare_ticks": 10_001},
        {"duration_ticks": 3_600_001},
    ],
    ids=str,
)
def test_numbers_and_clock_of_a_run_are_checked_before_anything_is_prepared(changes):
    with pytest.raises(ValueError, match=f"{next(iter(changes))} is "):
        unseal(sealed(**changes))


@pytest.mark.parametrize("experiment", [[], "text", 5])
def test_an_experiment_is_an_object(experiment):
    with pytest.raises(ValueError, match="experiment is"):
        unseal(sealed(experiment))


def test_the_ends_of_the_bounds_are_good():
    assert unseal(sealed(run=2**63 - 1, seed=2**64 - 1, tare_ticks=0, duration_ticks=3_600_000)).run == 2**63 - 1


def test_a_section_is_validated_and_what_is_absent_is_the_default():
    envelope = unseal(sealed({"arm": {"reach_m": 3.0}}))
    assert section(envelope, "arm", Arm) == Arm(3.0)
    assert section(envelope, "leg", Arm) == Arm()


@pytest.mark.parametrize(
    ("arm", "where"),
    [
        ({"reach_m": 3.1}, "arm.reach_m"),
        ({"reach_m": 0}, "arm.reach_m"),
        ({"reach_m": float("nan")}, "arm.reach_m"),
        ({"reach_m": "1"}, "arm.reach_m"),
        ({"reach_m": True}, "arm.reach_m"),
        ({"bounds_m": [0.0, float("inf")]}, "arm.bounds_m"),
        ({"bounds_m": [float("nan"), 1.0]}, "arm.bounds_m"),
        ({"reech_m": 1.0}, "arm.reech_m"),
    ],
    ids=str,
)
def test_a_wrong_field_is_named_in_one_line(arm, where):
    text = json.dumps(json.loads(sealed()) | {"experiment": {"arm": arm}})
    with pytest.raises(ValueError, match=where) as refused:
        section(unseal(text), "arm", Arm)
    assert len(str(refused.value).splitlines()) == 1


@pytest.mark.parametrize(
    ("name", "kind"), [("plant", PlantConfig), ("controller", ControllerConfig), ("supervisor", SupervisorConfig)]
)
def test_every_default_of_every_service_passes_its_own_validation(name, kind):
    from hydrohil.experiment.experiment import to_plain

    assert section(unseal(sealed({name: to_plain(kind())})), name, kind) == kind()
