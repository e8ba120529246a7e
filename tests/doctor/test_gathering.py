"""What is asked of the machine: its folders, its processor, its calibration; and the command over all of it."""

import json
import multiprocessing
import os
import socket
from collections.abc import Callable
from dataclasses import replace
from multiprocessing.queues import SimpleQueue
from pathlib import Path

import pytest

from mocapd.calibration.calibration_file import FILE_NAME
from mocapd.calibration.calibration_writing import write_calibration
from mocapd.config.runtime_folder import runtime_folder
from mocapd.config.sections import CameraSection, Config, WebSection
from mocapd.control.socket_place import sockets_in
from mocapd.doctor.checks.storage_checks import check_ports
from mocapd.doctor.checks.system_checks import check_ownership
from mocapd.doctor.facts import PreparationFacts, UserFacts
from mocapd.doctor.finding import Verdict
from mocapd.doctor.gathering.calibration_facts import calibration_facts
from mocapd.doctor.gathering.camera_facts import wanted_cameras
from mocapd.doctor.gathering.folder_facts import folder_facts
from mocapd.doctor.gathering.port_facts import port_facts
from mocapd.doctor.gathering.preparation_facts import preparation_facts
from mocapd.doctor.gathering.system_facts import (
    clock_facts,
    processor_facts,
    state_facts,
    user_facts,
)
from mocapd.file_lock import one_at_a_time
from mocapd.outputs.output_table import ZenohSection
from mocapd.session.prepared_marker import LOCK, remember
from mocapd.web.runtime_file import running
from tests.calibration.test_calibration_file import pictures, saved_calibration
from tests.cli.mocapd_process import Outcome, mocapd_here

Run = Callable[..., Outcome]


@pytest.fixture
def run(empty_home: Path) -> Run:
    return lambda *words: mocapd_here(dict(os.environ), *words)


def test_a_calibration_is_looked_at_as_a_daemon_would(tmp_path: Path) -> None:
    config = Config(state_dir=tmp_path)
    assert calibration_facts(config)[0].path is None
    path = tmp_path / FILE_NAME
    write_calibration(path, saved_calibration(), pictures())
    facts, saved = calibration_facts(config)
    assert (facts.path, facts.cameras, facts.rms_px, facts.play_area_cm) == (path, 2, 0.4, 0.3)
    assert facts.age_s > 0.0
    assert [one.id for one in wanted_cameras(config, saved)] == ["left", "right/2"]
    own = replace(config, camera=(CameraSection("cam", "http://me:secret@camera/"),))
    assert [one.source for one in wanted_cameras(own, saved)] == ["http://me:***@camera/"]
    path.write_text("schema = 99\n")
    facts, saved = calibration_facts(config)
    assert facts.trouble is not None
    assert "schema 99" in facts.trouble.what
    assert saved is None


def test_a_rig_file_that_is_missing_is_a_trouble(tmp_path: Path) -> None:
    facts, saved = calibration_facts(Config(state_dir=tmp_path, rig=tmp_path / "rig.json"))
    assert facts.trouble is not None
    assert saved is None


def test_folders_are_looked_at_and_not_made(
    empty_home: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    config = Config(cache_dir=empty_home / "deep" / "cache", state_dir=empty_home / "state")
    cache, state, runtime = folder_facts(config)
    assert not cache.path.exists()
    assert cache.trouble is None
    assert cache.free_bytes
    assert (state.open_to_others, runtime.trouble) == (False, None)
    state.path.chmod(0o755)
    config.cache_dir.mkdir(parents=True)
    config.cache_dir.chmod(0o777)
    cache, state, _ = folder_facts(config)
    assert state.open_to_others
    assert cache.trouble is not None
    assert "can be written by others" in cache.trouble.what


def test_what_lies_in_a_folders_place_is_a_trouble(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    (tmp_path / "unmounted").symlink_to(tmp_path / "nowhere")
    for path in (tmp_path / "file", tmp_path / "unmounted", tmp_path / "file" / "mocapd"):
        cache, state, _ = folder_facts(Config(cache_dir=path, state_dir=path))
        for facts in (cache, state):
            assert facts.trouble is not None
            assert "is no folder" in facts.trouble.what


def test_a_runtime_folder_that_may_not_be_looked_into_ends_no_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # such as that of the user from whom `su` was called; too long a name fails alike, and for root as well
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path / ("x" * 300)))
    monkeypatch.delenv("RUNTIME_DIRECTORY", raising=False)
    folder = runtime_folder(tmp_path)
    assert sockets_in(folder) == ()
    assert running(folder) == ()
    *_, runtime = folder_facts(Config(cache_dir=tmp_path, state_dir=tmp_path))
    assert runtime.path == folder


def test_who_has_a_port_that_is_wanted() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        config = Config(outputs={"zenoh": ZenohSection(port=port)}, web=WebSection(port=port))
        zenoh, web = port_facts(config)
    assert f"(pid {os.getpid()})" in zenoh.holder
    assert (zenoh.key, web.key) == ("zenoh.port", "web.port")
    assert port_facts(Config(outputs={"zenoh": ZenohSection(connect=("tcp/127.0.0.1:1",))})) == ()


