#!/usr/bin/env bash
# The service under a real systemd: boots one in a container over this machine's own disk, of which nothing is changed,
# and does service_steps.sh there with two simulated webcams. Some minutes, most of them for the compiler.
#
#   sudo tests/vm/service_proof.sh PYTHON      PYTHON: that of an environment with mocapd's dependencies, such as
#                                              .venv/bin/python, where all users may read it; its version is /usr/bin/python3's
#
# Needs systemd, dbus and systemd-container (systemd-nspawn).
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$here/../..
python=${1:?which Python has the dependencies of mocapd?}
. "$here/container.sh"
in_own_mounts "$python"
site=$("$python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')

overlay /
/usr/bin/python3 -m venv --without-pip root/opt/mocapd
own=$(echo root/opt/mocapd/lib/python3*/site-packages)
echo "$site" >"$own/dependencies.pth"
cp -r "$root/mocapd" "$root/calib" "$own"
mv "$own/calib" "$own/mocapd/calib"
find "$own/mocapd" -name __pycache__ -prune -exec rm -r {} +
# the environment was made in another place than it will be in
sed -i "s#$PWD/root##" root/opt/mocapd/pyvenv.cfg
printf '#!/opt/mocapd/bin/python\nfrom mocapd.cli.main import main\nmain()\n' >root/opt/mocapd/bin/mocapd
chmod 755 root/opt/mocapd/bin/mocapd
chmod -R a+rX root/opt/mocapd
cp "$here/service_steps.sh" "$here/steps.sh" root/opt/mocapd/
rm -f root/etc/systemd/system/mocapd* root/etc/systemd/system/multi-user.target.wants/mocapd*

boot mocapd-service-proof
inside bash /opt/mocapd/service_steps.sh
