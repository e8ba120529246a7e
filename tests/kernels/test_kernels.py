"""Which compiled code is still good, and the table of what a first start compiles."""

import ast
import dis
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numba
import numpy as np
import pytest

import mocapd
from mocapd.body.arrays import SkinArrays
from mocapd.body.posing_kernels import quat_exp
from mocapd.errors import MalformedError
from mocapd.kernels.callees import _codes, _global_names, content_of
from mocapd.kernels.kernel_table import callees_of_rows, read_table, rows_of
from mocapd.kernels.locator import KernelLocator
from mocapd.kernels.type_codes import decode, encode

typeof: Any = numba.typeof  # it carries no types

CALLEE = """\
from numba import njit
SCALE = {scale}
@njit(cache=True)
def scaled(x):
    '''{words}'''
    return {term} * SCALE
"""
CALLER = """\
from numba import njit
from mocapd.{callee}_kernels import scaled
@njit(cache=True{option})
def twice(x):
    return 2.0 * scaled(x)
"""
# Each version is used in a process of its own, forked where numba is imported and no kernel is known.
PROGRAM = """\
import os
import sys
from pathlib import Path
folder, cache = Path(sys.argv[1]), Path(sys.argv[2])
from mocapd.app.libraries import use_cache_dir
os.environ["NUMBA_CACHE_DIR"] = str(cache / "numba")
use_cache_dir(cache)
import mocapd
import mocapd.kernels.locator as locator
mocapd.__path__.append(str(folder))
locator._PACKAGE = folder
from lab.compile_events import compile_events

def use():
    from mocapd.caller_kernels import twice
    with compile_events() as compiled:
        result = twice(3.0)
    print(result, *sorted(one.function for one in compiled if one.module.startswith("mocapd.")), end="")
    if not compiled and "scipy.linalg" in sys.modules:
        print(" with what only compiling needs, for a fifth of a second", end="")
    print(flush=True)

for _ in sys.stdin:
    if os.fork() == 0:
        use()
        os._exit(0)
    if os.wait()[1]:
        sys.exit("a version's process ended badly")
"""


class Kernels:
    """Two modules of kernels, one of which calls the other, as an upgrade may change them."""

    def __init__(self, folder: Path) -> None:
        self.folder, cache = folder / "mocapd", folder / "cache"
        self.folder.mkdir()
        command = [sys.executable, "-B", "-c", PROGRAM, str(self.folder), str(cache)]
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def __enter__(self) -> "Kernels":
        return self

    def __exit__(self, *_: object) -> None:
        with self._process as process:  # its input ends
            process.communicate()

    def said(
        self,
        scale: int = 1,
        words: str = "",
        term: str = "x",
        option: str = "",
        above: str = "",
        callee: str = "callee",
    ) -> str:
        for old in self.folder.glob("*_kernels.py"):
            old.unlink()
        (self.folder / f"{callee}_kernels.py").write_text(
            above + CALLEE.format(scale=scale, words=words, term=term)
        )
        (self.folder / "caller_kernels.py").write_text(CALLER.format(option=option, callee=callee))
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write("\n")
        self._process.stdin.flush()
        return self._process.stdout.readline().strip()


def test_code_is_kept_until_a_kernel_or_one_that_it_calls_changes(tmp_path: Path) -> None:
    """Also where the callee is of another file, or only a constant or an option differs; words change nothing. Kept code is
    loaded without scipy's linear algebra."""
    with Kernels(tmp_path) as kernels:
        assert kernels.said() == "6.0 scaled twice"
        assert kernels.said(words="Other words.", above="# a comment\n\n") == "6.0"
        assert kernels.said(scale=2) == "12.0 scaled twice"
        assert kernels.said(term="(x + 1.0)") == "8.0 scaled twice"
        assert kernels.said(option=", fastmath=True") == "6.0 twice"
        assert kernels.said() == "6.0"  # an earlier version's is there still
        # the caller's code names its module
        assert kernels.said(callee="moved") == "6.0 scaled twice"


def test_the_trackers_kernels_use_nothing_of_numpy_that_takes_long_to_compile_and_to_load() -> None:
    """Sums, products, sorting and comparing of whole arrays are compiled from Python, a second each, and their kept code
    imports scipy's linear algebra: kernels have loops instead."""
    known = set(vars(np)) | set(dir(np.ndarray))
    used = {
        name
        for row in rows_of(read_table(), {"shirt", "clothes", "auto"})
        for code in _codes(row.dispatcher.py_func.__code__)
        for name in code.co_names
        if name in known and name not in row.dispatcher.py_func.__globals__
    }
    builtin = {"abs", "float", "int", "len", "max", "min", "range", "round"}
    types = {"bool_", "float32", "int32", "int64", "uint8", "uint64"}
    numbers = {"arctan2", "ceil", "copysign", "cos", "exp", "floor", "inf", "log", "sin", "sqrt"}
    arrays = {"array", "copy", "empty", "full", "ravel", "reshape", "shape", "view", "zeros"}
    assert used <= builtin | types | numbers | arrays


