from pathlib import Path

from hydrohil.shared.compiled import kernel as module
from hydrohil.shared.compiled.kernel import compiled, kernel, kernel_version, source_version


@kernel
def twice(x: float) -> float:
    return 2.0 * x


def test_a_marked_function_stays_plain_python():
    assert twice(1.5) == 3.0
    assert type(twice) is type(lambda: None)


def test_a_compiled_function_calls_marked_ones_by_their_machine_code():
    def outer(x):
        return twice(x) + 1.0

    assert compiled(outer)(1.5) == outer(1.5) == 4.0


def test_the_version_of_the_sources_changes_with_any_of_them(tmp_path, monkeypatch):
    for folder in ("shared", "services", "rollout", "experiments"):
        (tmp_path / folder).mkdir()
    source = tmp_path / "services" / "law.py"
    source.write_text("gain = 1")
    monkeypatch.setattr(module, "_PACKAGE", tmp_path)
    versions = [source_version()]
    source.write_text("gain = 2")
    versions.append(source_version())
    source.rename(tmp_path / "shared" / "law.py")
    versions.append(source_version())
    (tmp_path / "notes.md").write_text("no source")
    assert source_version() == versions[-1]
    assert len(set(versions)) == 3


def test_the_machine_code_is_named_by_its_sources_and_by_no_others(tmp_path, monkeypatch):
    law, claim = tmp_path / "services" / "controller" / "law.py", tmp_path / "experiments" / "claim.py"
    for path in (law, claim):
        path.parent.mkdir(parents=True)
        path.write_text("a = 1")
    monkeypatch.setattr(module, "_PACKAGE", tmp_path)
    first = kernel_version()
    claim.write_text("a = 2")
    assert kernel_version() == first
    law.write_text("a = 2")
    assert kernel_version() != first


def test_the_cache_lies_in_a_folder_of_this_version():
    import os

    compiled(twice)
    assert kernel_version() in Path(os.environ["NUMBA_CACHE_DIR"]).name
