"""Another machine than the Unimate as it ships: what it is stands in its description, so nobody takes it for a broken one."""

import pytest

from hydrohil.experiment.experiment import checked
from hydrohil.shared.contract.messages import TripCause
from hydrohil.simulation.rollout import play_local
from hydrohil.thesis.library import catalogue, find

LONGER_M = 0.2  # the tool is 0.7 m long instead of 0.5


def with_longer_tool(experiment):
    """The same trial; a plate stands as much lower as the tip does."""
    plant, environment = experiment.plant, experiment.plant.environment
    if environment.kind == "plate":
        environment = environment._replace(surface_m=environment.surface_m - LONGER_M)
    machine = plant.machine._replace(a4_m=plant.machine.a4_m + LONGER_M)
    return checked(experiment._replace(plant=plant._replace(machine=machine, environment=environment)), experiment.name)


def trip(experiment):
    return TripCause(play_local(experiment, 0).supervisor.cause).name


@pytest.mark.parametrize("name", ["fig-4-25", "fig-5-5", "fig-5-13"])  # free, plate, crate
def test_with_a_longer_tool_a_trial_runs_to_its_end(name):
    assert trip(with_longer_tool(find(name))) == "NONE"


@pytest.mark.slow
@pytest.mark.parametrize("name", [experiment.name for experiment in catalogue()])
def test_with_a_longer_tool_every_trial_of_the_thesis_runs_to_its_end(name):
    assert trip(with_longer_tool(find(name))) == "NONE"


@pytest.mark.parametrize(
    ("ratio", "cause"),
    [
        (0.9, "NONE"),
        (0.7, "NOT_READY"),  # the worn valve's leak evens the pressures out while it is shut: the rod creeps off its pose
    ],
)
def test_with_unequal_piston_areas_a_trial_runs_unless_the_leak_moves_the_rod(ratio, cause):
    experiment = find("fig-4-25")
    machine = experiment.plant.machine
    unequal = machine._replace(down_up=machine.down_up._replace(area_ratio=ratio))
    assert trip(checked(experiment._replace(plant=experiment.plant._replace(machine=unequal)), "unequal")) == cause
