"""`mocapd web-link`"""

from mocapd.cli.options import ConfigOption, SetOption, config_to_look_after
from mocapd.errors import ConfigError


def web_link(config: ConfigOption = None, settings: SetOption = None) -> None:
    """Print the address of a browser game that gets the frames of the running daemon.

    One line per site in web.allow_origins. The part after # is the key to the frames: give it to no other site.

    Example: mocapd web-link
    """
    from urllib.parse import urlsplit

    from mocapd.app.setup.chosen_page import target_page
    from mocapd.web.games.frames_access import FramesAccess

    daemon = target_page(config_to_look_after(config, settings)[0])
    if not daemon.status.origins:
        raise ConfigError(
            "the running mocapd allows no site",
            "web.allow_origins",
            "start it with the site's origin, such as --set 'web.allow_origins=[\"http://localhost:8000\"]'",
        )
    access = FramesAccess(daemon.status.origins, daemon.status.frames_key)
    for link in access.links(urlsplit(daemon.url).netloc):
        print(link)
