# Sourced by what vm_test.sh does in the machine that it boots: webcams that are plugged, and whose pictures come.
proof=$(cd "$(dirname "$0")" && pwd)
. "$proof/steps.sh"
export DEBIAN_FRONTEND=noninteractive # nobody sits there
python=/usr/lib/mocapd/bin/python

step() { echo; echo "== $* ($((SECONDS / 60)) min)"; }
rig() { # plug N [--port P] | unplug N | ctl N COMMAND: the webcams' plugs, in another's hand
    echo "# ($*)"
    bash /mnt/share/rig/cam.sh "$@" >/dev/null 2>&1 || { echo "FAILED: $*"; failed=1; }
}
since() { mark=$(date '+%F %T'); } # what is logged from here on
newly() { echo "journalctl -u mocapd -o cat --no-pager --since '$mark' | grep -q '$1'"; }
both="$(state 'left live') && $(state 'right live')"
tracked="$(state 'somebody is tracked') && $both"
whose() { # that each camera of the service shows what its webcam does: a second of pictures, the first of each compared
    rm -f /var/lib/mocapd/whose.mcap
    mocapd as-service record /var/lib/mocapd/whose.mcap --pictures --seconds 1 >/tmp/record.log 2>&1 || cat /tmp/record.log
    $python -P "$proof/vm_whose.py" /var/lib/mocapd/whose.mcap "$proof" >/tmp/whose 2>&1
    wanted 1 "$1" "[ \"\$(cat /tmp/whose | tr '\n' ' ')\" = 'left cam0 right cam1 ' ]"
    [ "$(wc -l </tmp/whose)" = 2 ] || tail -n 3 /tmp/whose
}
