"""What is made once is made in a process that ends, and remembered."""

import socket
from pathlib import Path

from tests.cli.mocapd_process import Outcome, mocapd
from tests.cli.small_capture import write_capture


def run(env: dict[str, str], capture: Path, *words: str) -> Outcome:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        port = one.getsockname()[1]
    setting = ("--set", f"zenoh.port={port}")
    return mocapd(env, "run", "--capture", capture, "--tracker", "canned", *setting, *words)


def test_a_start_that_was_prepared_is_not_prepared_again(
    clean_env: dict[str, str], tmp_path: Path
) -> None:
    capture, cache = write_capture(tmp_path / "capture"), tmp_path / "cache"
    told = []
    for _ in range(2):
        outcome = run(clean_env, capture, "--set", f"cache_dir={cache}")
        assert outcome.code == 0, outcome.err
        told.append((cache / "prepared").read_text().split())
    assert len(told[0]) == 1
    assert told[1] == told[0]


def test_trouble_in_the_first_start_is_told_once(clean_env: dict[str, str], tmp_path: Path) -> None:
    capture, cache = write_capture(tmp_path / "capture"), tmp_path / "cache"
    outcome = run(clean_env, capture, "--set", f"cache_dir={cache}", "--rig", str(tmp_path / "no"))
    assert outcome.code != 0
    assert outcome.err.count("mocapd: ") == 1
    assert "Traceback" not in outcome.err
    assert not (cache / "prepared").exists()
