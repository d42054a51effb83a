"""Who may import whom; read from the sources, so that it stays true."""

import ast
from functools import cache
from pathlib import Path

import pytest

from hydrohil.shared.compiled.kernel import KERNEL_FOLDERS, sources
from tests.support.positional import ROOT, by_position, offenders

PACKAGE = Path(__file__).resolve().parent.parent / "hydrohil"
SOURCES = {path.relative_to(PACKAGE).as_posix(): path for path in sources()}
MODULES = {f"hydrohil.{name.removesuffix('.py').replace('/', '.')}".removesuffix(".__init__"): name for name in SOURCES}
IMPURE = {
    "time",
    "os",
    "socket",
    "threading",
    "subprocess",
    "zenoh",
    "rerun",
    "random",
    "secrets",
    "datetime",
    "asyncio",
    "pathlib",
}

# The one list of packages, lowest first: a package may import those of the rows above its own, and no other of its row.
LAYERS: tuple[tuple[str, ...], ...] = (
    ("shared",),
    ("services",),
    ("claims", "recording"),
    ("experiment",),
    ("thesis", "simulation", "pages"),
    ("cell", "linear", "tuning", "campaign", "explanation"),
    ("qualification", "reproduction"),
    ("faulttest",),
    ("cli",),
)
LAYER_OF = {package: number for number, row in enumerate(LAYERS) for package in row}
# Who takes the services' pure modules; `linear` linearises the plant's own equations, and `cli` starts the services' shells.
TAKE_SERVICES = {"experiment", "thesis", "simulation", "linear", "explanation"}
SHELLS = {"main", "service"}
SHARED_ORDER = (
    "exit_status",
    "errors",
    "units",
    "cache",
    "draws",
    "compiled",
    "machine",
    "contract",
    "transport",
    "host",
    "trips",
)  # lowest first


@cache
def tree(path):
    return ast.parse(path.read_text())


