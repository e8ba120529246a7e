"""A Debian of its own in a folder of the cache, made once, for engines and Pythons that this machine's Debian lacks.

Its /proc, /dev and /sys are mounted in a mount namespace that ends with each command: nothing of them is left behind,
so the folder may be removed at any time.
"""

import os
import shlex
import shutil
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import platformdirs

from tests.engines.mirror import configured_mirror

CACHE = platformdirs.user_cache_path("mocapd-engines")
BINFMT = Path("/proc/sys/fs/binfmt_misc")
_OUT_OF_DATE = (
    'Acquire::Check-Valid-Until "false"'  # mirrors lag; signatures are checked all the same
)
_UNPACK_S = 3600.0


class NoChrootError(Exception):
    """Why there is none on this machine, in a word."""


@dataclass(frozen=True)
class Chroot:
    """folder: of the system; env: for every command in it."""

    folder: Path
    env: Mapping[str, str] = field(default_factory=dict)

    def inside(self, path: Path) -> str:
        """How a path below the folder is called in there."""
        return f"/{path.relative_to(self.folder)}"

    def start(
        self, command: Sequence[str], env: Mapping[str, str], log: Path
    ) -> subprocess.Popen[bytes]:
        """A command in it, with 127.0.0.1 of this machine; what it prints goes to the log."""
        root = shlex.quote(str(self.folder))
        mounts = (
            f"mount -t proc proc {root}/proc && mount --rbind /dev {root}/dev"
            f" && mount -t sysfs sysfs {root}/sys && exec chroot {root} {shlex.join(command)}"
        )
        home = self.folder / "mocapd/home"
        home.mkdir(parents=True, exist_ok=True)
        usual = {"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "HOME": self.inside(home)}
        usual |= {"LANG": "C.UTF-8", "OPENBLAS_NUM_THREADS": "1"}
        with log.open("wb") as out:
            return subprocess.Popen(
                ["unshare", "--mount", "--propagation", "private", "sh", "-c", mounts],
                env=usual | dict(self.env) | dict(env),
                stdin=subprocess.DEVNULL,
                stdout=out,
                stderr=subprocess.STDOUT,
            )

    def run(
        self,
        command: Sequence[str],
        log: Path,
        env: Mapping[str, str] | None = None,
        timeout_s: float = 600.0,
    ) -> int:
        """The exit code; -1 where it took too long, and was ended."""
        running = self.start(command, env or {}, log)
        try:
            return running.wait(timeout_s)
        except subprocess.TimeoutExpired:
            running.kill()
            running.wait()
            return -1


def sid() -> Chroot:
    """Debian sid with Godot 4, Blender, Python 3.13 and 3.14. Raises NoChrootError."""
    packages = ("python3.13", "python3.14", "python3-numpy", "openssl", "ca-certificates")
    return Chroot(_made("sid", "sid", (*packages, "godot", "blender"), ()))


def arm64() -> Chroot:
    """Debian 13 for ARM, emulated by qemu-user: only where the emulator is registered. Raises NoChrootError."""
    _register_emulator()
    folder = _made("arm64", "trixie", ("python3", "ca-certificates"), ("--arch=arm64",))
    # the usual emulated processor has SME, by which a library's matrix products are wrong
    return Chroot(folder, {"QEMU_CPU": "cortex-a72"})


def _made(name: str, suite: str, packages: Sequence[str], more: Sequence[str]) -> Path:
    folder = CACHE / name
    if (folder / "usr/bin/python3").exists():
        return folder
    _check_privileges()
    mirror = configured_mirror()
    if mirror is None:
        raise NoChrootError("no Debian mirror is set up in /etc/apt")
    CACHE.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=CACHE, prefix="partial-") as partial:
        # mmdebstrap's own user reads the folder's name
        Path(partial).chmod(0o755)
        command = ["mmdebstrap", "--variant=minbase", f"--aptopt={_OUT_OF_DATE}", *more]
        command += [f"--include={','.join(packages)}", suite, f"{partial}/{name}", mirror]
        print(f"engines: making {folder} (once, some minutes)", flush=True)
        done = subprocess.run(
            command,
            env=os.environ | {"QEMU_CPU": "cortex-a72"},
            capture_output=True,
            text=True,
            timeout=_UNPACK_S,
            check=False,
        )
        if done.returncode != 0:
            last = (done.stderr.strip().splitlines() or ["it said nothing"])[-1]
            raise NoChrootError(f"mmdebstrap failed: {last}")
        shutil.rmtree(folder, ignore_errors=True)
        Path(partial, name).rename(folder)
    return folder


def _check_privileges() -> None:
    if os.geteuid() != 0:
        raise NoChrootError("not root")
    missing = [tool for tool in ("mmdebstrap", "unshare", "chroot") if shutil.which(tool) is None]
    if missing:
        raise NoChrootError(f"{' and '.join(missing)} not installed")


def _register_emulator() -> None:
    _check_privileges()
    known = Path("/usr/lib/binfmt.d/qemu-aarch64.conf")
    if not known.is_file():
        raise NoChrootError("qemu-user-static not installed")
    if shutil.which("arch-test") is None:
        raise NoChrootError("arch-test not installed")
    if not (BINFMT / "register").exists():
        subprocess.run(["mount", "-t", "binfmt_misc", "binfmt_misc", str(BINFMT)], check=True)
    if not (BINFMT / "qemu-aarch64").exists():
        (BINFMT / "register").write_bytes(known.read_bytes().strip())
