"""What a test draws, kept on disk: drawing takes seconds, and each of the processes of `make test` would draw it anew."""

import hashlib
import pickle
from collections.abc import Callable
from functools import cache, wraps
from typing import ParamSpec, TypeVar, cast

from mocapd.file_lock import one_at_a_time
from mocapd.whole_file import whole_file
from tests.conftest import ROOT

P = ParamSpec("P")
R = TypeVar("R")

_FOLDER = ROOT / ".pytest_cache" / "d" / "mocapd" / "drawn"  # in the fixture cache_home


def kept(draw: Callable[P, R]) -> Callable[P, R]:
    """`draw`, called once for each of its arguments until any of mocapd's code, or of the tests' that draws, changes.

    What it returns is pickled, and nobody may change it.
    """

    @cache
    @wraps(draw)
    def kept_one(*args: P.args, **kwargs: P.kwargs) -> R:
        name = f"{draw.__module__}.{draw.__qualname__}{args}{kwargs}"
        of_name, of_code = (
            hashlib.sha256(one.encode()).hexdigest()[:16] for one in (name, _code())
        )
        path = _FOLDER / f"{draw.__name__}-{of_name}-{of_code}"
        _FOLDER.mkdir(parents=True, exist_ok=True)
        with one_at_a_time(_FOLDER, f"{draw.__name__}-{of_name}.lock"):
            if path.exists():
                found: R = pickle.loads(path.read_bytes())
                return found
            drawn = draw(*args, **kwargs)
            for old in _FOLDER.glob(f"{draw.__name__}-{of_name}-*"):
                old.unlink()
            with whole_file(path) as partial:
                partial.write_bytes(pickle.dumps(drawn))
            return drawn

    return cast(Callable[P, R], kept_one)  # the cache's type forgets the arguments


@cache
def _code() -> str:
    digest = hashlib.sha256()
    for folder in ("mocapd", "calib", "tests/sim", "tests/tracking", "tests/calibrate"):
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in (".py", ".json", ".toml"):
                digest.update(f"{path.name}\n".encode() + path.read_bytes())
    return digest.hexdigest()
