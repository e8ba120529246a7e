"""The native libraries that wheels of the runtime lock carry beside their own code, and their licences."""

import re
from importlib import metadata

# by wheel, the libraries by the stem of their files' names: both x86_64 and aarch64
CARRIED: dict[str, tuple[str, ...]] = {
    "llvmlite": ("libllvmlite",),
    "numpy": ("libgfortran", "libquadmath", "libscipy_openblas64_"),
    "opencv-python-headless": (
        *("libavcodec", "libavformat", "libavutil", "libswresample", "libswscale"),
        *("libaom", "libavif", "libcrypto", "libdrm", "libgfortran", "libopenblasp"),
        *("libpng16", "libquadmath", "libssl", "libvpx"),
    ),
    "pillow": (
        *("libXau", "libavif", "libbrotlicommon", "libbrotlidec", "libfreetype", "libharfbuzz"),
        *("libjpeg", "liblcms2", "liblzma", "libopenjp2", "libpng16", "libsharpyuv", "libtiff"),
        *("libwebp", "libwebpdemux", "libwebpmux", "libxcb", "libzstd"),
    ),
    "scipy": ("libgfortran", "libquadmath", "libscipy_openblas"),
}

_FFMPEG = ("FFmpeg", "LGPL-2.1-or-later (configured without its GPL parts)")
_BROTLI = ("Brotli", "MIT")
_WEBP = ("libwebp", "BSD-3-Clause")
_OPENSSL = ("OpenSSL 1.1.1", "OpenSSL")
_OPENBLAS = ("OpenBLAS with LAPACK", "BSD-3-Clause AND BSD-3-Clause-Open-MPI")
# by stem: the work and its licence
WORKS: dict[str, tuple[str, str]] = {
    "libXau": ("libXau", "MIT"),
    "libaom": ("libaom", "BSD-2-Clause"),
    "libavcodec": _FFMPEG,
    "libavformat": _FFMPEG,
    "libavif": ("libavif", "BSD-2-Clause"),
    "libavutil": _FFMPEG,
    "libbrotlicommon": _BROTLI,
    "libbrotlidec": _BROTLI,
    "libcrypto": _OPENSSL,
    "libdrm": ("libdrm", "MIT"),
    "libfreetype": ("FreeType", "FTL OR GPL-2.0-or-later"),
    "libgfortran": ("GCC's Fortran runtime", "GPL-3.0-or-later WITH GCC-exception-3.1"),
    "libharfbuzz": ("HarfBuzz", "MIT"),
    "libjpeg": ("libjpeg-turbo", "IJG AND BSD-3-Clause"),
    "liblcms2": ("Little CMS", "MIT"),
    "libllvmlite": ("LLVM, linked into llvmlite", "Apache-2.0 WITH LLVM-exception"),
    "liblzma": ("XZ Utils' liblzma", "0BSD"),
    "libopenblasp": _OPENBLAS,
    "libopenjp2": ("OpenJPEG", "BSD-2-Clause"),
    "libpng16": ("libpng", "libpng-2.0"),
    "libquadmath": ("GCC's libquadmath (x86_64 only)", "LGPL-2.1-or-later"),
    "libscipy_openblas": _OPENBLAS,
    "libscipy_openblas64_": _OPENBLAS,
    "libsharpyuv": _WEBP,
    "libssl": _OPENSSL,
    "libswresample": _FFMPEG,
    "libswscale": _FFMPEG,
    "libtiff": ("libtiff", "libtiff"),
    "libvpx": ("libvpx", "BSD-3-Clause"),
    "libwebp": _WEBP,
    "libwebpdemux": _WEBP,
    "libwebpmux": _WEBP,
    "libxcb": ("libxcb", "MIT"),
    "libzstd": ("Zstandard", "BSD-3-Clause OR GPL-2.0-only"),
}


def stem(file_name: str) -> str:
    """`libgfortran-83c28eba.so.5.0.0` -> `libgfortran`: without hash and version."""
    return re.split(r"-|\.so", file_name)[0]


def carried_by_installed(package: str) -> set[str]:
    """The stems of the libraries in an installed wheel; Python's extension modules are none."""
    library = re.compile(r"lib[^/]*\.so(\.\w+)*")
    names = [path.name for path in metadata.files(package) or []]
    return {
        stem(name)
        for name in names
        if library.fullmatch(name) and ".cpython-" not in name and ".abi3." not in name
    }


def table_rows() -> list[str]:
    """One row for each wheel and work: `| wheel | work | files | licence |`."""
    rows = []
    for wheel, stems in CARRIED.items():
        works: dict[tuple[str, str], list[str]] = {}
        for name in stems:
            works.setdefault(WORKS[name], []).append(name)
        for (work, licence), files in works.items():
            rows.append(f"| {wheel} | {work} | {', '.join(files)} | {licence} |")
    return rows
