"""Makes the lock files of locks/ from pyproject.toml: `make lock`, with UPGRADE=1 to newer versions.

One resolution for every Python and platform, its differences as markers, with the hashes of all
wheels that PyPI has of a version, so that no lock depends on the machine it was made on. uv reads
neither pip's configuration nor, here, its own: what this machine uses for an index stays out.
"""

import argparse
import os
import re
import subprocess
import sys
import tomllib

from tests.supply.lock_files import (
    BUILD,
    CLIENTS,
    DEV,
    PROJECT,
    PYTHONS,
    ROOT,
    RUN,
    pins,
)

INDEX = "https://pypi.org/simple"
COMPILE = (
    *(sys.executable, "-m", "uv", "pip", "compile", "--quiet", "--no-config"),
    *("--default-index", INDEX, "--universal", "--python-version", PYTHONS[0]),
    *("--fork-strategy", "fewest"),  # one version of numpy, not one for each Python
    *("--generate-hashes", "--only-binary", ":all:"),
    *("--no-emit-index-url", "--no-emit-find-links", "--custom-compile-command", "make lock"),
)


def compile_lock(arguments: list[str], requirements: str = "") -> None:
    """Run uv in the project's folder; `requirements` are its standard input."""
    environment = {name: value for name, value in os.environ.items() if name[:3] != "UV_"}
    command = [*COMPILE, *arguments]
    subprocess.run(command, input=requirements, text=True, cwd=ROOT, env=environment, check=True)


def prefer_the_developers_versions() -> None:
    """uv keeps the versions of the lock that it renews: those of DEV, and of what only CLIENTS has its own."""
    known = pins(DEV)
    before = CLIENTS.read_text() if CLIENTS.exists() else ""
    entries = re.split(r"^(?=[a-z0-9])", before, flags=re.MULTILINE)[1:]
    own = [entry for entry in entries if entry.partition("==")[0] not in known]
    CLIENTS.write_text(DEV.read_text() + "".join(own))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--upgrade", action="store_true", help="to the newest versions allowed")
    upgrade = ["--upgrade"] if parser.parse_args().upgrade else []
    project, run, build, dev, clients = (
        str(p.relative_to(ROOT)) for p in (PROJECT, RUN, BUILD, DEV, CLIENTS)
    )
    asked = tomllib.loads(PROJECT.read_text())
    backend = "\n".join(asked["build-system"]["requires"])
    # all of it at once first; the parts then take their versions from it
    everything = ["--extra", "all", "--extra", "dev"]
    compile_lock([project, "-", *everything, "--output-file", dev, *upgrade], backend)
    compile_lock(
        [project, "--extra", "print", "--constraints", dev, "--output-file", run, *upgrade]
    )
    compile_lock(["-", "--constraints", dev, "--output-file", build, *upgrade], backend)
    prefer_the_developers_versions()
    compile_lock(
        [project, "-", *everything, "--extra", "clients", "--output-file", clients], backend
    )


if __name__ == "__main__":
    main()
