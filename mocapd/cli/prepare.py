"""`mocapd prepare`"""

from mocapd.cli.options import ConfigOption, SetOption, effective_config


def prepare(config: ConfigOption = None, settings: SetOption = None) -> None:
    """Prepare the first start: compile the tracker and make the pose database.

    It takes about a minute, once on a machine and after some upgrades; a start then takes seconds. The Debian package
    does it in the background when it is installed. `mocapd doctor` says whether it is finished.

    Example: mocapd prepare
    """
    from mocapd.app.libraries import prepare_libraries
    from mocapd.app.terminal.logs import set_up_logs
    from mocapd.errors import ConfigError, UnavailableError

    effective = effective_config(config, settings).config
    set_up_logs(effective.log_level)
    prepare_libraries(effective.cache_dir)

    from mocapd.app.daemon.cache_warmup import prepare_in_processes
    from mocapd.app.daemon.first_start_tasks import has_tasks
    from mocapd.session.prepared_marker import is_prepared

    if not has_tasks(effective.tracker.name):
        raise ConfigError(
            f"the tracker {effective.tracker.name!r} is prepared by its first start alone",
            "tracker.name",
            "start it, or prepare auto, shirt or markerless",
        )
    prepare_in_processes(effective)
    if not is_prepared(effective):
        raise UnavailableError(
            "not everything could be prepared",
            str(effective.cache_dir),
            "see what `mocapd run` says",
        )
    print("prepared: `mocapd run` starts in seconds; a first `mocapd demo` also renders its film")
