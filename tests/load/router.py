"""`python -m tests.load.router PORT`: a Zenoh session in router mode, as zenohd is not to be had from PyPI."""

import json
import sys

import zenoh


def main() -> None:
    """Until stdin ends."""
    endpoint = f"tcp/127.0.0.1:{sys.argv[1]}"
    config = {
        "mode": "router",
        "listen": {"endpoints": [endpoint]},
        "scouting": {"multicast": {"enabled": False}, "gossip": {"enabled": False}},
        "transport": {"shared_memory": {"enabled": False}},
    }
    with zenoh.open(zenoh.Config.from_json5(json.dumps(config))):
        print("ready", flush=True)
        sys.stdin.read()


if __name__ == "__main__":
    main()
