"""The command lines of messages: a system service's are run as its user."""

import pytest

from mocapd.user_command import user_command

PREFIX = "sudo mocapd as-service"


@pytest.mark.parametrize(
    ("state", "expected"),
    [
        (None, "mocapd calibrate --step room"),
        ("/home/ann/.local/state/mocapd", "mocapd calibrate --step room"),  # a service of the user
        ("/var/lib/mocapd", f"{PREFIX} calibrate --step room"),
        ("/var/lib/private/mocapd", f"{PREFIX} calibrate --step room"),
        ("/var/lib/mocapd-rigs/hall", f"{PREFIX} --rig hall calibrate --step room"),
    ],
)
def test_a_system_service_names_the_command_that_runs_as_it(
    monkeypatch: pytest.MonkeyPatch, state: str | None, expected: str
) -> None:
    monkeypatch.delenv("STATE_DIRECTORY", raising=False)
    if state is not None:
        monkeypatch.setenv("STATE_DIRECTORY", state)
    assert user_command("calibrate --step room") == expected


def test_a_program_outside_of_the_shells_path_is_named_by_its_own(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("STATE_DIRECTORY", "/var/lib/mocapd")
    wanted = "sudo /opt/mocapd/bin/mocapd as-service calibrate"
    assert user_command("calibrate", "/opt/mocapd/bin/mocapd") == wanted