def test_code_is_not_kept_for_a_named_tuple_that_has_moved() -> None:
    def made_of(module: str) -> Any:
        class Inner(NamedTuple):
            x: float

        class Outer(NamedTuple):
            inner: Inner

        def kernel(one: Outer) -> float:
            return one.inner.x

        Inner.__module__ = module
        return kernel

    assert content_of(made_of("a")) == content_of(made_of("a"))
    assert content_of(made_of("a")) != content_of(made_of("b"))


def test_code_of_versions_that_are_gone_is_removed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """After a month: until then a checkout may come back to them."""
    monkeypatch.setattr(numba.core.config, "CACHE_DIR", str(tmp_path))
    function = quat_exp.py_func
    locator = KernelLocator.from_function(function, function.__code__.co_filename)
    assert locator is not None
    folder = Path(locator.get_cache_path())
    own = folder / f"posing_kernels.quat_exp-{locator.get_disambiguator()}.py311.nbi"
    names = (
        "posing_kernels.quat_exp-29.py311.nbi",
        "posing_kernels.quat_exp-29.py311.1.nbc",
        "posing_kernels.quat_log-9.py311.nbi",
    )
    for path in (own, *(folder / name for name in names)):
        path.touch()
    locator.remove_old(time.time() + 29 * 86400.0)
    assert len([*folder.iterdir()]) == 4
    locator.remove_old(time.time() + 31 * 86400.0)
    assert {path.name for path in folder.iterdir()} == {own.name, names[2]}


@pytest.mark.parametrize(
    "value",
    [
        *(
            1.5,
            3,
            True,
            None,
            np.float32(1),
            np.zeros((2, 3)),
            np.zeros(4, np.uint8),
            np.zeros((4, 4))[:, ::2],
        ),
        *((1.0, 2), (np.zeros(2), np.zeros((2, 2), np.int32))),
        SkinArrays(np.zeros((2, 2), np.int32), np.zeros((2, 2))),
    ],
    ids=repr,
)
def test_an_argument_type_comes_back_from_its_code(value: object) -> None:
    assert decode(encode(typeof(value))) == typeof(value)


@pytest.mark.parametrize(
    "code", ["float65", "float64[2X]", {"named": "mocapd.body.arrays:Nobody", "of": []}, {}]
)
def test_a_code_that_names_nothing_is_an_error(code: object) -> None:
    with pytest.raises(MalformedError):
        decode(code)  # type: ignore[arg-type]


def test_the_table_names_kernels_that_there_are_callees_first() -> None:
    """Made by `python -m lab.kernel_seconds --write`: do that when a kernel of it is renamed or takes other arguments."""
    rows = read_table()
    for row in rows:
        assert row.dispatcher.py_func.__name__ == row.function
        assert row.arguments
        assert 0.0 <= row.seconds < 60.0
    after = callees_of_rows(rows)
    callers = {
        rows[i].function: {rows[j].function for j in earlier} for i, earlier in enumerate(after)
    }
    assert "quat_multiply" in callers["follow_bones"]
    assert {"film", "database", "shirt", "clothes", "auto"} == {
        stage for row in rows for stage in row.stages
    }
    assert 0 < len(rows_of(rows, ["shirt"])) < len(rows)


def test_the_globals_of_a_kernel_are_those_that_dis_names() -> None:
    rows = rows_of(read_table(), {"shirt", "clothes", "auto", "film", "database"})
    codes = [code for row in rows for code in _codes(row.dispatcher.py_func.__code__)]
    codes += _codes(compile(Path(__file__).read_text("utf-8"), __file__, "exec"))
    # more names than a byte counts
    codes += _codes(compile("def f():\n" + "".join(f" n{i}\n" for i in range(300)), "many", "exec"))
    for code in codes:
        loads = (one for one in dis.get_instructions(code) if one.opname == "LOAD_GLOBAL")
        assert list(_global_names(code)) == [one.argval for one in loads]
    assert len(codes) > len(rows) > 100


def test_no_kernel_assigns_an_array() -> None:
    """To a part of another: numba would compile what words the error of unequal shapes, for two seconds in each process.
    What is assigned to a slice is a constant."""
    found = [
        f"{path.name}:{node.lineno}"
        for path in Path(mocapd.__file__).parent.rglob("*_kernels.py")
        for node in ast.walk(ast.parse(path.read_text("utf-8")))
        if isinstance(node, ast.Assign)
        and isinstance(node.targets[0], ast.Subscript)
        and any(isinstance(part, ast.Slice) for part in ast.walk(node.targets[0].slice))
        and any(
            isinstance(name, ast.Name) and name.id.islower() for name in _outside_calls(node.value)
        )
    ]
    assert not found


def _outside_calls(value: ast.expr) -> Iterator[ast.AST]:
    """The parts of an expression but what functions take: `np.float32(limit)` is one number."""
    if not isinstance(value, ast.Call | ast.Attribute):
        yield value
        for child in ast.iter_child_nodes(value):
            if isinstance(child, ast.expr):
                yield from _outside_calls(child)
