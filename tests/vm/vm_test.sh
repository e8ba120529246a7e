#!/usr/bin/env bash
# The Debian package on a real kernel with two USB webcams: boots the virtual machine of ../shared/vm, gives its webcams
# films of the demo's living room, and does vm_steps.sh there. `make vm-test` calls it; docs/vm.md has a transcript.
#
#   sudo tests/vm/vm_test.sh PYTHON DEB       PYTHON: that of .venv; DEB: of `make deb`, made with Python 3.11 (Debian 12)
#
# The first time it builds the machine's disk and a kernel, a quarter of an hour; then it takes as long as the guest's one
# processor needs to compile the tracker. All of it is kept in VM_HOME (~/.cache/mocapd-vm), two gigabytes.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
python=${1:?which Python has mocapd?}
deb=$(realpath "${2:?which Debian package?}")
vm=${VM_FOLDER:-$root/../shared/vm}
home=${VM_HOME:-${XDG_CACHE_HOME:-$HOME/.cache}/mocapd-vm}

[ -x "$vm/boot_uml.sh" ] || {
    echo "$0: the virtual machine is missing: $vm -- put its folder there, or say where it is with VM_FOLDER" >&2
    exit 2
}
vm=$(realpath "$vm") # the disk is kept by its builder's path
[ "$(id -u)" = 0 ] || { echo "$0: only root may build the machine's disk -- sudo" >&2; exit 2; }
[ "$(dpkg-deb --field "$deb" Depends | grep -c 'python3 (>= 3.11')" = 1 ] || {
    echo "$0: $deb is not for Python 3.11, which the machine has -- make it on Debian 12" >&2
    exit 2
}

mkdir -p "$home"
export VM_CACHE=$home/cache VM_RUN=$home/run VM_SHARE=$home/share VM_WHEELHOUSE=$home/wheelhouse UML_BUILD=$home/uml-build
"$vm/build_image.sh"
"$vm/uml/build_uml.sh"

"$vm/halt.sh"
rm -rf "$VM_SHARE"
mkdir -p "$VM_SHARE/proof"
cp -r "$vm/share/." "$VM_SHARE"
chmod -R u+w "$VM_SHARE"
echo "films of the demo's living room"
PYTHONPATH=$root nice "$python" "$here/vm_home.py" "$home/home"
for camera in 0 1; do
    "$vm/feed.sh" $camera "$home/home/cam$camera.mp4" >/dev/null
    cp "$home/home/scribble/cam$camera.png" "$VM_SHARE/proof"
done
ffmpeg -nostdin -loglevel error -y -f mjpeg -i "$VM_SHARE/video/cam0.mjpeg" -frames:v 1 -c copy "$VM_SHARE/proof/still.mjpeg"
cp -r "$home/home/state" "$VM_SHARE/proof"
cp "$deb" "$VM_SHARE/proof/mocapd.deb"
cp "$here"/vm_steps*.sh "$here/vm_rig.sh" "$here/steps.sh" "$here/vm_whose.py" "$VM_SHARE/proof"

boot() { # now and then the line to the machine does not come up
    for _ in 1 2 3; do
        "$vm/boot_uml.sh" "$@" && return
        "$vm/halt.sh"
    done
    exit 1
}
trap '"$vm/halt.sh"' EXIT
failed=0
boot
"$vm/run_in_vm.sh" bash /mnt/share/proof/vm_steps.sh || failed=1
"$vm/halt.sh"
boot --keep
"$vm/run_in_vm.sh" bash /mnt/share/proof/vm_steps_after_boot.sh || failed=1
echo
echo "$((SECONDS / 60)) min $((SECONDS % 60)) s, $([ $failed = 0 ] && echo 'every step as wanted' || echo 'FAILED, see above')"
exit $failed
