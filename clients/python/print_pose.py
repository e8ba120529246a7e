"""Print where the left hand is, as often as the daemon sees it, with `mocapd.client`. Start `mocapd run` first.

Usage: python print_pose.py [ENDPOINT]
"""

import sys

from mocapd.client import ENDPOINT, Body, Client, Link
from mocapd.errors import InputError, MocapdError

QUIET_S = 2.0  # after which the silence is told [s]


def main() -> int:
    endpoint = sys.argv[1] if len(sys.argv) > 1 else ENDPOINT
    try:
        with Client(Link(endpoint)) as client:
            while True:
                try:
                    say(told(client.wait(QUIET_S)))
                except InputError as error:  # of one message: the next may be a frame again
                    say(f"ignored: {error}")
    except MocapdError as error:
        print(error, file=sys.stderr)
        return error.exit_code
    except KeyboardInterrupt:
        return 130


def told(body: Body | None) -> str:
    if body is None:
        return f"no frame for {QUIET_S:.0f} s; the connection comes back when the daemon does"
    if "leftHand" not in body:
        return f"{body.seq:6d}  nobody there"
    hand = body["leftHand"]
    x_m, y_m, z_m = hand.position_m
    return (
        f"{body.seq:6d}  left hand {x_m:+.2f} {y_m:+.2f} {z_m:+.2f} m"
        f"  confidence {hand.confidence:.2f}  age {body.age_s * 1000:.0f} ms"
    )


def say(line: str) -> None:
    print(line, flush=True)


if __name__ == "__main__":
    sys.exit(main())
