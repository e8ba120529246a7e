"""Print where the left hand is, with OSC over UDP and python-osc, without mocapd. Start `mocapd run` whenever.

Usage: python print_pose_osc.py [PORT]
"""

import math
import socket
import sys

from pythonosc.osc_message import OscMessage
from pythonosc.osc_packet import OscPacket, ParseError

PORT = 39541
FRAME, LEFT_HAND = "/mocapd/v1/frame", "/mocapd/v1/joint/leftHand"
LARGEST = 65536  # a datagram [bytes]
QUIET_S = 2.0  # after which the silence is told [s]
# what garbage raises in python-osc and below
DAMAGED = (ParseError, ValueError, TypeError, RecursionError)


def main() -> int:
    port = int(sys.argv[1]) if len(sys.argv) > 1 else PORT
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp:
        try:
            udp.bind(("127.0.0.1", port))
        except OSError as error:
            print(f"port {port} cannot be had: {error.strerror}", file=sys.stderr)
            return 69
        udp.settimeout(QUIET_S)
        while True:
            try:
                datagram = udp.recv(LARGEST)
            except TimeoutError:
                say(f"no frame on port {port} for {QUIET_S:.0f} s; they go on when the daemon does")
                continue
            try:
                messages = [timed.message for timed in OscPacket(datagram).messages]
                for line in told(messages):
                    say(line)
            except DAMAGED as error:
                say(f"ignored: no frame: {error!r:.80}")


def told(messages: list[OscMessage]) -> list[str]:
    """What there is to say of one datagram, which is a part of a frame."""
    lines, seq = [], 0
    for message in messages:
        if message.address == FRAME:
            _, seq, _, _, count, *_ = message.params
            if count == 0:
                lines.append(f"{seq:6d}  nobody there")
        elif message.address == LEFT_HAND:
            x_m, y_m, z_m, *_, confidence = message.params[:12]  # within v1 more may follow
            if not all(map(math.isfinite, (x_m, y_m, z_m))):
                lines.append(f"{seq:6d}  ignored: the position of the left hand is no number")
                continue
            lines.append(
                f"{seq:6d}  left hand {x_m:+.2f} {y_m:+.2f} {z_m:+.2f} m  confidence {confidence:.2f}"
            )
        elif not message.address.startswith("/mocapd/v1/"):
            lines.append(f"ignored: {message.address:.40}, this program reads /mocapd/v1/")
    return lines


def say(line: str) -> None:
    print(line, flush=True)


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)
