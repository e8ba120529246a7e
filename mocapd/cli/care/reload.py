"""`mocapd reload`"""

from mocapd.cli.options import ConfigOption, SetOption, config_to_look_after
from mocapd.errors import one_line


def reload(config: ConfigOption = None, settings: SetOption = None) -> None:
    """Have the running daemon read its config again.

    It also reads its calibration again. The stream continues, except for a moment in which the cameras are opened again.
    After an error, which names the key, the daemon continues unchanged, and the exit code is that of `mocapd run`, such
    as 78. Changes that need a restart are named.

    Example: mocapd reload
    """
    from mocapd.control.target_process import target_daemon

    daemon = target_daemon(config_to_look_after(config, settings)[0])
    done = daemon.reload()
    print(one_line(f"{daemon.instance}: taken up, {done.gap_s:.2f} s without a frame"))
    if done.waiting:
        print(one_line(f"changed, but only for the next start: {', '.join(done.waiting)}"))
