"""Print where the left hand is, as often as the daemon sees it. Start `mocapd run` first.

Usage: python print_pose.py [ENDPOINT]
"""

import sys

import mocapd.client
from mocapd.errors import MocapdError


def main() -> int:
    endpoint = sys.argv[1] if len(sys.argv) > 1 else mocapd.client.ENDPOINT
    try:
        for body in mocapd.client.stream(endpoint):
            if not body.tracked:
                print(f"{body.seq:6d}  nobody there")  # noqa: T201
                continue
            hand = body["leftHand"]
            x_m, y_m, z_m = hand.position_m
            print(  # noqa: T201
                f"{body.seq:6d}  left hand {x_m:+.2f} {y_m:+.2f} {z_m:+.2f} m"
                f"  confidence {hand.confidence:.2f}  age {body.age_s * 1000:.0f} ms"
            )
    except MocapdError as error:
        print(error, file=sys.stderr)  # noqa: T201
        return error.exit_code
    except KeyboardInterrupt:
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
