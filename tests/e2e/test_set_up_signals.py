"""Who starts a service may change their mind while its caches are being made."""

import signal
from pathlib import Path

from tests.cli.mocapd_process import start
from tests.cli.own_time import end_within


def test_sigterm_during_the_first_set_up_ends_it_in_two_seconds(
    clean_env: dict[str, str], tmp_path: Path
) -> None:
    empty = clean_env | {"XDG_CACHE_HOME": str(tmp_path / "cache")}
    with start(empty, "demo") as process:
        assert process.stderr is not None
        told = process.stderr.readline()
        while "pose database" not in told and "rendering" not in told:  # what is being made
            assert told, "it ended before it made anything"
            told = process.stderr.readline()
        process.send_signal(signal.SIGTERM)
        _, rest = end_within(process, 2.0)
    assert process.returncode == 0
    assert "Traceback" not in rest
