"""Mutation test of the gate, the rules, the mode machine and the protection: every small change must fail a test.

Each mutant is run plain (nothing is compiled) against the tests of its module, in a fork of its own; survivors are printed.
`python bench/mutate.py [--jobs N] [module ...]`; exit status 1 if any mutant survives.
"""

import argparse
import ast
import copy
import importlib
import os
import resource
import signal
import sys
import types
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
TESTS = {
    "services/plant/gate.py": ["tests/plant/test_gate_conditions.py", "tests/plant/test_gate_arming.py"],
    "services/supervisor/rules.py": ["tests/supervisor/test_rules.py"],
    "services/supervisor/force_rules.py": ["tests/supervisor/test_rules.py"],
    "services/supervisor/motion_rules.py": ["tests/supervisor/test_rules.py"],
    "services/supervisor/transport_rules.py": ["tests/supervisor/test_rules.py"],
    "services/supervisor/link_rules.py": ["tests/supervisor/test_rules.py"],
    "shared/contract/deadline_window.py": ["tests/shared/contract/test_deadline_window.py"],
    "services/supervisor/observe.py": ["tests/supervisor/test_observe.py", "tests/supervisor/test_observe_motion.py"],
    "services/supervisor/observe_force.py": ["tests/supervisor/test_observe_force.py"],
    "services/supervisor/observe_motion.py": ["tests/supervisor/test_observe_motion.py"],
    "services/supervisor/modes.py": ["tests/supervisor/test_modes.py"],
    "services/supervisor/prearm_checks.py": ["tests/supervisor/test_prearm_checks.py"],
    "services/supervisor/step.py": ["tests/supervisor/test_step.py", "tests/supervisor/test_reset.py"],
    "services/supervisor/mode_entry.py": ["tests/supervisor/test_step.py", "tests/supervisor/test_reset.py"],
    "services/supervisor/recovery.py": ["tests/supervisor/test_step.py", "tests/supervisor/test_reset.py"],
    "services/plant/mailbox.py": ["tests/plant/test_mailbox.py"],
    "services/plant/ledger.py": ["tests/plant/test_ledger.py"],
    "shared/host/lease.py": ["tests/shared/host/test_lease.py"],
    "shared/host/two_phase_load.py": ["tests/shared/host/test_two_phase_load.py"],
    "services/plant/cause_values.py": ["tests/plant/test_cause_values.py"],
    "services/plant/gatekeeper.py": ["tests/plant/test_gatekeeper.py", "tests/plant/test_gatekeeper_clock.py"],
    "shared/transport/acceptance.py": ["tests/shared/transport/test_acceptance.py"],
    "shared/transport/inbox.py": ["tests/shared/transport/test_inbox.py"],
    "shared/contract/codec.py": ["tests/shared/contract/test_codec.py"],
    "shared/transport/protection.py": ["tests/shared/transport/test_protection.py"],
    "shared/contract/timeliness.py": ["tests/shared/contract/test_timeliness.py"],
    "shared/transport/step_lock.py": ["tests/shared/transport/test_step_lock.py"],
    "shared/transport/link_stats.py": ["tests/shared/transport/test_link_stats.py"],
    "shared/transport/requests.py": ["tests/shared/transport/test_requests.py", "tests/shared/transport/test_bus.py"],
}
EQUIVALENT = {  # changes that no test can detect, and why; they are not tried
    "shared/contract/codec.py": {
        "if arrays: always True": "for a message without arrays the checks have nothing to check; it is only a tenth slower"
    },
}
COMPARISONS: dict[type[ast.cmpop], tuple[type[ast.cmpop], ...]] = {
    ast.Lt: (ast.LtE, ast.Gt),
    ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.Lt),
    ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.In: (ast.NotIn,),
}
PRELOADED = ("pytest", "hypothesis.stateful", "numpy", "pydantic", "msgpack")  # imported once; each mutant is a fork
CPU_S, TIMEOUT_S = (
    60,
    600,
)  # a test that never ends detects its mutant; a busy host must not

Change = Callable[[Any], object]


def mutants(module: str, tree: ast.Module) -> Iterator[tuple[str, ast.Module]]:
    """Every mutant of a module, with the line and what was changed."""
    for index, node in enumerate(ast.walk(tree)):
        for words, change in _changes(node):
            if words in EQUIVALENT.get(module, {}):
                continue
            mutant = copy.deepcopy(tree)
            change(list(ast.walk(mutant))[index])
            yield f"{getattr(node, 'lineno', 0)}: {words}", mutant


def tried(module: str, tree: ast.Module) -> int:
    """How many mutants there are."""
    return sum(words not in EQUIVALENT.get(module, {}) for node in ast.walk(tree) for words, _ in _changes(node))


