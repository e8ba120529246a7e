"""What a running daemon takes up of a changed configuration, and what it keeps and says so."""

from mocapd.app.daemon.session_change import apply_live_changes
from mocapd.config.effective import load_config
from mocapd.config.sections import Config


def config_of(**flags: str) -> Config:
    given = {key.replace("__", "."): text for key, text in flags.items()}
    return load_config(given, env={}, candidates=()).config


RUNNING = config_of(instance="hall", web__port="8000")


def test_tracker_smoothing_and_cameras_change_at_once() -> None:
    wanted = config_of(
        instance="hall",
        web__port="8000",
        smoothing__preset="smooth",
        tracker__stature_m="1.6",
        camera='[{id = "a", source = "/dev/video0"}]',
    )
    assert apply_live_changes(RUNNING, wanted) == (wanted, ())


def test_outputs_page_name_and_folders_wait_for_the_next_start_each_by_its_name() -> None:
    wanted = config_of(
        instance="gym", osc__enabled="false", state_dir="elsewhere", smoothing__preset="off"
    )
    config, waiting = apply_live_changes(RUNNING, wanted)
    assert waiting == ("instance", "state_dir", "web", "osc")
    assert config.instance == "hall"
    assert config.outputs == RUNNING.outputs
    assert config.web == RUNNING.web
    assert config.smoothing.preset == "off"
