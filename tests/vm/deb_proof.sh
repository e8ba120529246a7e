#!/usr/bin/env bash
# The Debian package installed, started, updated, removed and purged under a real systemd, in a Debian with nothing but
# systemd, udev and Python: no libGL, no libusb. Of the given disk nothing is changed. Some minutes, most of them for the compiler.
#
#   sudo tests/vm/deb_proof.sh DEB DISK        DEB: of `make deb`; DISK: a folder, made by
#       mmdebstrap --variant=minbase --include=systemd-sysv,dbus,udev,python3 bookworm DISK
#
# Needs systemd-container (systemd-nspawn), and mmdebstrap for that.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
deb=$(realpath "${1:?which Debian package?}")
disk=$(realpath "${2:?in which Debian? see the head of $0}")
. "$here/container.sh"
in_own_mounts "$deb" "$disk"

overlay "$disk"
mkdir root/opt/proof
cp "$deb" root/opt/proof/mocapd.deb
cp "$here/deb_steps.sh" "$here/steps.sh" root/opt/proof/
boot mocapd-deb-proof
inside bash /opt/proof/deb_steps.sh
