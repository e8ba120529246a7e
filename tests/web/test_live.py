"""The live view's data."""

import json
from typing import Any

import numpy as np

from mocapd.geometry.camera_model import centre
from mocapd.web.server import WebServer
from tests.web.browser import PATIENCE_S, connect
from tests.web.tiny_host import TinyHost


def first_of_each(socket: Any, kinds: set[str]) -> dict[str, dict[str, Any]]:
    found: dict[str, dict[str, Any]] = {}
    while not kinds <= set(found):
        message = json.loads(socket.recv(PATIENCE_S))
        found.setdefault(message["kind"], message)
    return found


def test_scene_body_and_figures(host: TinyHost, server: WebServer) -> None:
    with connect(server, "/live") as socket:
        told = first_of_each(socket, {"scene", "body", "figures"})
    scene, body, figures = told["scene"], told["body"], told["figures"]["figures"]
    assert scene["names"] == ["cam0", "cam1"]
    assert host.rig is not None
    for camera, shown in zip(host.rig.cameras, scene["cameras"], strict=True):
        assert np.allclose(shown["centre_m"], centre(camera), atol=1e-3)
        assert len(shown["corners_m"]) == 4
    assert len(body["joints_m"]) == len(scene["parents"]) == len(scene["joints"])
    assert body["tracking"] == "live"
    uncertainty_m = dict(zip(scene["joints"], body["uncertainty_m"], strict=True))
    assert (uncertainty_m["leftHand"], uncertainty_m["leftFoot"]) == (0.02, None)
    assert figures["latency_ms"]["median"] > 0
    assert figures["spread_ms"]["median"] is None  # nobody measured it yet
    assert figures["lost_reason"] == ""
    assert figures["cameras"][1]["state"] == "lost"
    assert "plug it in" in figures["cameras"][1]["reason"]
    assert figures["outputs"][0]["listeners"] == 1


def test_when_nothing_tracks_that_is_said(host: TinyHost, server: WebServer) -> None:
    host.tracks, host.rig = False, None
    with connect(server, "/live") as socket:
        told = first_of_each(socket, {"scene", "figures"})
    assert told["figures"]["figures"] is None
    assert told["scene"]["cameras"] == []


def test_a_hidden_page_gets_figures_only(host: TinyHost, server: WebServer) -> None:
    with connect(server, "/live") as socket:
        first_of_each(socket, {"body"})
        socket.send('{"watch": false}')
        kinds: list[str] = []
        # what was under way still came; after that a second passes between messages
        while kinds[-2:] != ["figures", "figures"]:
            kinds.append(json.loads(socket.recv(PATIENCE_S))["kind"])
        socket.send('{"watch": true}')
        first_of_each(socket, {"body"})
