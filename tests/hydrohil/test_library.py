"""`import hydrohil as hh`: the public names, each documented, typed, and imported only when it is used."""

import ast
import inspect
import subprocess
import sys
import types
from pathlib import Path

import pytest

import hydrohil as hh

SOURCE = Path(hh.__file__)


def typed_names():
    """Module of each name that type checkers see."""
    for node in ast.parse(SOURCE.read_text()).body:
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            return {name.name: line.module for line in node.body for name in line.names}
    raise AssertionError("no imports for type checkers")


def test_the_names_are_sorted_and_those_that_type_checkers_see():
    assert list(hh.__all__) == sorted(set(hh.__all__))
    assert typed_names() == {name: f"hydrohil.{module}" for name, module in hh._MODULE_OF.items()}
    assert set(hh.__all__) == set(typed_names()) <= set(dir(hh))


@pytest.mark.parametrize("name", hh.__all__)
def test_a_name_is_there_and_documented_in_words_of_its_own(name):
    thing = getattr(hh, name)
    text = inspect.getdoc(thing) or ""
    assert len(text) > 20 and not text.startswith(f"{name}("), "a docstring, and not the one that a named tuple makes itself"
    if inspect.isfunction(thing):
        missing = [one for one in inspect.signature(thing).parameters.values() if one.annotation is inspect.Parameter.empty]
        assert not missing and inspect.signature(thing).return_annotation is not inspect.Parameter.empty


def public_methods():
    for name in hh.__all__:
        thing = getattr(hh, name)
        if inspect.isclass(thing):
            for method, value in vars(thing).items():
                function = getattr(value, "__func__", getattr(value, "fget", value))
                if not method.startswith("_") and isinstance(function, types.FunctionType):
                    yield f"{name}.{method}", function


@pytest.mark.parametrize(("name", "function"), [*public_methods()])
def test_every_method_is_documented(name, function):
    assert inspect.getdoc(function), name


RAISED = [name for name in hh.__all__ if name.endswith("Error")]


@pytest.mark.parametrize("name", RAISED)
def test_every_error_has_one_root_and_an_exit_status(name):
    assert issubclass(getattr(hh, name), hh.HydrohilError)
    assert getattr(hh, name).exit_status in (2, 3, 5)


def test_errors_that_were_of_pythons_kinds_still_are():
    assert issubclass(hh.ExperimentError, ValueError) and issubclass(hh.FileError, ValueError)
    assert issubclass(hh.UnknownNameError, LookupError) and issubclass(hh.MissingPackageError, ImportError)
    assert issubclass(hh.TrippedError, hh.CellError) and issubclass(hh.UnqualifiedError, hh.CellError)


def test_importing_the_library_loads_nothing_else():
    code = "import sys; before = {*sys.modules}; import hydrohil; print(sorted({*sys.modules} - before))"
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=SOURCE.parent.parent)
    assert ran.stdout.strip() == "['hydrohil']"


def test_an_unknown_name_is_no_attribute():
    with pytest.raises(AttributeError, match="no attribute 'lode'"):
        hh.lode  # noqa: B018


def test_a_file_a_name_and_an_alias_are_loaded_and_others_refused_with_the_nearest(tmp_path):
    experiment = hh.load("fig-5-5")
    assert hh.load(experiment.alias) == experiment in hh.catalogue()
    (tmp_path / "mine.toml").write_text(experiment.to_toml())
    assert hh.load(tmp_path / "mine.toml") == hh.load(str(tmp_path / "mine.toml")) == experiment
    with pytest.raises(hh.ExperimentError, match=r"fig-5-55 is no experiment: use one of fig-5-5"):
        hh.load("fig-5-55")
    with pytest.raises(hh.ExperimentError, match="cannot be read"):
        hh.load(tmp_path / "none.toml")
