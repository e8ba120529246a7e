"""Two daemons with one state folder: the later one says what may be lost."""

import os
from pathlib import Path

import pytest

from mocapd.app.daemon import shared_state
from mocapd.app.daemon.shared_state import warn_if_shared
from mocapd.config.sections import Config
from mocapd.control.control_client import FoundDaemons, RunningDaemon
from tests.control.reports import report


@pytest.mark.parametrize(
    ("pid", "folder", "warns"), [(1, "state", True), (1, "other", False), (None, "state", False)]
)
def test_another_daemon_of_the_same_state_folder_is_named(
    pid: int | None,
    folder: str,
    warns: bool,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    status = report(instance="cave", pid=pid or os.getpid(), state_dir=str(tmp_path / folder))
    found = FoundDaemons((RunningDaemon(tmp_path / "control-1.sock", status),))
    monkeypatch.setattr(shared_state, "find_daemons", lambda _config: found)
    warn_if_shared(Config(state_dir=tmp_path / "state"))
    assert ("the daemon 'cave' (pid 1) too" in caplog.text) is warns
