"""Names of trackers and keys that a configuration of before may still hold."""

from pathlib import Path

import pytest

from mocapd.config.config_keys import entry_keys
from mocapd.config.effective import load_config
from mocapd.config.removed_keys import REMOVED
from mocapd.errors import ConfigError
from mocapd.trackers.registry import RENAMED, TRACKERS
from tests.config.test_config import load


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "config.toml"


@pytest.mark.parametrize(("former", "present"), list(RENAMED.items()))
def test_a_former_name_of_a_tracker_is_taken_for_the_present_one_with_one_warning(
    file: Path, caplog: pytest.LogCaptureFixture, former: str, present: str
) -> None:
    loaded = load(file, f'[tracker]\nname = "{former}"\n')
    assert loaded.config.tracker.name == present
    assert next(s.value for s in loaded.settings if s.key.path == "tracker.name") == present
    (line,) = caplog.messages
    assert line.startswith(f"{file}:2: ")
    assert repr(former) in line
    assert repr(present) in line


def test_every_former_name_of_a_tracker_leads_to_one_that_exists() -> None:
    assert set(RENAMED.values()) <= set(TRACKERS)
    assert not set(RENAMED) & set(TRACKERS)


def test_the_present_name_of_a_tracker_brings_no_warning(
    file: Path, caplog: pytest.LogCaptureFixture
) -> None:
    assert load(file, '[tracker]\nname = "wang2011"\n').config.tracker.name == "wang2011"
    assert not caplog.messages


@pytest.mark.parametrize("key", REMOVED)
def test_a_removed_key_says_what_to_do_wherever_it_is_given(file: Path, key: str) -> None:
    file.write_text(f"{key} = 1\n")
    variable = f"MOCAPD_{key.replace('.', '_').upper()}"
    sources: tuple[tuple[dict[str, str], Path | None, dict[str, str]], ...] = (
        ({key: "1"}, None, {}),
        ({}, file, {}),
        ({}, None, {variable: "1"}),
    )
    for flags, path, env in sources:
        with pytest.raises(ConfigError) as caught:
            load_config(flags, path, env, candidates=())
        assert key in caught.value.what
        assert caught.value.fix == REMOVED[key]


def test_no_removed_key_exists_and_there_are_not_too_many_keys() -> None:
    known = load_config(env={}, candidates=()).settings
    paths = {setting.key.path for setting in known}
    assert not paths & set(REMOVED)
    documented = len(paths) + sum(1 for s in known for _ in entry_keys(s.key)) - 1
    assert documented <= 70
