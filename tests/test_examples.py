"""The programs in `examples/` run, and do what their first lines say; each is short enough to be read at once."""

import ast
import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

import hydrohil as hh

FOLDER = Path(__file__).resolve().parent.parent / "examples"
PROGRAMS = sorted(path.stem for path in FOLDER.glob("*.py"))


def example(name: str) -> ModuleType:
    """The program as a module; its `main` has not run."""
    spec = importlib.util.spec_from_file_location(name, FOLDER / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", PROGRAMS)
def test_a_program_is_short_says_how_it_is_run_and_uses_the_library_alone(name: str):
    text = (FOLDER / f"{name}.py").read_text()
    assert len(text.splitlines()) < 60
    assert f"python examples/{name}.py" in (ast.get_docstring(ast.parse(text)) or "")
    imported = {node.module for node in ast.walk(ast.parse(text)) if isinstance(node, ast.ImportFrom)}
    assert "import hydrohil as hh" in text and not [module for module in imported if str(module).startswith("hydrohil")]
    assert f"test_{name}" in Path(__file__).read_text()


def test_one_trial(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    example("one_trial").main(tmp_path / "new" / "trial.png")
    assert (tmp_path / "new" / "trial.png").read_bytes().startswith(b"\x89PNG")
    assert "as in the thesis: 4 of 4 claims hold" in capsys.readouterr().out


def test_sweep_a_gain(capsys: pytest.CaptureFixture[str]):
    example("sweep_a_gain").main()
    *trials, refused = capsys.readouterr().out.splitlines()
    errors_deg = [float(line.split()[-2]) for line in trials]
    assert errors_deg == sorted(errors_deg, reverse=True) and len(errors_deg) == 5
    assert "kp_a_per_rad is -1.0 A/rad: expected greater than or equal to 0" in refused


def test_own_experiment(tmp_path: Path):
    run = example("own_experiment").main(tmp_path / "nod.toml")
    assert run.holds and len(run.verdicts) == 1
    assert hh.load(tmp_path / "nod.toml") == run.experiment


@pytest.mark.live
def test_break_it_live(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    monkeypatch.chdir(tmp_path)  # the report of the trip goes to runs/trips
    run = example("break_it_live").main("example-test", 7860)
    out = capsys.readouterr().out
    assert run.holds and "TRIPPED" in out and "mode: TRIPPED" in out
    assert "stood still" in out


@pytest.mark.live
def test_compare_recordings(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    compare = example("compare_recordings").main
    experiment = hh.load("fig-5-5").with_values({"duration_s": 1.0, "claims": []})
    with hh.Cell("recordings", 7866) as cell:
        for name, seed in (("a", 1), ("again", 1), ("b", 2)):
            run = cell.run(experiment, seed, record=tmp_path / f"{name}.rrd")
            assert Path(run.recording) == tmp_path / f"{name}.rrd"
    assert compare(tmp_path / "a.rrd", tmp_path / "again.rrd") == 0.0
    assert compare(tmp_path / "a.rrd", tmp_path / "b.rrd") > 0.1
    assert "force_counts" in capsys.readouterr().out
