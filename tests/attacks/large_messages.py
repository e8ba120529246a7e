"""Messages far larger than any question, which nobody may put anyway.

    python -m tests.attacks.large_messages PORT MIB

is one client that puts so much.
"""

import json
import subprocess
import sys
import time

import zenoh

from mocapd.bus.zenoh_client_config import client_config
from tests.attacks.attacked import attacked
from tests.attacks.newcomers import times_s
from tests.attacks.scenario import Found, Scenario
from tests.conftest import ROOT

CLIENTS = 4
PUT_MIB = 400
ALLOWED_MIB = 20.0
PUT_S = 120.0
SETTLED_S = 2.0
KEY = "mocapd/v1/intruder/skeleton/0"


def puts(clients: int = CLIENTS, put_mib: int = PUT_MIB) -> Found:
    """What the daemon grows by at most, while and after so many clients put so much each."""
    with attacked() as daemon:
        before_mib = most_mib = daemon.resident_mib()
        words = [sys.executable, "-m", "tests.attacks.large_messages"]
        words += [str(daemon.port), str(put_mib)]
        putting = [subprocess.Popen(words, cwd=ROOT) for _ in range(clients)]
        until_s = time.monotonic() + PUT_S
        settled_s = None
        while settled_s is None or time.monotonic() < settled_s:
            most_mib = max(most_mib, daemon.resident_mib())
            time.sleep(0.02)
            if settled_s is None and all(one.poll() is not None for one in putting):
                settled_s = time.monotonic() + SETTLED_S
            if time.monotonic() > until_s:
                break
        for one in putting:
            one.kill()
            one.wait()
        well = times_s(daemon.port) != [None]
    more_mib = most_mib - before_mib
    figure = f"{more_mib:.1f} MiB more" + ("" if well else ", newcomers not served")
    return Found(figure, well and more_mib <= ALLOWED_MIB)


def main() -> None:
    """One client."""
    config = client_config(f"tcp/127.0.0.1:{sys.argv[1]}", timeout_s=5.0)
    payload = bytes(int(sys.argv[2]) * 2**20)
    with zenoh.open(zenoh.Config.from_json5(json.dumps(config))) as session:
        session.put(KEY, payload, congestion_control=zenoh.CongestionControl.BLOCK)


SCENARIOS = {
    f"puts-{CLIENTS}-clients-{PUT_MIB}-MiB": Scenario(f"<= {ALLOWED_MIB:g} MiB more", puts)
}

if __name__ == "__main__":
    main()
