"""An authority and what it has signed, made by openssl for a test."""

import shutil
import subprocess
from pathlib import Path

_EXPIRED_CONF = """\
[ca]
default_ca = own
[own]
certificate = ca.pem
private_key = ca.key
database = issued.txt
new_certs_dir = .
rand_serial = yes
unique_subject = no
default_md = sha256
policy = any_name
[any_name]
commonName = supplied
"""


def openssl(folder: Path, *arguments: str) -> None:
    subprocess.run(["openssl", *arguments], cwd=folder, check=True, capture_output=True)


def make_certificates(folder: Path, *others: str) -> None:
    """An authority (ca.pem), and signed by it a certificate of 127.0.0.1 (server.pem, server.key) and some of
    programs that are called `pc`, `viewer` and as the others (pc.pem, pc.key, ...)."""
    key = ("-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes")
    (folder / "server.ext").write_text("subjectAltName=IP:127.0.0.1\nbasicConstraints=CA:FALSE\n")
    openssl(folder, "req", "-x509", *key, "-keyout", "ca.key", "-out", "ca.pem", "-subj", "/CN=ca")
    for name in ("server", "pc", "viewer", *others):
        extensions = folder / f"{name}.ext"
        if not extensions.exists():
            extensions.write_text("basicConstraints=CA:FALSE\n")
        openssl(
            folder,
            "req",
            *key,
            "-keyout",
            f"{name}.key",
            "-out",
            f"{name}.csr",
            "-subj",
            f"/CN={name}",
        )
        openssl(
            folder,
            *("x509", "-req", "-in", f"{name}.csr", "-CA", "ca.pem", "-CAkey", "ca.key"),
            *("-CAcreateserial", "-extfile", f"{name}.ext", "-out", f"{name}.pem"),
        )


def make_expired(folder: Path, name: str, expired: str) -> None:
    """Another certificate for the request of `name`, which was valid for a day in 2020.

    XX
    """
    (folder / "expired.conf").write_text(_EXPIRED_CONF)
    (folder / "issued.txt").write_text("")
    openssl(
        folder,
        *("ca", "-batch", "-notext", "-config", "expired.conf"),
        *("-startdate", "20200101000000Z", "-enddate", "20200102000000Z"),
        *("-extfile", f"{name}.ext", "-in", f"{name}.csr", "-out", f"{expired}.pem"),
    )
    shutil.copy(folder / f"{name}.key", folder / f"{expired}.key")
