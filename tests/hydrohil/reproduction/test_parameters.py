from hydrohil.experiment.experiment import Experiment
from hydrohil.experiment.overrides import with_overrides
from hydrohil.reproduction.parameters import differences
from hydrohil.thesis.library import find


def test_what_differs_is_listed_and_set_gives_the_experiment_back():
    experiment = find("fig-5-9")
    lines = [line for line in differences(experiment) if not line.startswith("reference.")]
    assert "controller.impedance.mass_kg = 50.0" in lines
    assert not [line for line in lines if line.startswith("controller.gains")]
    blank = Experiment(experiment.name, experiment.alias, experiment.title, experiment.source, 1.0)
    given = with_overrides(blank, [line.replace(" = ", "=", 1) for line in lines])
    assert given == experiment._replace(reference=(), claims=())


def test_every_segment_is_a_line_without_its_defaults():
    lines = [line for line in differences(find("fig-5-2")) if line.startswith("reference.")]
    assert lines == ['reference.0 = { channel = "force", kind = "step", start_s = 0.5, amount = 100.0 }']
