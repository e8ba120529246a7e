"""`make env` and its like install the locks and nothing else, once; seen by a Python that writes down calls."""

import itertools
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.supply.lock_files import ROOT

# Stands for the Python that makes the environment and for the one in it: answers what it is asked by
# `-c` truly, except for its version, and writes down what pip is told.
_PYTHON = """#!/bin/sh
case "$1 $2" in
"-m venv") mkdir -p "$4/bin" && cp "$0" "$4/bin/python" ;;
"-m pip") shift 2; echo "$*" >> pip-calls; [ "$1" != --python ] || [ -e has-pip ] ;;
"-m ensurepip") echo ensurepip >> pip-calls; touch "$0-has-pip" ;;
"-m uv") shift 2; echo "uv $*" >> pip-calls; [ -e uv-works ] ;;
"-c import pip") [ -e "$0-has-pip" ] ;;
"-c "*) exec "{python}" -c "import sys; sys.version_info = {version}; exec(sys.argv[1])" "$2" ;;
-V*) echo "Python {version}" ;;
esac
"""


class Checkout:
    """A folder with the Makefile and what it reads."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        shutil.copytree(ROOT / "locks", folder / "locks")
        for name in ("Makefile", "pyproject.toml"):
            shutil.copy(ROOT / name, folder / name)
        self.python = folder / "a-python"
        (folder / "uv-works").touch()
        (folder / "has-pip").touch()
        self.set_version((3, 11, 9))

    def set_version(self, version: tuple[int, int, int]) -> None:
        self.python.write_text(_PYTHON.format(python=sys.executable, version=version))
        self.python.chmod(0o755)

    def make(self, target: str) -> tuple[list[str], str]:
        """What pip was told, one entry a call, and what make said."""
        calls = self.folder / "pip-calls"
        calls.unlink(missing_ok=True)
        command = ["make", target, f"PYTHON={self.python}"]
        # not as a part of the make that may be running the tests
        environment = {name: value for name, value in os.environ.items() if name[:4] != "MAKE"}
        done = subprocess.run(
            command, cwd=self.folder, env=environment, capture_output=True, text=True, check=True
        )
        return calls.read_text().splitlines() if calls.exists() else [], done.stderr


@pytest.fixture
def checkout(tmp_path: Path) -> Checkout:
    return Checkout(tmp_path)


def _locks_of(call: str) -> set[str]:
    words = call.split()
    return {after for word, after in itertools.pairwise(words) if word == "--requirement"}


def test_env_installs_the_runtime_lock_by_hash_and_the_checkout_without_downloads(
    checkout: Checkout,
) -> None:
    (uv, packages, project), _ = checkout.make("env")
    assert uv.startswith("--python ")
    assert "--require-hashes" in uv
    assert packages.startswith("uv ")
    assert "--require-hashes" in packages
    assert "--only-binary :all:" in packages
    assert _locks_of(packages) == {"locks/run.txt", "locks/build.txt"}
    assert "--no-deps" in project
    assert "--no-build-isolation" in project
    assert project.endswith("--editable .")


def test_dev_installs_the_developers_lock_and_env_has_nothing_left_to_do(
    checkout: Checkout,
) -> None:
    (uv, packages, project, pip), _ = checkout.make("dev")
    assert pip == "ensurepip"
    assert "--require-hashes" in uv
    assert packages.startswith("uv ")
    assert "--require-hashes" in packages
    assert "--only-binary :all:" in packages
    assert _locks_of(packages) == {"locks/dev.txt"}
    assert "--no-deps" in project
    assert checkout.make("dev") == ([], "")
    assert checkout.make("env") == ([], "")


def test_the_tests_of_clients_have_an_environment_of_their_own(checkout: Checkout) -> None:
    checkout.make("dev")
    (_, packages, project, _), _ = checkout.make("clients")
    assert "--require-hashes" in packages
    assert _locks_of(packages) == {"locks/clients.txt"}
    assert "--no-deps" in project
    assert (checkout.folder / ".venv-clients" / "bin" / "python").exists()
    assert checkout.make("clients") == ([], "")
    assert checkout.make("dev") == ([], "")


def test_uv_is_installed_as_the_lock_has_it(checkout: Checkout) -> None:
    (uv, *_), _ = checkout.make("dev")
    (path,) = _locks_of(uv)
    lines = (checkout.folder / path).read_text().splitlines()
    assert lines[0].startswith("uv==")
    assert all(line.startswith("    ") for line in lines[1:])
    assert "\n".join(lines) in (ROOT / "locks" / "dev.txt").read_text()


@pytest.mark.parametrize(
    ("target", "locks"),
    [("dev", {"locks/dev.txt"}), ("env", {"locks/run.txt", "locks/build.txt"})],
)
def test_where_uv_gets_nowhere_pip_installs_the_lock(
    checkout: Checkout, target: str, locks: set[str]
) -> None:
    (checkout.folder / "uv-works").unlink()
    (_, tried, pip, packages, project), _ = checkout.make(target)
    assert tried.startswith("uv ")
    assert pip == "ensurepip"
    assert packages.startswith("install ")
    assert "--require-hashes" in packages
    assert "--only-binary :all:" in packages
    assert _locks_of(packages) == locks
    assert "--no-deps" in project


def test_where_python_has_no_pip_the_environment_gets_one(checkout: Checkout) -> None:
    (checkout.folder / "has-pip").unlink()
    (tried, pip, uv, packages, project), _ = checkout.make("env")
    assert tried.startswith("--python ")
    assert pip == "ensurepip"
    assert uv.startswith("install ")
    assert "--require-hashes" in uv
    assert packages.startswith("uv ")
    assert project.startswith("uv ")


def test_of_a_python_that_the_lock_is_for_the_latest_gets_it_too(checkout: Checkout) -> None:
    checkout.set_version((3, 14, 0))
    (_, packages, _), told = checkout.make("env")
    assert "--require-hashes" in packages
    assert "pip chooses" not in told


def test_dev_adds_to_env(checkout: Checkout) -> None:
    checkout.make("env")
    assert _locks_of(checkout.make("dev")[0][1]) == {"locks/dev.txt"}


@pytest.mark.parametrize("changed", ["pyproject.toml", "locks/run.txt", "locks/build.txt"])
def test_a_changed_lock_or_project_makes_the_environment_anew(
    checkout: Checkout, changed: str
) -> None:
    checkout.make("dev")
    path = checkout.folder / changed
    before = path.read_text()
    path.write_text(before + "# changed\n")
    assert checkout.make("env")[0]
    # and what was added by the lock of before is not taken for ready when that lock comes back
    path.write_text(before)
    assert checkout.make("dev")[0]


def test_a_python_the_lock_is_not_for_gets_what_pip_chooses_and_is_told(checkout: Checkout) -> None:
    checkout.set_version((3, 15, 0))
    calls, said = checkout.make("env")
    assert [call.split("--")[-1] for call in calls] == ["ensurepip", "editable .[print]"]
    assert "locks/" not in calls[1]
    told = [line for line in said.splitlines() if "pip chooses" in line]
    assert len(told) == 1
    assert "3.11 to 3.14" in told[0]
    assert [call.split("--")[-1] for call in checkout.make("dev")[0]] == ["editable .[all,dev]"]


def test_what_ci_runs_installs_packages_by_make_alone() -> None:
    ci = (ROOT / ".ci" / "run").read_text()
    assert "pip install" not in ci
    assert "make check" in ci
    assert "make test\n" in ci
    assert "make test-clients\n" in ci


@pytest.mark.parametrize(
    ("target", "environment"),
    [
        *(("demo", "env"), ("bench", "env"), ("test", "dev"), ("check", "dev"), ("lock", "dev")),
        ("test-clients", "clients"),
    ],
)
def test_each_target_makes_the_environment_it_needs(target: str, environment: str) -> None:
    rules = (ROOT / "Makefile").read_text().splitlines()
    assert any(rule.startswith(f"{target}: {environment} ## ") for rule in rules)


def test_dist_builds_what_is_handed_on_of_every_client() -> None:
    rules = (ROOT / "Makefile").read_text()
    recipe = rules[rules.index("\ndist:") :].split("\n\n")[0]
    assert {f"cd clients/{name} && " in recipe for name in ("python", "goalkeeper")} == {True}
    assert "clients/pack.py dist" in recipe
