"""The WebSocket `/ws`: sends the setup's state to the page on change, and receives its commands.

To the page, JSON: {setup: false, cameras, driver, refused} without a setup, else {setup:
true, serial, step, steps, done, view: {state, sentence, progress, problems, details}, refused, saved,
ended, driver, cameras}. From the page: {verb, args}; `take_over` is answered here, `begin` begins a
setup, the rest is the wizard's.
"""

import asyncio
from dataclasses import asdict
from typing import Annotated

import msgspec
from msgspec import Meta
from starlette.websockets import WebSocket

from mocapd.boundary.parsing import decode_json
from mocapd.errors import MalformedError, MocapdError, Problem
from mocapd.web.editor_lease import EditorLease
from mocapd.web.host import Host
from mocapd.web.links.socket_link import MOST_HZ, receive, send_json, serve
from mocapd.web.shown_json import as_json
from mocapd.wizard.wizard_view import WizardView

NOT_THE_DRIVER = Problem(
    "another window leads this setup", "this window", "choose Take over to lead it from here"
)


class PageCommand(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A user's action on the page."""

    verb: Annotated[str, Meta(max_length=100)]
    args: dict[str, object] = {}


class WizardLink:
    """One browser window."""

    def __init__(self, socket: WebSocket, host: Host, lease: EditorLease) -> None:
        self._socket, self._host, self._lease = socket, host, lease
        self._refused: Problem | None = None  # by this link, not by the wizard

    async def run(self) -> None:
        """Until the window leaves."""
        self._lease.join(self)
        try:
            await serve(self._socket, self._show(), self._obey())
        finally:
            self._lease.leave(self, asyncio.get_running_loop().time())

    async def _show(self) -> None:
        last = b""
        while True:
            message = self._message()
            now = as_json(message | {"serial": 0})  # it grows also when nothing else changes
            if now != last:
                last = now
                await send_json(self._socket, message)
            await asyncio.sleep(1.0 / MOST_HZ)

    def _message(self) -> dict[str, object]:
        wizard, hub = self._host.wizard, self._host.hub
        message: dict[str, object] = {"setup": False}
        if wizard is not None:
            message = view_json(wizard.view())
        message["driver"] = self._lease.drives(self, asyncio.get_running_loop().time())
        message["cameras"] = list(hub.names) if hub is not None else []
        if self._refused is not None or wizard is None:
            message["refused"] = self._refused and asdict(self._refused)
        return message

    async def _obey(self) -> None:
        while True:
            text = await receive(self._socket)
            try:
                command = decode_json(text, PageCommand)
            except MalformedError as error:
                self._refused = Problem(f"not understood: {error}", "the page", "reload the page")
                continue
            self._refused = None
            await self._take(command)

    async def _take(self, command: PageCommand) -> None:
        begins = command.verb == "begin" and self._host.wizard is None
        if begins or command.verb == "take_over":
            self._lease.take_over(self)
        if command.verb == "take_over":
            return
        if not self._lease.drives(self, asyncio.get_running_loop().time()):
            self._refused = NOT_THE_DRIVER
        elif command.verb == "begin":
            try:
                await asyncio.to_thread(self._host.setup)
            except MocapdError as error:
                self._refused = Problem.of(error)
        elif (wizard := self._host.wizard) is not None:
            wizard.send(command.verb, command.args)


def view_json(shown: WizardView) -> dict[str, object]:
    """The setup's state for the page, without the parts that depend on the window."""
    view = shown.view
    return {
        "setup": True,
        "serial": shown.serial,
        "step": shown.step.value,
        "steps": [name.value for name in shown.steps],
        "done": sorted(name.value for name in shown.done),
        "view": {
            "state": view.state.value,
            "sentence": view.sentence,
            "progress": view.progress,
            "problems": [asdict(problem) for problem in view.problems],
            "details": view.details,
        },
        "refused": asdict(shown.refused) if shown.refused is not None else None,
        "saved": shown.saved,
        "shirt": shown.has_shirt,
        "ended": shown.ended,
    }
