"""What is installed as `goalkeeper`: the program, or what it lacks."""

import sys
from importlib.util import find_spec

_UNAVAILABLE = 69  # as mocapd.errors has it, which may be what is missing


def script() -> None:
    """Run the program; ends the process."""
    if find_spec("mocapd") is None:
        print(
            "goalkeeper: needs mocapd or its small install -- from a checkout: "
            f"{sys.executable} -m pip install ./clients/python",
            file=sys.stderr,
        )
        sys.exit(_UNAVAILABLE)
    from goalkeeper.app.main import main

    sys.exit(main())
