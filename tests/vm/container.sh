# Sourced: a container with a real systemd over a disk of which nothing is changed. NSPAWN names another systemd-nspawn.

# The script, told with its arguments, once more in mounts of its own; from then on in an empty folder that goes with it.
in_own_mounts() {
    [ "$(id -u)" = 0 ] || { echo "$0: only root may boot a container" >&2; exit 1; }
    if [ "${IN_OWN_MOUNTS:-}" = "" ]; then
        local scratch code
        scratch=$(mktemp -d /tmp/mocapd-proof.XXXXXX)
        IN_OWN_MOUNTS=$scratch unshare --mount "$0" "$@" && code=0 || code=$?
        rm -rf "$scratch"
        exit $code
    fi
    cd "$IN_OWN_MOUNTS"
    mount --make-rprivate /
    mount -t tmpfs tmpfs .
    cd "$IN_OWN_MOUNTS"
}

# root/, which is that disk until it is written to
overlay() {
    mkdir up work root
    mount -t overlay overlay -o "lowerdir=$1,upperdir=$PWD/up,workdir=$PWD/work" root
}

# Boots root/ under this name, until its services are up; ends with the script.
boot() {
    "${NSPAWN:-systemd-nspawn}" --quiet --directory="$PWD/root" --boot --keep-unit --register=no --private-network \
        --link-journal=no --machine="$1" --console=pipe systemd.unit=multi-user.target >boot.log 2>&1 </dev/null &
    manager=$!
    trap 'kill -s TERM $manager 2>/dev/null; wait $manager || true' EXIT
    for _ in $(seq 200); do
        inside systemctl is-active --quiet multi-user.target 2>/dev/null && return
        kill -0 $manager 2>/dev/null || { cat boot.log >&2; exit 1; }
        sleep 0.3
    done
    echo "$0: it does not come up" >&2
    cat boot.log >&2
    exit 1
}

inside() {
    nsenter --target "$(pgrep --parent $manager | head -n 1)" --mount --uts --ipc --net --pid --cgroup \
        env --ignore-environment PATH=/opt/mocapd/bin:/usr/bin:/bin:/usr/sbin:/sbin LANG=C.UTF-8 TERM=dumb "$@"
}