def _said_by_nobody(asked: "SimpleQueue[int]", told: "SimpleQueue[str]") -> None:
    os.setuid(65534)
    port = asked.get()
    config = Config(outputs={"zenoh": ZenohSection(port=port)}, web=WebSection(enabled=False))
    told.put("; ".join(f"{one.verdict} {one.what}" for one in check_ports(port_facts(config), ())))


@pytest.mark.skipif(os.geteuid() != 0, reason="only root may become somebody else")
def test_a_port_that_another_users_daemon_has_is_not_free() -> None:
    fork = multiprocessing.get_context("fork")
    asked, told = fork.SimpleQueue(), fork.SimpleQueue()
    child = fork.Process(target=_said_by_nobody, args=(asked, told))
    child.start()  # before there is a socket that it would share
    with socket.create_server(("127.0.0.1", 0)) as server:
        asked.put(server.getsockname()[1])
        child.join()
    assert told.get() == "bad a process of another user has it, and zenoh.port wants it"


def test_the_processor_is_read_from_sysfs(tmp_path: Path) -> None:
    for number, governor in enumerate(("powersave", "powersave", "performance")):
        folder = tmp_path / f"devices/system/cpu/cpu{number}/cpufreq"
        folder.mkdir(parents=True)
        (folder / "scaling_governor").write_text(f"{governor}\n")
        (folder / "scaling_driver").write_text("acpi-cpufreq\n")
    facts = processor_facts(tmp_path)
    assert facts.governors == {"powersave": 2, "performance": 1}
    assert facts.driver == "acpi-cpufreq"
    assert facts.cores == len(os.sched_getaffinity(0))
    assert processor_facts(tmp_path / "nothing").governors == {}


def test_user_and_clock_are_this_process_own() -> None:
    assert user_facts().is_root == (os.geteuid() == 0)
    facts = clock_facts()
    assert facts.now_unix_s > facts.built_unix_s


def test_root_is_told_of_the_services_whose_state_it_does_not_look_at(tmp_path: Path) -> None:
    root, somebody = UserFacts("root", True, frozenset()), UserFacts("me", False, frozenset())
    config = Config(state_dir=tmp_path / "root")
    assert state_facts(config, root, tmp_path).of_services == ()
    (tmp_path / "mocapd-rigs/hall").mkdir(parents=True)
    (tmp_path / "private/mocapd").mkdir(parents=True)
    (tmp_path / "mocapd").symlink_to("private/mocapd")
    states = state_facts(config, root, tmp_path)
    assert states.of_services == (tmp_path / "mocapd", tmp_path / "mocapd-rigs/hall")
    (found,) = check_ownership(root, states)
    assert found.verdict is Verdict.WARN
    assert str(tmp_path / "root") in found.what
    assert str(tmp_path / "mocapd-rigs/hall") in found.what
    assert found.fix.startswith("sudo mocapd as-service doctor")
    assert not [*check_ownership(somebody, state_facts(config, somebody, tmp_path))]
    as_service = Config(state_dir=tmp_path / "private/mocapd")
    assert state_facts(as_service, root, tmp_path).of_services == (tmp_path / "mocapd-rigs/hall",)


def test_the_command_prints_a_line_for_each_and_ends_with_1_when_one_is_bad(
    run: Run, empty_home: Path
) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        taken = f"zenoh.port={port}"
        done = run("doctor", "--set", taken, "--json")
    lines = [json.loads(line) for line in done.out.splitlines()]
    assert done.code == 1
    bad = [one for one in lines if one["verdict"] == "bad"]
    assert [one["about"] for one in bad] == [f"port {port}"]
    assert all(one["fix"] for one in lines if one["verdict"] != "ok")
    assert {"config", "daemon", "rights", "webcam", "calibration", "processor", "clock"} <= {
        one["about"] for one in lines
    }
    text = run("doctor", "--set", f"zenoh.port={port}")
    assert text.code == 0
    assert "warn  calibration" in text.out
    assert "mocapd calibrate" in text.out


def test_a_wrong_configuration_is_a_line_of_its_own(run: Run, empty_home: Path) -> None:
    file = empty_home / "config.toml"
    file.write_text("[smoothing]\npreset = 'nonsense'\n")
    done = run("doctor", "--config", str(file))
    assert done.code == 1
    first = done.out.splitlines()[0]
    assert first.startswith("bad")
    assert "smoothing.preset" in first
    assert "one of: off" in first


def test_what_is_prepared_now_or_was_is_found(tmp_path: Path) -> None:
    config = Config(cache_dir=tmp_path / "cache")
    assert preparation_facts(config) == PreparationFacts(done=False)
    with one_at_a_time(config.cache_dir, LOCK):
        assert preparation_facts(config) == PreparationFacts(done=False, under_way=True)
    remember(config)
    assert preparation_facts(config) == PreparationFacts(done=True)
