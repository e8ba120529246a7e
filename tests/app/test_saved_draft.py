"""A setup and the calibration that is saved already."""

from pathlib import Path

import pytest

from mocapd.app.setup.setup_hosts import saved_draft
from mocapd.calibration.calibration_file import FILE_NAME
from mocapd.config.sections import Config
from mocapd.errors import ConfigError
from mocapd.wizard.step_names import StepName


@pytest.mark.parametrize("text", ["schema = [", "schema = 99", "schema = 1\n[[camera]]\nid = 'a'"])
def test_a_calibration_that_cannot_be_read_does_not_keep_from_calibrating_again(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, text: str
) -> None:
    """`mocapd run` named `mocapd calibrate` as the remedy, which ended with the same error."""
    (tmp_path / FILE_NAME).write_text(text)
    config = Config(state_dir=tmp_path)
    assert saved_draft(config, None).cameras == ()
    (message,) = caplog.messages
    assert message.startswith(str(tmp_path / FILE_NAME))
    assert message.endswith("the setup begins without it")
    assert (tmp_path / FILE_NAME).read_text() == text
    with pytest.raises(ConfigError):
        saved_draft(config, StepName.ROOM)
