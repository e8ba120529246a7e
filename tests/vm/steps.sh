# Sourced by what is done in the container: each command as an admin types it, with what must come of it.
failed=0

told() { # a command, shown with what it says
    echo "# $*"
    bash -c "$*" 2>&1 | cut -c1-160
}
wanted() { # seconds, what for, a command: that it comes to be true; every: how often it is looked at [s]
    local until=$((SECONDS + $1)) what=$2
    shift 2
    until bash -c "$*" >/dev/null 2>&1; do
        if ((SECONDS >= until)); then
            echo "FAILED: $what"
            failed=1
            return
        fi
        sleep "${every:-0.2}"
    done
    echo "ok: $what"
}
is() { echo "[ \"\$(systemctl show mocapd -P $1)\" = \"$2\" ]"; }
state() { echo "systemctl show mocapd -P StatusText | grep -q '$1'"; }
logged() { echo "journalctl -u mocapd -o cat --no-pager | grep -q '$1'"; }