@cache
def imports(path):
    """Every module that a file imports, and every name that it imports from one, with dots."""
    found = set()
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.Import):
            found |= {name.name for name in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            found |= {node.module} | {f"{node.module}.{name.name}" for name in node.names}
    return found


def roots(path):
    return {name.split(".")[0] for name in imports(path)}


def ours(name):
    """Modules of this package that a file imports, as `(package, rest)`; itself left out."""
    found = {module for module in imports(SOURCES[name]) if module in MODULES and module != "hydrohil"}
    return {tuple(module.split(".")[1:]) for module in found if MODULES[module] != name}


def has_kernels(path):
    functions = [node for node in ast.walk(tree(path)) if isinstance(node, ast.FunctionDef)]
    return any(isinstance(mark, ast.Name) and mark.id == "kernel" for function in functions for mark in function.decorator_list)


KERNELS = sorted(name for name, path in SOURCES.items() if has_kernels(path))


def test_the_rules_below_look_at_something():
    assert len(SOURCES) > 50
    assert {"services/plant/gate.py", "services/supervisor/step.py", "services/controller/laws/table.py"} <= set(KERNELS)


def test_kernels_lie_where_the_name_of_the_machine_code_sees_them():
    assert not [name for name in KERNELS if not name.startswith(tuple(f"{folder}/" for folder in KERNEL_FOLDERS))]
    kernel_files = [SOURCES[name] for name in KERNELS]
    assert not [path for path in kernel_files if roots(path) & {"experiments"}]


def test_only_the_bus_imports_the_transport():
    assert [name for name, path in SOURCES.items() if "zenoh" in roots(path)] == ["shared/transport/bus.py"]


def test_only_who_writes_and_who_reads_recordings_imports_rerun():
    users = [name for name, path in SOURCES.items() if "rerun" in roots(path)]
    assert users
    assert all(name.startswith(("services/recorder/", "recording/")) for name in users)


def package_of(name):
    return name.split("/")[0] if "/" in name else ""


def test_every_package_has_a_row():
    assert {package_of(name) for name in SOURCES} - {""} == set(LAYER_OF)


@pytest.mark.parametrize("name", sorted(name for name in SOURCES if package_of(name)))
def test_imports_point_downwards(name):
    package = package_of(name)
    for found, *_ in ours(name):
        assert found == package or LAYER_OF[found] < LAYER_OF[package], f"{name} imports hydrohil.{found}"


@pytest.mark.parametrize("name", sorted(name for name in SOURCES if name.startswith("services/")))
def test_a_service_imports_what_is_shared_and_itself(name):
    service = name.split("/")[1]
    assert {found[:2] for found in ours(name) if found[0] != "shared"} <= {("services",), ("services", service)}


@pytest.mark.parametrize("package", sorted(set(LAYER_OF) - {"services", "shared"}))
def test_only_some_packages_take_the_services_pure_modules_and_only_the_command_line_their_shells(package):
    for name in SOURCES:
        if package_of(name) != package:
            continue
        taken = {found for found in ours(name) if found[0] == "services" and len(found) > 2}
        shells = {found for found in taken if found[-1] in SHELLS}
        assert package == "cli" or not shells, name
        assert package in TAKE_SERVICES or taken == shells, f"{name} takes {taken - shells}: see experiment/sections.py"


@pytest.mark.parametrize("name", sorted(name for name in SOURCES if name.startswith("shared/") and name != "shared/__init__.py"))
def test_what_is_shared_has_an_order_too(name):
    part = name.split("/")[1].removesuffix(".py")
    for found in ours(name):
        assert found[0] == "shared"
        if len(found) > 1:
            assert SHARED_ORDER.index(found[1]) <= SHARED_ORDER.index(part), f"{name} imports {'.'.join(found)}"


def test_no_two_files_need_each_other():
    arrows = {name: {MODULES["hydrohil." + ".".join(found)] for found in ours(name)} for name in SOURCES}
    done, circle = set(), []

    def follow(name, way):
        if name in way:
            circle.append(" -> ".join([*way[way.index(name) :], name]))
        elif name not in done:
            for other in sorted(arrows[name]):
                follow(other, [*way, name])
            done.add(name)

    for name in sorted(arrows):
        follow(name, [])
    assert not circle


def test_nobody_imports_the_command_line():
    assert not [name for name in SOURCES if package_of(name) not in ("cli", "") and any(f[0] == "cli" for f in ours(name))]


def test_the_library_needs_no_terminal():
    users = [name for name, path in SOURCES.items() if {"typer", "rich", "click"} & roots(path)]
    assert users
    assert all(name.startswith("cli/") for name in users)


@pytest.mark.parametrize("name", KERNELS)
def test_what_computes_reads_no_clock_no_socket_and_no_file(name):
    assert not roots(SOURCES[name]) & IMPURE
    called = {
        node.func.id for node in ast.walk(tree(SOURCES[name])) if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
    }
    assert not called & {"open", "print", "input", "exec", "eval"}


def test_neither_gate_nor_shell_knows_the_emulator():
    users = [name for name, path in SOURCES.items() if "hydrohil.services.plant.emulator" in imports(path)]
    assert users == ["services/plant/main.py"]


def test_only_the_gatekeeper_and_the_end_of_the_process_write_to_the_device():
    writers = []
    for name, path in SOURCES.items():
        for node in ast.walk(tree(path)):
            if isinstance(node, ast.Attribute) and node.attr == "write" and "device" in ast.unparse(node.value):
                writers.append(name)
    assert set(writers) == {"services/plant/gatekeeper.py", "services/plant/service.py"}
    assert writers.count("services/plant/service.py") == 1


LOOP = (
    "shared/compiled/",
    "shared/contract/",
    "shared/transport/",
    "shared/host/",
    "services/plant/",
    "services/controller/",
    "services/supervisor/",
)
WALL = {"time", "time_ns", "clock_gettime", "clock_gettime_ns", "localtime", "gmtime", "ctime", "now", "utcnow", "today"}


def test_the_loop_reads_no_wall_clock():
    """A clock that is stepped by an hour can have no effect on who never reads it."""
    looked = [name for name in SOURCES if name.startswith(LOOP)]
    assert "shared/transport/bus.py" in looked and "services/plant/service.py" in looked
    for name in looked:
        assert not {"datetime", "time.time", "time.time_ns"} & imports(SOURCES[name]), name
        for node in ast.walk(tree(SOURCES[name])):
            if isinstance(node, ast.Attribute) and ast.unparse(node.value) in ("time", "datetime", "datetime.datetime"):
                assert node.attr not in WALL, f"{name}: {ast.unparse(node)}"
            assert not (isinstance(node, ast.Name | ast.Attribute) and "CLOCK_REALTIME" in ast.unparse(node)), name


def test_no_call_of_ours_passes_seven_or_more_values_by_position():
    found = offenders()
    assert not found, "\n".join(f"{path.relative_to(ROOT)}:{line}: {call} takes {number}" for path, line, call, number in found)


def test_the_check_of_calls_sees_functions_classes_and_methods_of_ours_and_no_others():
    source = """
from numpy import array
from hydrohil.claims.claims import Claim
Claim(1, 2, 3, 4, 5, 6, 7)
Claim(1, 2, 3, 4, 5, 6, unit=7)
array(1, 2, 3, 4, 5, 6, 7)
max(1, 2, 3, 4, 5, 6, 7)
self.measure(1, 2, 3, 4, 5, 6, 7)
table.add_row(1, 2, 3, 4, 5, 6, 7)
words(1, 2, 3, 4, 5, 6, 7)
step(1, 2, 3, 4, 5, 6, *rest)
"""
    found = by_position(ast.parse(source), names={"Claim", "measure", "words"}, variadic={"words"})
    assert [call for _, call, _ in found] == ["Claim", "self.measure", "step"]
