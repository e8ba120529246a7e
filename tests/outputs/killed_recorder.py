"""Records for ever, as fast as it goes, and says the number of each frame once it is handed over.

    python -m tests.outputs.killed_recorder FILE

The writer's clock is the frames' own, so that what a kill costs is counted in frames.
"""

import sys
from itertools import count
from pathlib import Path

from mocapd.outputs.mcap.recording_writer import RecordingParams, RecordingWriter
from tests.outputs.recorded import HZ, cameras, frame_at, rest


def main() -> None:
    """Until it is killed."""
    first = frame_at(0.0, 0)
    with RecordingWriter(
        Path(sys.argv[1]), RecordingParams(), first.capture_monotonic_ns
    ) as writer:
        writer.add_state(cameras(), first.capture_unix_ns)
        writer.add_state(rest(), first.capture_unix_ns)
        for number in count():
            frame = frame_at(number / HZ, number)
            writer.frame(frame)
            print(number, flush=True)
            writer.flush_if_due(frame.capture_monotonic_ns)


if __name__ == "__main__":
    main()