def _changes(node: ast.AST) -> Iterator[tuple[str, Change]]:
    if isinstance(node, ast.Compare):
        for i, operator in enumerate(node.ops):
            for other in COMPARISONS.get(type(operator), ()):
                yield f"{ast.unparse(node)}: {type(operator).__name__} -> {other.__name__}", _operator(i, other)
    elif isinstance(node, ast.BoolOp):
        other_bool = ast.Or if isinstance(node.op, ast.And) else ast.And
        yield f"{ast.unparse(node)}: -> {other_bool.__name__}", lambda n, o=other_bool: setattr(n, "op", o())
        for i, value in enumerate(node.values):
            yield f"{ast.unparse(node)}: {ast.unparse(value)} removed", lambda n, i=i: n.values.pop(i)
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
        yield f"{ast.unparse(node)}: not removed", _without_not
    elif isinstance(node, ast.Constant) and type(node.value) in (int, float, bool):
        if type(node.value) is bool:
            yield f"{node.value} negated", lambda n: setattr(n, "value", not n.value)
        else:
            for by in (-1, 1):
                yield f"constant {node.value} {by:+d}", lambda n, by=by: setattr(n, "value", n.value + by)
    elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
        swapped = ast.Sub if isinstance(node.op, ast.Add) else ast.Add
        yield f"{ast.unparse(node)}: -> {swapped.__name__}", lambda n, s=swapped: setattr(n, "op", s())
    elif isinstance(node, ast.If):
        for value in (True, False):
            yield f"if {ast.unparse(node.test)}: always {value}", lambda n, v=value: setattr(n, "test", ast.Constant(v))


def _operator(i: int, other: type[ast.cmpop]) -> Change:
    def change(node: ast.Compare) -> None:
        node.ops[i] = other()

    return change


def _without_not(node: ast.UnaryOp) -> None:
    node.operand = ast.UnaryOp(ast.Not(), node.operand)


def begun(module: str, tree: ast.Module) -> int:
    """Process in which the tests of `module` run with `tree` in its place; a fork, so that nothing of it remains."""
    child = os.fork()
    if child == 0:
        try:
            resource.setrlimit(resource.RLIMIT_CPU, (CPU_S, CPU_S))
            signal.alarm(TIMEOUT_S)
            os._exit(_test(module, tree))
        except BaseException:  # a mutant that does not even import is dead
            os._exit(1)
    return child


def survivors(module: str, tree: ast.Module, jobs: int) -> Iterator[str]:
    """Those mutants that every test passes, in words; `jobs` of them are tried at once."""
    running: dict[int, str] = {}
    count = tried(module, tree)
    for k, (words, mutant) in enumerate(mutants(module, tree), 1):
        if len(running) == jobs:
            yield from _ended(running)
        running[begun(module, ast.fix_missing_locations(mutant))] = words
        if sys.stderr.isatty():
            print(f"{module}: {k} of {count}", end="\r", file=sys.stderr, flush=True)
    while running:
        yield from _ended(running)


def _ended(running: dict[int, str]) -> Iterator[str]:
    """The next mutant whose tests end, if it survived."""
    child, status = os.wait()
    words = running.pop(child)
    if status == 0:
        yield words
    elif os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGALRM:
        print(f"{words}: its tests did not end within {TIMEOUT_S} s", file=sys.stderr)


def _test(module: str, tree: ast.Module) -> int:
    import hypothesis
    import pytest

    from hydrohil.shared.compiled import kernel

    quiet = os.open(os.devnull, os.O_WRONLY)
    os.dup2(quiet, 1)
    os.dup2(quiet, 2)
    hypothesis.settings.register_profile("mutants", deadline=None, derandomize=True, database=None)
    hypothesis.settings.load_profile("mutants")  # a slow host kills no mutant, and the same ones survive every time
    kernel.compiled = lambda function: function
    name = f"hydrohil.{module.removesuffix('.py').replace('/', '.')}"
    parent, _, own = name.rpartition(".")
    mutant_module = types.ModuleType(name)
    mutant_module.__file__ = str(ROOT / module)
    sys.modules[name] = mutant_module
    setattr(importlib.import_module(parent), own, mutant_module)
    exec(compile(tree, module, "exec"), mutant_module.__dict__)
    return int(pytest.main(["-x", "-q", "-p", "no:cacheprovider", "-k", "not compiled and not of_its_own", *TESTS[module]]))


def main(chosen: list[str], jobs: int) -> int:
    """Try every mutant of the chosen modules; 1 if one survives."""
    os.chdir(ROOT)
    sys.dont_write_bytecode = True
    sys.path.insert(0, str(ROOT))  # the tests are not installed
    for name in PRELOADED:
        importlib.import_module(name)
    total = alive = 0
    for module in chosen or list(TESTS):
        tree = ast.parse((ROOT / module).read_text())
        if os.waitpid(begun(module, tree), 0)[1] != 0:
            print(f"{module}: its tests fail without a mutation")
            return 1
        found = 0
        for words in survivors(module, tree, jobs):
            found += 1
            print(f"{module}:{words}", flush=True)
        print(f"{module}: {tried(module, tree)} mutants, {found} survived", flush=True)
        total, alive = total + tried(module, tree), alive + found
    print(f"{total} mutants, {alive} survived")
    return int(alive > 0)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("modules", nargs="*", metavar="module", help="default: all of the table")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="mutants tried at once (default: one a core)")
    given = parser.parse_args()
    sys.exit(main(given.modules, given.jobs))
