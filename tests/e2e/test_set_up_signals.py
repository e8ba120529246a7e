"""Who starts a service may change their mind while its caches are being made."""

import signal
import time
from pathlib import Path

from tests.cli.mocapd_process import start
from tests.cli.own_time import end_within


def test_sigterm_during_the_first_set_up_ends_it_in_two_seconds(
    clean_env: dict[str, str], tmp_path: Path
) -> None:
    empty = clean_env | {"XDG_CACHE_HOME": str(tmp_path / "cache")}
    # of what two processes make first
    locks = {"pose_database-beginning.lock", "sim-living_room-beginning.lock"}
    with start(empty, "demo") as process:
        while not locks <= {path.name for path in (tmp_path / "cache").rglob("*.lock")}:
            assert process.poll() is None, "it ended before it made anything"
            time.sleep(0.01)
        time.sleep(0.5)  # into the midst of it
        process.send_signal(signal.SIGTERM)
        _, rest = end_within(process, 2.0)
    assert process.returncode == 0
    assert "Traceback" not in rest
