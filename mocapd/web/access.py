"""Access control of the page: a token, and the page's own Host and Origin.

Other pages in the same browser can reach 127.0.0.1 too, by a fetch, a WebSocket or DNS rebinding. So in addition to the
token, Host and Origin must be ours.

A browser sends a cookie to every port of this machine, also to other users' servers. So the page is below a random path,
and its cookie is limited to that path and holds a session secret instead of the token. Programs use the token, with or
without that path.

Sites in `web.allow_origins` get the frames' WebSocket only: see games.frames_access. A Prometheus gets the metrics only:
see metrics_access.
"""

import logging
import secrets

from starlette.datastructures import MutableHeaders
from starlette.requests import HTTPConnection
from starlette.responses import HTMLResponse, RedirectResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from mocapd.web.games.frames_access import PATH as FRAMES_PATH
from mocapd.web.games.frames_access import FramesAccess
from mocapd.web.metrics_access import MetricsAccess
from mocapd.web.refusal import Refusal, refusal_page
from mocapd.web.stored_key import same_secret

TOKEN = "token"  # its name in the URL's query
LET_IN = "let_in"  # in the scope's state, for an authorised connection
# Without form-action, base-uri and frame-ancestors, default-src would leave those three open.
CONTENT_SECURITY_POLICY = (
    "default-src 'self'; img-src 'self' blob:; connect-src 'self'; frame-ancestors 'none'; "
    "base-uri 'none'; form-action 'none'"
)
HEADERS = {
    "content-security-policy": CONTENT_SECURITY_POLICY,
    "cross-origin-resource-policy": "same-origin",  # other ports of this machine are the same site
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",  # else a link would leak the token
    "cache-control": "no-store",
}
LONGEST_ADDRESS = 8 << 10  # path and query of a request [bytes]
_WS_POLICY_VIOLATION = 1008
_LONGEST_LOGGED = 100  # of an untrusted header [characters]

_log = logging.getLogger(__name__)


class Access:
    """ASGI middleware: authorises requests, and adds the security headers to every answer.

    The printed URL has the token in its query; `/` redirects from there to the page's random path, which sets a cookie
    for the later requests.
    """

    def __init__(
        self,
        app: ASGIApp,
        port: int,
        token: str,
        frames: FramesAccess | None = None,
        metrics: MetricsAccess | None = None,
    ) -> None:
        self._app, self._token = app, token
        self._frames = frames or FramesAccess()
        self._metrics = metrics or MetricsAccess()
        self._session = secrets.token_urlsafe(24)
        self._place = f"/{secrets.token_urlsafe(9)}"
        self._hosts = frozenset({f"127.0.0.1:{port}", f"localhost:{port}"})
        self._origins = frozenset(f"http://{host}" for host in self._hosts)
        # all ports of a machine share cookies: several daemons must not overwrite each other's
        self._cookie = f"mocapd-{port}"
        self._logged: set[str] = set()  # refusals that are in the log already

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Refuse the request, or pass it to the app."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        inside = scope["path"].startswith(f"{self._place}/")
        if inside:
            scope["root_path"] = self._place
        connection = HTTPConnection(scope)
        has_token = same_secret(connection.query_params.get(TOKEN, ""), self._token)
        has_cookie = inside and same_secret(connection.cookies.get(self._cookie, ""), self._session)
        cookie = ""
        if inside and has_token and scope["type"] == "http":
            # replaces the token, which the page removes from the address bar
            cookie = (
                f"{self._cookie}={self._session}; HttpOnly; SameSite=Strict; Path={self._place}/"
            )

        async def send_with_headers(message: Message) -> None:
            if message["type"] in ("http.response.start", "websocket.http.response.start"):
                headers = MutableHeaders(scope=message)
                headers.update(HEADERS)
                if cookie and message["status"] < 400:
                    headers.append("set-cookie", cookie)
            await send(message)

        has_key = self._metrics.lets_in(connection)
        refusal = self._refusal(connection, has_token or has_cookie or has_key)
        if refusal is None:
            scope["state"][LET_IN] = True
            app: ASGIApp = self._app
            if scope["type"] == "http" and scope["path"] == "/":
                # With the token again: after a redirect from a file, a browser does not send a SameSite=Strict
                # cookie. It preserves the part after # by itself.
                app = RedirectResponse(f"{self._place}/?{TOKEN}={self._token}", 303)
            await app(scope, receive, send_with_headers)
            return
        self._log_once(refusal, connection)
        if scope["type"] == "http" or "websocket.http.response" in scope.get("extensions", {}):
            answer = HTMLResponse(refusal_page(refusal), refusal.status)
            await answer(scope, receive, send_with_headers)
        else:
            await send({"type": "websocket.close", "code": _WS_POLICY_VIOLATION})

    def _log_once(self, refusal: Refusal, connection: HTTPConnection) -> None:
        """Log a request from another site or by another host name, each kind once, because a page may repeat it for ever.
        Invalid tokens are not logged: a window left open since an earlier start sends one."""
        if refusal.status != 403 or refusal.what in self._logged:
            return
        self._logged.add(refusal.what)
        host, origin = (
            connection.headers.get(name, "")[:_LONGEST_LOGGED] for name in ("host", "origin")
        )
        _log.warning(
            "the page refused a request with Host %r and Origin %r: %s More like it are not logged.",
            host,
            origin,
            refusal.what,
        )

    def _refusal(self, connection: HTTPConnection, has_secret: bool) -> Refusal | None:
        if (
            len(connection.scope["raw_path"]) + len(connection.scope["query_string"])
            > LONGEST_ADDRESS
        ):
            return Refusal(414, "This address is too long.")
        hosts = connection.headers.getlist("host")
        if len(hosts) != 1 or hosts[0] not in self._hosts:
            return Refusal(403, "This address is not the one that mocapd printed.")
        path = connection.scope["path"].removeprefix(self._place)
        if connection.scope["type"] == "websocket" and path == FRAMES_PATH:
            return self._frames.refusal(connection)
        if any(origin not in self._origins for origin in connection.headers.getlist("origin")):
            return Refusal(403, "Another site asked for this.")
        if not has_secret:
            return Refusal(
                401, "The address has no valid token. Each start of mocapd makes a new one."
            )
        return None
