#!/usr/bin/env bash
# What deb_proof.sh does in the machine that it boots.
set -uo pipefail
. "$(dirname "$0")/steps.sh"
export DEBIAN_FRONTEND=noninteractive # as on a machine that nobody sits at: what is asked has no answer

ours() { # every file and user of ours on this disk, but for the package itself
    find / -xdev \( -path /proc -o -path /sys -o -path /opt/proof -o -path /var/log \) -prune -o \
        -name '*mocapd*' ! -path '/var/lib/dpkg/*' ! -path '/run/*' ! -path '/tmp/*' -print
    getent passwd mocapd
}

wanted 1 "there is no libGL, no libusb" "! find / -xdev -name 'libGL.so*' -o -xdev -name 'libusb-*' | grep ."
ours >/tmp/before
find / -xdev -path /proc -prune -o -type f -print | sort >/tmp/files-before

told dpkg --install /opt/proof/mocapd.deb
wanted 1 "nothing runs, nothing is enabled" "$(is ActiveState inactive) && ! systemctl is-enabled mocapd"
wanted 1 "its user is there, in the group video" "id -nG mocapd | grep -w video"
wanted 1 "the units are right" "systemd-analyze verify mocapd.service"
told mocapd version
told 'mocapd check-config | head -n 3'
told '/usr/lib/mocapd/bin/python -c "import cv2, zenoh, numba, mocapd.cli.main; print(cv2.__version__)"'
wanted 60 "cameras are looked for without libusb" "mocapd cameras; [ \$? -lt 2 ]"

cat >>/etc/mocapd/config.toml <<'TOML'
[[camera]]
id = "cam0"
source = "sim:living_room#cam0"
[[camera]]
id = "cam1"
source = "sim:living_room#cam1"
TOML
told systemctl enable --now mocapd
wanted 5 "it is ready while the tracker is compiled" "$(state compiling) && $(is ActiveState active)"
wanted 20 "a line in the log says so" "$(logged 'compiling the tracker')"
wanted 1800 "somebody is tracked" "$(state 'somebody is tracked')"
told 'systemctl status mocapd --no-pager --lines=0'
told 'journalctl -u mocapd -o cat --no-pager | grep cache_warmup'
wanted 60 "games get frames" "timeout 50 mocapd watch --count 2"

pid=$(systemctl show mocapd -P MainPID)
told dpkg --install /opt/proof/mocapd.deb
wanted 1 "an update starts it again" "[ \$(systemctl show mocapd -P MainPID) != $pid ]"
wanted 60 "after an update it runs again, with nothing compiled anew" "$(state 'somebody is tracked')"
wanted 1 "the configuration stayed" "grep -q cam1 /etc/mocapd/config.toml"

told dpkg --remove mocapd
wanted 10 "removed, it runs no more and is not enabled" \
    "! systemctl is-active mocapd && ! find /etc/systemd/system -name 'mocapd*' | grep . && [ ! -e /usr/lib/mocapd ]"
wanted 1 "the configuration is there for another time" "[ -f /etc/mocapd/config.toml ]"
touch /var/lib/private/mocapd/calibration.toml
told dpkg --purge mocapd
wanted 1 "purged without an answer, the calibration stays" "[ -f /var/lib/mocapd/calibration.toml ] && [ ! -e /var/cache/mocapd ]"

told dpkg --install /opt/proof/mocapd.deb
told "echo 'mocapd mocapd/purge_state boolean true' | debconf-set-selections"
told dpkg --purge mocapd
ours >/tmp/after
find / -xdev -path /proc -prune -o -type f -print | sort >/tmp/files-after
wanted 1 "purged with the answer yes, nothing of it is left" "cmp /tmp/before /tmp/after"
wanted 1 "no other file is there that was not there before" \
    "! comm -13 /tmp/files-before /tmp/files-after | grep -v -e ^/var/log -e ^/tmp -e ^/sys -e ^/run"
exit $failed
