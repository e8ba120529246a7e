#!/usr/bin/env bash
# Makes the Debian package from a wheel: mocapd with all that it runs on, by hash, in an environment under
# /usr/lib/mocapd. Why so: docs/decisions/debian-package.md. `make deb` calls it.
#
#   deb/build.sh PIP_PYTHON WHEEL OUT [SITE]     PIP_PYTHON: a Python with pip; OUT: the folder for the package;
#                                                SITE: what it runs on is there already and is not carried (for tests)
#
# It is for the Python and the machine that it is made with: DEB_PYTHON, /usr/bin/python3 unless set. Who gives it to others
# says who that is, by DEBFULLNAME and DEBEMAIL, as for Debian's own tools. Made again from the same commit, wheel and
# Python it is the same to the byte.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$here/..
pip_python=${1:?a Python with pip}
wheel=${2:?the wheel}
out=${3:?a folder for the package}
site=${4:-}
python=${DEB_PYTHON:-/usr/bin/python3}
prefix=usr/lib/mocapd

command -v dpkg-deb >/dev/null || { echo "$0: dpkg-deb is missing -- a Debian package is made on Debian or its like" >&2; exit 1; }
[ "${python#/usr/bin/}" != "$python" ] || { echo "$0: $python -- a package stands on the distribution's own Python, below /usr/bin" >&2; exit 1; }
version=$(basename "$wheel" | cut -d- -f2)
minor=$("$python" -c 'import sys; print(sys.version_info.minor)')
architecture=$(dpkg --print-architecture)
# of a domain that leads nowhere (RFC 2606): whoever has it from somebody was told by whom
maintainer="${DEBFULLNAME:-mocapd} <${DEBEMAIL:-mocapd@nobody.invalid}>"
# dates in the package are the commit's
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git -C "$root" log -1 --format=%ct 2>/dev/null || stat --format=%Y "$root/CHANGELOG.md")}
export SOURCE_DATE_EPOCH
# the order of names is that of their bytes
export LC_ALL=C.UTF-8
umask 022

stage=$(mktemp -d "${TMPDIR:-/tmp}/mocapd-deb.XXXXXX")
trap 'rm -rf "$stage"' EXIT
chmod 755 "$stage"
env=$stage/$prefix

"$python" -m venv --without-pip "$env"
# named as it will be called: `command` says where it was made
sed -i '/^command = /d' "$env/pyvenv.cfg"
install=("$pip_python" -m pip --python "$env/bin/python" --disable-pip-version-check install --quiet --no-compile --no-warn-script-location)
libraries=$(echo "$env"/lib/python3*/site-packages)
if [ -n "$site" ]; then
    echo "$site" >"$libraries/dependencies.pth"
else
    "${install[@]}" --require-hashes --only-binary :all: --requirement "$root/locks/run.txt"
fi
# the libraries' own tests, 5 % of it; nothing imports them
if [ -z "$site" ]; then
    find "$libraries" -type d -name tests -prune -exec rm -r {} +
    find "$libraries" -name RECORD -exec sed -i '\#/tests/#d' {} +
fi
"${install[@]}" --no-deps --no-index "$wheel"
# of the commands only ours; pip's note of where the wheel lay is of no use elsewhere, nor are its digests of both
find "$env/bin" -mindepth 1 ! -name 'python*' -delete
find "$env" -name direct_url.json -delete
find "$env" -name RECORD -exec sed -i -e '\#^\(\.\./\)*bin/#d' -e '/\/direct_url\.json,/d' {} +
printf '#!/%s/bin/python -P\nfrom mocapd.cli.main import main\nmain()\n' $prefix >"$env/bin/mocapd"
chmod 755 "$env/bin/mocapd"
# compiled here, so that nothing is written there later; a stamp by content, as dates change on the way
"$env/bin/python" -m compileall -q --invalidation-mode unchecked-hash -s "$stage" "$env/lib"

mkdir -p "$stage"/usr/{bin,share/{man/man1,bash-completion/completions,zsh/vendor-completions,fish/vendor_completions.d,doc/mocapd}}
ln -s ../lib/mocapd/bin/mocapd "$stage/usr/bin/mocapd"
mocapd() { "$env/bin/python" -P -m mocapd.cli.main "$@"; }
mocapd install-service --root "$stage" --python /$prefix/bin/python >/dev/null
mocapd man | gzip -9n >"$stage/usr/share/man/man1/mocapd.1.gz"
mocapd completion bash >"$stage/usr/share/bash-completion/completions/mocapd"
mocapd completion zsh >"$stage/usr/share/zsh/vendor-completions/_mocapd"
mocapd completion fish >"$stage/usr/share/fish/vendor_completions.d/mocapd.fish"
doc=$stage/usr/share/doc/mocapd
{ cat "$root/LICENSE"; echo; cat "$root/THIRD_PARTY_NOTICES.md"; } >"$doc/copyright"
gzip -9n <"$root/CHANGELOG.md" >"$doc/changelog.gz"
# as in the checkout, so that their links lead somewhere; clients/ and lab/ are not in the package
cp -r "$root"/*.md "$root/docs" "$doc"
ln -s "../../../${libraries#"$stage/usr/"}/mocapd" "$doc/mocapd"

# as dpkg-gencontrol counts [KiB]: what a folder takes is another matter on each file system
size=$(find "$stage" -mindepth 1 -printf '%y %s\n' | awk '{ kib += $1 == "f" ? int(($2 + 1023) / 1024) : 1 } END { print kib }')
mkdir "$stage/DEBIAN"
{
    echo "Maintainer: $maintainer"
    sed -e "s/@VERSION@/$version/; s/@ARCHITECTURE@/$architecture/; s/@SIZE@/$size/" \
        -e "s/@PYTHON@/3.$minor/; s/@NEXT_PYTHON@/3.$((minor + 1))/" "$here/control.in"
} >"$stage/DEBIAN/control"
install -m 755 "$here/postinst" "$here/prerm" "$here/postrm" "$stage/DEBIAN"
install -m 644 "$here/templates" "$stage/DEBIAN"
(cd "$stage" && find etc -type f -printf '/%p\n' | sort) >"$stage/DEBIAN/conffiles"
(cd "$stage" && find usr -type f -print0 | sort --zero-terminated | xargs --null md5sum) >"$stage/DEBIAN/md5sums"
if grep --recursive --quiet --fixed-strings "$stage" "$stage"; then
    echo "$0: the place where it was made is in: $(grep --recursive --files-with-matches --fixed-strings "$stage" "$stage")" >&2
    exit 1
fi
mkdir -p "$out"
# zstd: every Debian with this Python reads it, and xz would take minutes
dpkg-deb --root-owner-group -Zzstd -z9 --build "$stage" "$out/mocapd_${version}_$architecture.deb"
