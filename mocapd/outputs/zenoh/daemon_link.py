"""A program's connection to a running mocapd over Zenoh: its address, and attempts until a daemon answers."""

import asyncio
import json
import re
import time
from dataclasses import dataclass

import zenoh

from mocapd.bus.zenoh_calls import hold_session, zenoh_call
from mocapd.bus.zenoh_client_config import client_config
from mocapd.errors import ConfigError, UnavailableError
from mocapd.outputs.instance import chunk
from mocapd.outputs.zenoh import keys

ENDPOINT = "tcp/127.0.0.1:7447"
RETRY_S = 0.2  # pause between two attempts to connect [s]
_ENDPOINT = re.compile(r"[a-z][a-z0-9_-]*/.")
ATTEMPT_S = 1.0  # how long one attempt may take [s]


@dataclass(frozen=True, slots=True)
class Link:
    """Address of the daemon and selection of its messages.

    endpoint: Zenoh endpoint of the daemon, or of the router it joined
    instance: name of the daemon, as configured or as in its keys; `*`: any
    person: number of the person
    connect_timeout_s: how long to try to find a daemon [s]; None: for ever
    tls_root_ca: PEM file, for a `tls/` endpoint
    user, password: for a daemon with a password file
    certificate, private_key: PEM files of this program, for a daemon with `zenoh.tls_require_client`
    typed_options: the user gives endpoint and instance as options of a command line, so errors name them `--endpoint`
    """

    endpoint: str = ENDPOINT
    instance: str = keys.ANY
    person: int = 0
    connect_timeout_s: float | None = 2.0
    tls_root_ca: str = ""
    user: str = ""
    password: str = ""
    certificate: str = ""
    private_key: str = ""
    typed_options: bool = False

    @property
    def instance_chunk(self) -> str:
        """The daemon's name as in its keys."""
        return self.instance if self.instance == keys.ANY else chunk(self.instance)

    @property
    def key(self) -> str:
        return keys.skeleton(self.instance_chunk, self.person)

    @property
    def health_key(self) -> str:
        return keys.health(self.instance_chunk)

    @property
    def rest_key(self) -> str:
        return keys.rest_skeleton(self.instance_chunk, self.person)


def connect(link: Link) -> zenoh.Session:
    """Opens a session on which a mocapd is alive, for callers with their own subscribers; retries until the timeout.

    Raises UnavailableError; ConfigError for what is no endpoint.
    """
    started_s = time.monotonic()
    while True:
        try:
            with zenoh_call():
                return _attempt(link)
        except UnavailableError:
            if _is_over(link, started_s):
                raise
        time.sleep(RETRY_S)


async def connect_async(link: Link) -> zenoh.Session:
    """As `connect`; can be cancelled: an attempt that is under way goes on in its thread, and its session is closed."""
    started_s = time.monotonic()
    while True:
        attempt = asyncio.get_running_loop().run_in_executor(None, _attempt, link)
        try:
            return await asyncio.shield(attempt)
        except asyncio.CancelledError:
            attempt.add_done_callback(_close_unwanted)
            raise
        except UnavailableError:
            if _is_over(link, started_s):
                raise
        await asyncio.sleep(RETRY_S)


def _close_unwanted(attempt: asyncio.Future[zenoh.Session]) -> None:
    if attempt.exception() is None:
        with attempt.result():  # closes it
            pass


def _is_over(link: Link, started_s: float) -> bool:
    limit_s = link.connect_timeout_s
    return limit_s is not None and time.monotonic() - started_s + RETRY_S > limit_s


def _attempt(link: Link) -> zenoh.Session:
    if not _ENDPOINT.match(link.endpoint):
        raise ConfigError(
            f"{link.endpoint!r} is no Zenoh endpoint",
            _option(link, "endpoint").rstrip("="),
            "write PROTOCOL/HOST:PORT, such as tcp/127.0.0.1:7447",
        )
    limit_s = link.connect_timeout_s
    config = client_config(
        link.endpoint,
        timeout_s=ATTEMPT_S if limit_s is None else min(ATTEMPT_S, limit_s),
        tls_root_ca=link.tls_root_ca,
        user=link.user,
        password=link.password,
        certificate=link.certificate,
        private_key=link.private_key,
    )
    try:
        session = zenoh.open(zenoh.Config.from_json5(json.dumps(config)))
        hold_session(session)
    except zenoh.ZError as error:
        raise UnavailableError(
            f"no mocapd at {link.endpoint}",
            fix=f"start `mocapd run` or pass {_option(link, 'endpoint')}"
            # a refused login looks like silence to Zenoh
            + ("; check tls_root_ca, user and password too" if _has_secrets(link) else ""),
        ) from error
    token = keys.alive(link.instance_chunk)
    if any(reply.ok for reply in session.liveliness().get(token, timeout=ATTEMPT_S)):
        return session
    with session:
        raise UnavailableError(
            f"no mocapd at {link.endpoint}: a Zenoh node answers, but without {token}",
            fix="start `mocapd run` (zenoh.connect joins that node) or pass "
            f"{_option(link, 'endpoint')} or {_option(link, 'instance')}",
        )


def _option(link: Link, name: str) -> str:
    return f"--{name}" if link.typed_options else f"{name}="


def _has_secrets(link: Link) -> bool:
    return bool(link.tls_root_ca or link.user) or not link.endpoint.startswith("tcp/")
