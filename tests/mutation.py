"""Break the safety code on purpose, one place at a time, and see whether the tests notice.

Every mutant is one edit of one source file, tried in a child process of its own. A mutant that all
tests pass is a survivor; it needs a better test, or a reason in docs/reference/mutation-testing.md.
"""

import argparse
import ast
import gc
import os
import re
import signal
import sys
import time
import traceback
from collections.abc import Iterator
from pathlib import Path
from types import FunctionType
from typing import Any, NamedTuple

import pytest

ROOT = Path(__file__).resolve().parent.parent
DOCUMENT = ROOT / "docs/reference/mutation-testing.md"
MUTATED = ("governor.py", "faults.py", "supervisor.py", "gate.py")
TESTS = (
    "test_governor.py",
    "test_judge.py",
    "test_judge_reach.py",
    "test_judge_speed.py",
    "test_watch.py",
    "test_watch_data.py",
    "test_watch_force.py",
    "test_watch_motion.py",
    "test_gate.py",
    "test_gate_arm_and_valve.py",
    "test_gate_stage.py",
)
TIMEOUT_S = 60
JOBS = 2
SURVIVED, KILLED, BROKEN = 0, 1, 2

ENUMS = {
    "Severity": ("PASS", "REDUCE", "HOLD", "RETREAT", "STOP"),
    "FilterHealth": ("OK", "REJECTED", "STUCK", "SILENT", "UNTARED"),
    "SensorStatus": ("OK", "SATURATED", "FAULT"),
}
COMPARISONS = {
    "<": ("<=", ">="),
    "<=": ("<", ">"),
    ">": (">=", "<="),
    ">=": (">", "<"),
    "==": ("!=",),
    "!=": ("==",),
    "is": ("is not",),
    "is not": ("is",),
    "in": ("not in",),
    "not in": ("in",),
}
SYMBOLS: dict[type[ast.AST], str] = {
    ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!=",
    ast.Is: "is", ast.IsNot: "is not", ast.In: "in", ast.NotIn: "not in",
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.BitOr: "|", ast.BitAnd: "&",
}  # fmt: skip
ARITHMETIC = {"+": "-", "-": "+", "*": "/", "/": "*", "|": "&", "&": "|"}
TRIPLES = ("force_N", "step_m", "workspace_min_m", "workspace_max_m")
VARIADIC = ("max", "min", "math.hypot", "finite")


class Mutant(NamedTuple):
    """One edit of one file."""

    file: str
    function: str
    line: int
    text: str
    """The line as it is after the edit, or what is missing; empty where nothing is edited."""
    source: str

    @property
    def key(self) -> tuple[str, str, str]:
        return self.file, self.function, self.text


def expressions(node: ast.AST) -> Iterator[str]:
    """Yield what could stand in the place of `node`; nothing for what is not mutated."""
    match node:
        case ast.Compare(left, ops, comparators):
            words = [ast.unparse(left)]
            for op, right in zip(ops, comparators, strict=True):
                words += [SYMBOLS[type(op)], ast.unparse(right)]
            for i in range(1, len(words), 2):
                for other in COMPARISONS[words[i]]:
                    yield " ".join([*words[:i], other, *words[i + 1 :]])
        case ast.BinOp(left, op, right):
            a, b = f"({ast.unparse(left)})", f"({ast.unparse(right)})"
            yield f"({a} {ARITHMETIC[SYMBOLS[type(op)]]} {b})"
        case ast.BoolOp(op, values):
            parts = [f"({ast.unparse(v)})" for v in values]
            this, other = ("and", "or") if isinstance(op, ast.And) else ("or", "and")
            yield "(" + f" {other} ".join(parts) + ")"
            for i in range(len(parts)):
                kept = parts[:i] + parts[i + 1 :]
                yield f"({f' {this} '.join(kept)})" if len(kept) > 1 else kept[0]
        case ast.UnaryOp(ast.Not() | ast.USub(), operand):
            yield f"({ast.unparse(operand)})"
        case ast.IfExp(_, body, orelse):
            yield f"({ast.unparse(body)})"
            yield f"({ast.unparse(orelse)})"
        case ast.Constant(bool() as value):
            yield str(not value)
        case ast.Constant(int() as value):
            yield str(value + 1)
        case ast.Constant(float() as value):
            yield from (
                ("1.0", "-1.0") if value == 0.0 else (f"{value * f:.4g}" for f in (0.99, 1.01))
            )
        case ast.Constant(""):
            yield "'something'"
        case ast.Attribute(ast.Name(name), attribute) if name in ENUMS:
            yield from (f"{name}.{other}" for other in ENUMS[name] if other != attribute)
        case ast.Attribute(ast.Name("Rule"), attribute):
            yield "Rule.BUSY" if attribute != "BUSY" else "Rule.CLOCK"
        case ast.Attribute(ast.Name("math"), "inf"):
            yield from ("0.0", "-math.inf")
        case ast.Attribute(ast.Name("limits") | ast.Attribute(attr="limits"), attribute):
            for share in (0.99, 1.01):
                if attribute in TRIPLES:
                    yield f"tuple({share} * v for v in {ast.unparse(node)})"
                else:
                    yield f"({share} * {ast.unparse(node)})"
        case ast.Call(function, arguments):
            name = ast.unparse(function)
            if name in ("min", "max"):
                yield ast.unparse(node).replace(name, "max" if name == "min" else "min", 1)
            if name in ("abs", "replace") or name.endswith("._replace"):
                yield name.removesuffix("._replace") if not arguments else ast.unparse(arguments[0])
            if name in VARIADIC and len(arguments) > 1:
                for i in range(len(arguments)):
                    kept = [ast.unparse(a) for j, a in enumerate(arguments) if j != i]
                    yield f"{name}({', '.join(kept)})"


