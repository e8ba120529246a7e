#!/usr/bin/env bash
# What vm_test.sh does in the machine that it boots: the package installed, and everything that befalls it.
set -uo pipefail
. "$(dirname "$0")/vm_rig.sh"

step "The package, and two webcams"
wanted 5 "a real kernel with uvcvideo and a real systemd" "[ -d /sys/bus/usb/drivers/uvcvideo ] && systemctl is-system-running | grep -v offline"
rig plug 0
rig plug 1
told uname -r
told dpkg --install "$proof/mocapd.deb"
wanted 1 "nothing runs, nothing is enabled" "$(is ActiveState inactive) && ! systemctl is-enabled mocapd"
wanted 1 "its user is there, in the group video" "id -nG mocapd | grep -w video"
wanted 1 "the units are right" "systemd-analyze verify mocapd.service"
told mocapd cameras
wanted 30 "both webcams are listed with socket and serial number" \
    "mocapd cameras | grep -q usb:1-1:046d:0825:CAM0000 && mocapd cameras | grep -q usb:1-2:046d:0825:CAM0001"
told "mocapd doctor"

step "A calibration of two cameras, by socket and serial number; the service"
cp -r "$proof/state" /var/lib/mocapd
chown -R mocapd: /var/lib/mocapd
# one processor, that acts the webcams too: the search for somebody without a shirt is too much for it
sed -i 's/^\[tracker\]/[tracker]\nname = "shirt"/' /etc/mocapd/config.toml
told mocapd check-config --changed
began=$SECONDS
told systemctl enable --now mocapd
echo "ready after $((SECONDS - began)) s"
wanted 1 "it is ready while the tracker is compiled" "$(state compiling) && $(is ActiveState active)"
wanted 30 "a line in the log says so" "$(logged 'compiling the tracker')"
every=5 wanted 3600 "somebody is tracked by two USB webcams" "$tracked"
told 'journalctl -u mocapd -o cat --no-pager | grep -e cache_warmup -e supervision'
told 'systemctl status mocapd --no-pager --lines=0'
told mocapd status
wanted 60 "games get frames" "timeout 50 mocapd watch --count 2"
whose "each camera of the calibration has its own webcam"
told 'mocapd as-service doctor'

step "The unit's sandbox, on this kernel"
group=/sys/fs/cgroup$(systemctl show mocapd -P ControlGroup)
in_its_place() { echo "bash -c 'echo \$\$ >$group/cgroup.procs; exec $*'"; }
wanted 1 "systemd could set up all that the unit asks for" \
    "! journalctl -b -o cat --no-pager | grep -i mocapd | grep -i -e 'not support' -e 'without' -e 'ignoring'"
wanted 1 "even root may not open the disk there" "! $(in_its_place head -c1 /dev/ubda) && head -c1 /dev/ubda"
wanted 1 "but the webcams" "$(in_its_place v4l2-ctl --device /dev/video0 --all)"
heard() { # the sockets that udev tells of webcams, and those of the service
    awk '$2 == 15 && $4 == "00000002" { print "socket:[" $10 "]" }' /proc/net/netlink |
        grep -qxFf - <(find /proc/$(systemctl show mocapd -P MainPID)/fd -lname 'socket:*' -printf '%l\n')
}
export -f heard
wanted 1 "udev's messages reach it" heard
told 'systemd-analyze security mocapd --no-pager | tail -n 1'

step "Unplug one, into another socket, both into each other's"
since
rig unplug 0
wanted 5 "the loss is told" "$(newly 'left.*unplugged') && $(state 'left lost')"
wanted 20 "the other goes on" "$(state 'right live')"
rig plug 0 --port 4
wanted 10 "it is live again" "$both"
wanted 5 "and it is told that its socket is another one" "$(newly 'left: found in another USB port')"
wanted 90 "somebody is tracked" "$tracked"
whose "the right calibration went to the right camera"
rig unplug 0
rig unplug 1
wanted 10 "none is there" "mocapd status; [ \$? = 150 ]"
wanted 1 "the service runs" "$(is ActiveState active) && $(is NRestarts 0)"
rig plug 1 --port 0
rig plug 0 --port 1
wanted 10 "both are live" "$both"
wanted 90 "somebody is tracked" "$tracked"
whose "swapped, each kept its own calibration"
rig unplug 0
rig unplug 1
rig plug 0
rig plug 1
wanted 90 "back where they were" "$tracked"

step "One freezes"
since
rig ctl 0 freeze
wanted 5 "noticed and told" "$(newly 'left.*sent nothing for') && $(state 'left lost')"
told "systemctl show mocapd -P StatusText"
wanted 5 "the other goes on" "$(state 'right live')"
rig ctl 0 thaw
wanted 90 "thawed, it is live" "$tracked"
rig ctl 1 corrupt 40
wanted 10 "damaged pictures are told" "$(newly 'right.*damaged')"
rig unplug 0
rig plug 0 --mjpeg "$proof/still.mjpeg"
wanted 15 "so is a webcam that shows one picture for ever" "$(newly 'left.*same picture')"
rig unplug 0
rig plug 0
wanted 90 "both are well" "$tracked"

step "The disk is full"
since
told 'df -h --output=size,avail /'
dd if=/dev/zero of=/filler bs=1M status=none 2>/dev/null
dd if=/dev/zero of=/filler2 bs=4k status=none 2>/dev/null
wanted 1 "not a byte is free" "[ \$(df --output=avail / | tail -n 1) -lt 8 ]"
told 'mocapd as-service record /var/lib/mocapd/full.mcap --pictures --seconds 5'
wanted 1 "no recording, and who wanted it is told the file" \
    "said=\$(mocapd as-service record /var/lib/mocapd/full.mcap --pictures --seconds 5 2>&1); [ \$? != 0 ] && [[ \$said == *full.mcap* ]]"
wanted 10 "doctor tells it" "mocapd as-service doctor | grep -i '^\(bad\|warn\).*\(room\|full\|free\)'"
wanted 90 "it goes on" "$tracked && $(is NRestarts 0)"
told systemctl kill --signal=KILL mocapd
wanted 90 "killed with a full disk, it starts again" "$(is NRestarts 1) && $tracked"
wanted 1 "the calibration is whole" "cmp $proof/state/calibration.toml /var/lib/mocapd/calibration.toml"
rm -f /filler /filler2 /var/lib/mocapd/full.mcap
whose "and all is as before"

step "kill -9"
pid=$(systemctl show mocapd -P MainPID)
told systemctl kill --signal=KILL mocapd
wanted 90 "started again, it tracks" "[ \$(systemctl show mocapd -P MainPID) != $pid ] && $(is NRestarts 2) && $tracked"
told 'kill -STOP $(systemctl show mocapd -P MainPID)'
wanted 120 "stopped, it is ended and started again" "$(is NRestarts 3) && $tracked"

step "Reload"
since
echo 'nonsense = 1' >>/etc/mocapd/config.toml
wanted 1 "a wrong configuration is refused to whoever reloads" "! systemctl reload mocapd"
wanted 10 "the log says why" "$(newly 'nonsense') && $(newly 'goes on as it was')"
wanted 60 "and the old one goes on" "$(is ActiveState active) && $tracked"
sed -i '$d' /etc/mocapd/config.toml
sed -i 's/stature_m = 1.75/stature_m = 1.80/' /var/lib/mocapd/calibration.toml
told systemctl reload mocapd
wanted 60 "a right one is taken up" "$(newly 'taken up, within')"
wanted 60 "with both webcams" "$(is ActiveState active) && $tracked"

[ $failed = 0 ] || echo "FAILED, see above"
exit $failed
