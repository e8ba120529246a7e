"""The notification socket as a service manager sees it."""

import os
import secrets
from collections.abc import Iterator
from pathlib import Path

import pytest

from mocapd.app.daemon.notifier import Notifier
from mocapd.clock import monotonic_ns
from mocapd.errors import UnavailableError
from tests.app.daemon.manager import Manager

ALWAYS_DUE_NS = 1


@pytest.fixture(params=["path", "abstract"])
def manager(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Manager]:
    place = tmp_path / "notify" if request.param == "path" else f"@mocapd-{secrets.token_hex(8)}"
    one = Manager(place)
    yield one
    one.close()


def test_ready_says_so_with_a_line_for_people(manager: Manager) -> None:
    Notifier(manager.address).ready("waiting")
    assert manager.waiting() == [{"READY": "1", "STATUS": "waiting"}]


def test_a_state_is_told_when_it_is_another_one(manager: Manager) -> None:
    notifier = Notifier(manager.address)
    notifier.ready("waiting")
    for text in ("waiting", "one", "one", "two", "one"):
        notifier.status(text)
    assert [one["STATUS"] for one in manager.waiting()] == ["waiting", "one", "two", "one"]


def test_a_camera_cannot_speak_for_the_daemon(manager: Manager) -> None:
    """What it calls itself stands in the state."""
    notifier = Notifier(manager.address)
    notifier.ready("cam\nSTOPPING=1")
    notifier.status("cam\nWATCHDOG=trigger\0\x1b[2J")
    ready, state = manager.waiting()
    assert ready == {"READY": "1", "STATUS": "cam STOPPING=1"}
    assert state == {"STATUS": "cam WATCHDOG=trigger  [2J"}


def test_a_reload_begins_with_its_time_and_ends_with_ready(manager: Manager) -> None:
    notifier = Notifier(manager.address)
    before_us = monotonic_ns() // 1000
    notifier.reloading()
    notifier.end_reload()
    begun, over = manager.waiting()
    assert begun["RELOADING"] == "1"
    assert before_us <= int(begun["MONOTONIC_USEC"]) <= monotonic_ns() // 1000
    assert over == {"READY": "1"}


def test_the_end_is_told_once(manager: Manager) -> None:
    notifier = Notifier(manager.address)
    notifier.stopping()
    notifier.stopping()
    assert [one["STOPPING"] for one in manager.waiting()] == ["1"]


def test_the_time_limit_is_stretched_and_set_back(manager: Manager) -> None:
    notifier = Notifier(manager.address, watchdog_ns=30 * 10**9)
    notifier.extend_watchdog(600.0)
    notifier.restore_watchdog()
    assert manager.waiting() == [
        {"WATCHDOG_USEC": "600000000"},
        {"WATCHDOG_USEC": "30000000", "WATCHDOG": "1"},
    ]
    assert not notifier.is_heartbeat_due
    unlimited = Notifier(manager.address)
    unlimited.extend_watchdog(600.0)
    unlimited.restore_watchdog()
    assert not unlimited.is_heartbeat_due
    assert manager.waiting() == []


def test_more_patience_than_is_given_is_not_taken_away(manager: Manager) -> None:
    Notifier(manager.address, watchdog_ns=3600 * 10**9).extend_watchdog(600.0)
    assert manager.waiting() == [{"WATCHDOG_USEC": "3600000000"}]


@pytest.mark.parametrize(
    ("pid", "limited"), [("ours", True), ("", True), ("1", False), ("x", False)]
)
def test_the_variables_are_taken_and_a_limit_for_another_process_is_not_ours(
    manager: Manager, pid: str, limited: bool
) -> None:
    env = {"NOTIFY_SOCKET": manager.address, "WATCHDOG_USEC": "4000000", "HOME": "/"}
    env |= {"WATCHDOG_PID": pid.replace("ours", str(os.getpid()))} if pid else {}
    notifier = Notifier.of_environment(env)
    assert env == {"HOME": "/"}
    notifier.restore_watchdog()
    assert bool(manager.waiting()) == limited


@pytest.mark.parametrize("limit", ["", "0", "-1", "soon", "²", "9" * 5000])
def test_no_limit_that_makes_sense_is_none(manager: Manager, limit: str) -> None:
    env = {"NOTIFY_SOCKET": manager.address, "WATCHDOG_USEC": limit}
    assert not Notifier.of_environment(env).is_heartbeat_due


def test_without_a_manager_everything_goes_to_nobody() -> None:
    notifier = Notifier.of_environment({})
    notifier.ready("")
    notifier.status("x")
    notifier.reloading()
    notifier.end_reload()
    notifier.heartbeat()
    notifier.stopping()
    notifier.close()
    assert not notifier.is_heartbeat_due


@pytest.mark.parametrize("address", ["vsock:2:1", "/nowhere/at/all", "/" + 200 * "x", "/a\0b"])
def test_a_socket_that_cannot_be_is_an_error_that_says_so(address: str) -> None:
    with pytest.raises(UnavailableError, match="unset it"):
        Notifier(address)


def test_a_manager_that_is_gone_does_not_end_a_daemon_that_was_ready(manager: Manager) -> None:
    notifier = Notifier(manager.address, ALWAYS_DUE_NS)
    notifier.ready("")
    manager.close()
    notifier.status("nobody hears it")
    notifier.heartbeat()
    notifier.end_reload()
    notifier.stopping()
    with pytest.raises(UnavailableError, match="does not take that mocapd is ready"):
        notifier.ready("")