def statements(node: ast.stmt) -> Iterator[str]:
    """Yield the statements that could stand in the place of `node`."""
    match node:
        case ast.Return(ast.Constant("")):
            return
        case ast.Return(value) if value is not None and ast.unparse(value) != "None":
            yield "return None"
        case ast.Expr(ast.Constant()):
            return
        case ast.Assign() | ast.AugAssign() | ast.Expr() | ast.Raise() | ast.Return():
            yield "pass"


def mutants_of(file: str, source: str) -> Iterator[Mutant]:
    """Yield every mutant of one file, in the order of its lines."""
    lines = source.splitlines(keepends=True)
    starts = [sum(map(len, lines[:i])) for i in range(len(lines))]
    if not source.isascii():
        raise ValueError(f"{file}: columns count bytes, so only ASCII can be edited")

    def edited(node: ast.expr | ast.stmt, new: str, function: str) -> Mutant:
        start = starts[node.lineno - 1] + node.col_offset
        end = starts[(node.end_lineno or 0) - 1] + (node.end_col_offset or 0)
        first = starts[node.lineno - 1]
        last = source.index("\n", end)
        text = " ".join((source[first:start] + new + source[end:last]).split())
        if new == "pass":
            text = "removed: " + " ".join(source[start:end].split())
        return Mutant(file, function, node.lineno, text, source[:start] + new + source[end:])

    def visit(node: ast.AST, function: str) -> Iterator[Mutant]:
        if isinstance(node, ast.FunctionDef):
            function = node.name
        if isinstance(node, ast.stmt) and function != "module":
            yield from (edited(node, new, function) for new in statements(node))
        if isinstance(node, ast.If | ast.IfExp):
            wrong = ("True", "False") if isinstance(node, ast.If) else ()
            yield from (edited(node.test, new, function) for new in wrong)
        if isinstance(node, ast.For) and isinstance(node.iter, ast.Tuple):
            parts = [ast.unparse(e) for e in node.iter.elts]
            for i in range(len(parts)):
                kept = ", ".join(parts[:i] + parts[i + 1 :])
                yield edited(node.iter, f"({kept},)", function)
        if isinstance(node, ast.expr):
            yield from (edited(node, new, function) for new in expressions(node))
        for name, value in ast.iter_fields(node):
            if name in ("annotation", "returns", "decorator_list", "args") and not isinstance(
                node, ast.Call
            ):
                continue
            for child in value if isinstance(value, list) else [value]:
                if isinstance(child, ast.JoinedStr) or (
                    isinstance(child, ast.keyword) and (child.arg == "strict")
                ):
                    continue
                if isinstance(child, ast.AST):
                    yield from visit(child, function)

    yield from visit(ast.parse(source), "module")


