"""What is permitted and yet unsafe is said when the session opens, one line each."""

import logging
from pathlib import Path

import pytest

from mocapd.outputs.zenoh.zenoh_config import Params
from mocapd.outputs.zenoh.zenoh_warnings import warnings
from tests.outputs.zenoh_pair import running_sink

ANYWHERE = "/0.0.0.0:7447"


@pytest.fixture
def secret(tmp_path: Path) -> str:
    """A file that only its owner may read, good as a password file and as any other."""
    path = tmp_path / "secret"
    path.write_text("game:hunter2\n")
    path.chmod(0o600)
    return str(path)


def params(secret: str, protocol: str, **more: object) -> Params:
    return Params(
        listen=(f"{protocol}{ANYWHERE}",),
        tls_certificate=secret,
        tls_private_key=secret,
        allow_unencrypted=True,
        **more,  # type: ignore[arg-type]
    )


def test_nothing_is_said_of_what_is_safe(secret: str) -> None:
    assert warnings(Params()) == ()
    assert warnings(Params(password_file=secret)) == ()
    assert warnings(params(secret, "tls", password_file=secret)) == ()
    assert warnings(params(secret, "quic", tls_root_ca=secret, tls_require_client=True)) == ()


@pytest.mark.parametrize("key", ["password_file", "tls_private_key"])
@pytest.mark.parametrize(("mode", "who"), [(0o640, "its group"), (0o644, "every user")])
def test_a_secret_that_others_may_read(key: str, mode: int, who: str, secret: str) -> None:
    Path(secret).chmod(mode)
    (text,) = warnings(Params(**{key: secret}))  # type: ignore[arg-type]
    assert text.startswith(f"zenoh.{key}: {who}")
    assert text.endswith(f"chmod 600 {secret}")
    assert "hunter2" not in text


def test_a_password_without_encryption(secret: str) -> None:
    (text,) = warnings(params(secret, "tcp", password_file=secret))
    assert "tcp/0.0.0.0:7447 encrypts nothing: it asks for a password, but" in text


def test_encryption_without_a_password(secret: str) -> None:
    (text,) = warnings(params(secret, "tls"))
    assert "tls/0.0.0.0:7447 lets everybody" in text
    assert "zenoh.password_file or zenoh.tls_require_client" in text


def test_they_are_logged_at_the_opening(secret: str, caplog: pytest.LogCaptureFixture) -> None:
    Path(secret).chmod(0o644)
    with caplog.at_level(logging.WARNING), running_sink(password_file=secret):
        pass
    assert caplog.messages == list(warnings(Params(password_file=secret)))
