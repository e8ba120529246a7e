"""What leaves the process names no password, wherever it stands."""

import json

import numpy as np

from mocapd.web.shown_json import as_json

SECRET = "rtsp://admin:hunter2@10.0.0.9:554/live?channel=1"


def test_passwords_are_masked_wherever_an_address_stands() -> None:
    sent = as_json(
        {
            "names": [SECRET],
            SECRET: {"source": SECRET, "reason": f"cannot open {SECRET}: no route to host"},
            "pictures": ("http://cam/snap?user=a&password=hunter2",),
        }
    )
    assert b"hunter2" not in sent
    assert json.loads(sent)["names"] == ["rtsp://admin:***@10.0.0.9:554/live?channel=1"]


def test_what_has_no_address_is_as_it_was() -> None:
    message = {"at": np.float64(0.5), "lost": float("nan"), "text": "me@home: 3 of 4", "n": 2**60}
    told = {"at": 0.5, "lost": None, "text": "me@home: 3 of 4", "n": 2**60}
    assert json.loads(as_json(message)) == told
    assert json.loads(as_json(message | {"url": "http://10.0.0.9/"})) == told | {
        "url": "http://10.0.0.9/"
    }