def install(mutant: Mutant) -> None:
    """Put the code of `mutant` into the functions that all modules hold already."""
    module = sys.modules[f"controllers.{mutant.file.removesuffix('.py')}"]
    if module.__file__ != str(ROOT / "controllers" / mutant.file):
        raise ImportError(f"the tests import {module.__file__}, which is not mutated")
    before = dict(vars(module))
    exec(compile(mutant.source, str(module.__file__), "exec"), vars(module))  # noqa: S102
    for name, old in before.items():
        new = vars(module)[name]
        if old is new or getattr(old, "__module__", None) != module.__name__:
            continue
        pairs = [(old, new)]
        if isinstance(old, type):
            pairs = [(value, vars(new).get(key)) for key, value in vars(old).items()]
        for old_part, new_part in pairs:
            function = plain(old_part)
            if function is not None and function.__code__.co_filename == module.__file__:
                function.__code__ = plain(new_part).__code__
        setattr(module, name, old)


def plain(value: Any) -> Any:
    """Return the function behind a method or property, None for anything else."""
    value = getattr(value, "fget", getattr(value, "__func__", value))
    return value if isinstance(value, FunctionType) else None


def start(tests: list[pytest.Item], mutant: Mutant) -> int:
    """Call all tests in a forked child, up to the first that fails; return its process id."""
    sys.stdout.flush()
    pid = os.fork()
    if pid:
        return pid
    status = BROKEN
    try:
        signal.alarm(TIMEOUT_S)
        install(mutant)
        status = KILLED
        for test in tests:
            if not isinstance(test, pytest.Function):
                raise TypeError(f"{test.nodeid} is no function")
            test.obj(**(test.callspec.params if hasattr(test, "callspec") else {}))
        status = SURVIVED
    except BaseException:
        if status == BROKEN or not mutant.text:
            traceback.print_exc()
    finally:
        os._exit(status)


class Trial:
    """A pytest plugin: tests are collected once, then run for every mutant."""

    def __init__(self, mutants: list[Mutant]) -> None:
        self.mutants = mutants
        self.survivors: list[Mutant] = []

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        gc.freeze()
        gc.disable()
        for file in MUTATED:
            same = Mutant(file, "", 0, "", (ROOT / "controllers" / file).read_text("utf-8"))
            if os.waitpid(start(session.items, same), 0)[1] != SURVIVED:
                raise pytest.UsageError(f"the tests fail without any mutation of {file}")
        waiting = self.mutants[::-1]
        running: dict[int, Mutant] = {}
        while waiting or running:
            while waiting and len(running) < JOBS:
                mutant = waiting.pop()
                running[start(session.items, mutant)] = mutant
            pid, status = os.wait()
            mutant = running.pop(pid)
            if os.waitstatus_to_exitcode(status) == BROKEN:
                raise pytest.UsageError(f"could not be tried: {mutant.key}")
            if status == SURVIVED:
                self.survivors.append(mutant)
        return True


def explained() -> set[tuple[str, str, str]]:
    """Return the survivors that the document explains."""
    row = re.compile(r"^\| `(\w+\.py)` `(\w+)` \| `(.+?)` \| .+ \|$", re.MULTILINE)
    found = row.findall(DOCUMENT.read_text(encoding="utf-8")) if DOCUMENT.exists() else []
    return {(file, function, text.replace(r"\|", "|")) for file, function, text in found}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="*", help=", ".join(MUTATED))

    files = parser.parse_args().files or MUTATED
    tell = sys.stdout.write
    began = time.monotonic()
    os.chdir(ROOT)
    mutants = [
        mutant
        for file in files
        for mutant in mutants_of(file, (ROOT / "controllers" / file).read_text("utf-8"))
    ]
    trial = Trial(mutants)
    tests = [f"tests/controllers/{name}" for name in TESTS]
    options = ["-q", "-s", "--assert=plain"]
    if code := pytest.main([*options, *tests], plugins=[trial]):
        return int(code)
    survivors = trial.survivors
    known = {key for key in explained() if key[0] in files}
    unknown = [mutant for mutant in survivors if mutant.key not in known]
    for mutant in sorted(unknown):
        tell(f"SURVIVED controllers/{mutant.file}:{mutant.line} {mutant.function}: {mutant.text}\n")
    gone = known - {mutant.key for mutant in survivors}
    for file, function, text in sorted(gone):
        tell(f"EXPLAINED BUT NO SURVIVOR controllers/{file} {function}: {text}\n")
    tell(
        f"{len(mutants)} mutants: {len(mutants) - len(survivors)} killed, {len(survivors)} survive"
        f", {len(unknown)} of them unexplained; {time.monotonic() - began:.0f} s\n"
    )
    return 1 if unknown or gone else 0


if __name__ == "__main__":
    sys.exit(main())
