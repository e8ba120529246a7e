#!/usr/bin/env bash
# What vm_test.sh does in the machine once it was switched off and on again: the service comes up by itself, and goes.
set -uo pipefail
. "$(dirname "$0")/vm_rig.sh"

step "Switched off and on again"
wanted 60 "it is ready without any webcam" "$(is ActiveState active)"
told "systemctl show mocapd -P StatusText"
rig plug 1
rig plug 0
wanted 60 "the webcams come later: somebody is tracked, with nothing compiled anew" "$tracked"
wanted 1 "not one failure since boot" "$(is NRestarts 0)"
whose "each camera has its own webcam"

step "Stop, remove, purge"
told systemctl stop mocapd
wanted 5 "told to end, it ends well" "$(is Result success) && $(is ExecMainStatus 0)"
wanted 1 "the webcams are free" "! fuser /dev/video*"
told systemctl start mocapd
wanted 60 "started, it tracks" "$tracked"
told dpkg --remove mocapd
wanted 10 "removed, it runs no more and is not enabled" \
    "! systemctl is-active mocapd && ! find /etc/systemd/system -name 'mocapd*' | grep . && [ ! -e /usr/lib/mocapd ]"
wanted 1 "configuration and calibration are there for another time" "[ -f /etc/mocapd/config.toml ] && [ -f /var/lib/mocapd/calibration.toml ]"
told dpkg --purge mocapd
wanted 1 "purged without an answer, the calibration stays" "[ -f /var/lib/mocapd/calibration.toml ] && [ ! -e /var/cache/mocapd ]"
told dpkg --install "$proof/mocapd.deb"
told "echo 'mocapd mocapd/purge_state boolean true' | debconf-set-selections"
told dpkg --purge mocapd
wanted 1 "purged with the answer yes, nothing of it is left" \
    "! ls -d /var/lib/mocapd* /var/lib/private/mocapd* /var/cache/mocapd* /etc/mocapd /usr/lib/mocapd && ! getent passwd mocapd"

[ $failed = 0 ] || echo "FAILED, see above"
exit $failed
