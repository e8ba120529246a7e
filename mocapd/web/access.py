"""Who may see the page: whoever has the token, from this machine, and from no other site.

Other pages in the same browser can reach 127.0.0.1 too, by a fetch, a WebSocket or a name of their
own that they let point here (DNS rebinding). So next to the token, Host and Origin must be ours.
"""

import secrets
from dataclasses import dataclass
from html import escape

from starlette.datastructures import MutableHeaders
from starlette.requests import HTTPConnection
from starlette.responses import HTMLResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

TOKEN = "token"  # its name in the URL's query
# Without form-action, base-uri and frame-ancestors, default-src would leave those three open.
CONTENT_SECURITY_POLICY = (
    "default-src 'self'; img-src 'self' blob:; connect-src 'self'; frame-ancestors 'none'; "
    "base-uri 'none'; form-action 'none'"
)
HEADERS = {
    "content-security-policy": CONTENT_SECURITY_POLICY,
    "cross-origin-resource-policy": "same-origin",  # other ports of this machine are the same site
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",  # or a link would carry the token away
    "cache-control": "no-store",
}
_WS_POLICY_VIOLATION = 1008


@dataclass(frozen=True, slots=True)
class Refusal:
    """status: of HTTP; what: for people."""

    status: int
    what: str


class Access:
    """ASGI middleware: lets in who may see the page, and puts the protecting headers on every answer.

    The token is in the query of the URL that was printed, or in the cookie that the first page set.
    """

    def __init__(self, app: ASGIApp, port: int, token: str) -> None:
        self._app, self._token = app, token.encode()
        self._hosts = frozenset({f"127.0.0.1:{port}", f"localhost:{port}"})
        self._origins = frozenset(f"http://{host}" for host in self._hosts)
        # cookies are shared by all ports of a machine: several daemons must not overwrite each other's
        self._cookie = f"mocapd-{port}"

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer, or hand on to the app."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        connection = HTTPConnection(scope)
        # the first page leaves a cookie, so that the token need not stay in the address bar
        given = connection.query_params.get(TOKEN, "")
        cookie = ""
        if scope["type"] == "http" and self._is_token(given):
            cookie = f"{self._cookie}={given}; HttpOnly; SameSite=Strict; Path=/"

        async def protected(message: Message) -> None:
            if message["type"] in ("http.response.start", "websocket.http.response.start"):
                headers = MutableHeaders(scope=message)
                headers.update(HEADERS)
                if cookie and message["status"] < 400:
                    headers.append("set-cookie", cookie)
            await send(message)

        refusal = self._refusal(connection)
        if refusal is None:
            await self._app(scope, receive, protected)
        elif scope["type"] == "http" or "websocket.http.response" in scope.get("extensions", {}):
            answer = HTMLResponse(_page(refusal), refusal.status)
            await answer(scope, receive, protected)
        else:
            await send({"type": "websocket.close", "code": _WS_POLICY_VIOLATION})

    def _refusal(self, connection: HTTPConnection) -> Refusal | None:
        hosts = connection.headers.getlist("host")
        if len(hosts) != 1 or hosts[0] not in self._hosts:
            return Refusal(403, "This address is not the one that mocapd printed.")
        if any(origin not in self._origins for origin in connection.headers.getlist("origin")):
            return Refusal(403, "Another site asked for this.")
        given = connection.query_params.get(TOKEN), connection.cookies.get(self._cookie)
        if not any(self._is_token(one) for one in given if one):
            return Refusal(
                401, "The address has no valid token. Each start of mocapd makes a new one."
            )
        return None

    def _is_token(self, given: str) -> bool:
        return secrets.compare_digest(given.encode(errors="replace"), self._token)


def _page(refusal: Refusal) -> str:
    return (
        "<!doctype html><html lang=en><meta charset=utf-8>"
        "<meta name=viewport content='width=device-width'><title>mocapd</title>"
        f"<h1>Not let in</h1><p>{escape(refusal.what)}</p>"
        "<p>Open the whole address that <code>mocapd calibrate</code> printed in its terminal, "
        "on the machine where it runs.</p></html>"
    )
