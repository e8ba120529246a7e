#!/usr/bin/env bash
# What service_proof.sh does in the machine that it boots: each command as an admin types it, with what must come of it.
set -uo pipefail
. "$(dirname "$0")/steps.sh"

told mocapd install-service
told systemd-sysusers
told chgrp mocapd /etc/mocapd/config.toml
told systemctl daemon-reload
cat >/etc/mocapd/config.toml <<'TOML'
[[camera]]
id = "cam0"
source = "sim:living_room#cam0"
[[camera]]
id = "cam1"
source = "sim:living_room#cam1"
TOML

told systemctl enable --now mocapd
wanted 1 "it is ready while the tracker is compiled" "$(state compiling) && $(is ActiveState active)"
wanted 5 "the time limit is stretched meanwhile" "$(is WatchdogUSec 30min)"
wanted 1200 "somebody is tracked" "$(state 'somebody is tracked')"
wanted 5 "the time limit is as usual" "$(is WatchdogUSec 30s)"
told 'systemctl status mocapd --no-pager --lines=0'
told 'systemd-analyze security mocapd --no-pager | tail -n 1'
wanted 30 "games get frames" "timeout 20 mocapd watch --count 2"
wanted 30 "mocapd status says so, of the service and as it" "mocapd status && mocapd as-service status"
wanted 30 "its page is found" "mocapd as-service calibrate --no-browser | grep http://127.0.0.1"
wanted 1 "no uninstall while it is enabled" "mocapd uninstall-service; [ \$? = 78 ]"

told systemctl reload mocapd
wanted 60 "the configuration is taken up" "$(logged 'taken up, within')"
wanted 20 "after which it is not reloading" "$(is ActiveState active)"
echo 'nonsense = 1' >>/etc/mocapd/config.toml
wanted 1 "a wrong one is refused to whoever reloads" "! systemctl reload mocapd"
wanted 20 "and in the log" "$(logged 'the session goes on as it was')"
wanted 20 "and the old one goes on" "$(is ActiveState active)"
told systemctl restart mocapd
wanted 20 "which a new start does not, and ends" "$(is ActiveState failed) && $(is ExecMainStatus 78) && $(is NRestarts 0)"
sed -i '$d' /etc/mocapd/config.toml

told systemctl start mocapd
wanted 60 "mended, it runs" "$(state 'somebody is tracked')"
told systemctl kill --signal=KILL mocapd
wanted 60 "killed, it is started again" "$(is NRestarts 1) && $(state 'somebody is tracked')"
told 'kill -STOP $(systemctl show mocapd -P MainPID)'
wanted 120 "stopped, it is ended and started again" "$(is NRestarts 2) && $(state 'somebody is tracked')"
wanted 1 "and the log says where it was" "$(logged 'pipeline/loop.py')"

told systemctl stop mocapd
wanted 5 "told to end, it ends well" "$(is Result success) && $(is ExecMainStatus 0)"
told systemctl disable mocapd
told mocapd uninstall-service
wanted 1 "nothing is left but what is the admin's" "[ -z \"\$(ls /etc/systemd/system | grep mocapd)\" ] && [ -f /etc/mocapd/config.toml ]"
exit $failed
