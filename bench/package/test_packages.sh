#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# test_packages.sh PACKAGE_FOLDER: tests the packages in a new Debian system: install, demonstration, upgrade, removal. mmdebstrap creates the system
# from the archive that this machine uses. Exit code 77, with the reason, if the system cannot be created.
set -eu
packages=$(cd "$1" && pwd)

skip() {
  echo "skipped: $*"
  exit 77
}
command -v mmdebstrap >/dev/null || skip "mmdebstrap is not installed"
[ "$(id -u)" -eq 0 ] || skip "this test needs root"
set -- "$packages"/todbench_*.deb "$packages"/todbench-gui_*.deb "$packages"/libtodbench-dev_*.deb "$packages"/todbench-doc_*.deb \
  "$packages"/python3-todbench_*.deb
for file in "$@"; do [ -e "$file" ] || skip "no packages in $packages: make them with ./run package"; done

root=$(mktemp -d /tmp/todbench-debian.XXXXXX)
trap 'rm -rf "$root"' EXIT
begin=$(date +%s)
stage() { echo "$(($(date +%s) - begin)) s: $*"; }

stage "create a new Debian system"
mmdebstrap --quiet --variant=apt --mode="${TODBENCH_MMDEBSTRAP_MODE:-auto}" "${TODBENCH_DEBIAN:-bookworm}" "$root" \
  >"$root.log" 2>&1 || { tail -n 3 "$root.log"; rm -f "$root.log"; skip "the Debian system could not be created"; }
rm -f "$root.log"
mkdir "$root/debs" "$root/earlier"
cp "$@" "$root/debs"

# The same packages under an earlier version, for the upgrade.
for file in "$root"/debs/*.deb; do
  dpkg-deb -R "$file" "$root/repacked"
  sed -i -e 's/^Version: .*/Version: 0.0.1-1/' -e 's/todbench (= [^)]*)/todbench (= 0.0.1-1)/' "$root/repacked/DEBIAN/control"
  dpkg-deb --root-owner-group -Znone -b "$root/repacked" "$root/earlier/$(basename "$file")" >/dev/null
  rm -rf "$root/repacked"
done

inside() { chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"; }
apt() { inside sh -c "apt-get -qq -y --no-install-recommends $* </dev/null" >"$root/apt.log" 2>&1 || { tail -n 20 "$root/apt.log"; exit 1; }; }
version() { inside dpkg-query -W -f '${Version}' todbench; }

stage "install the program alone"
apt update
apt install /earlier/todbench_*.deb
[ "$(version)" = 0.0.1-1 ]
stage "upgrade and install the other packages"
apt install /debs/*.deb
[ "$(version)" = "$(dpkg-deb -f "$packages"/todbench_*.deb Version)" ]

stage "demonstration"
mount --bind /proc "$root/proc" 2>/dev/null && trap 'umount "$root/proc"; rm -rf "$root"' EXIT
demonstration=$(date +%s)
set +e
inside sh -c "cd /root && todbench demo --quiet --out demo"
code=$?
set -e
stage "demonstration ended with exit code $code after $(($(date +%s) - demonstration)) s"
[ "$code" -eq 0 ] || exit 1
inside todbench verify /root/demo >/dev/null
inside todbench-gui --report /root/demo >/dev/null
[ -s "$root/root/demo/report.pdf" ]
inside test -e /usr/share/man/man1/todbench-measure.1.gz -o -e /etc/dpkg/dpkg.cfg.d/docker

stage "Python package"
cat >"$root/root/fit.py" <<'EOF'
import numpy as np
import todbench as tb

fit = tb.fit_psychometric(*tb.read_levels("/usr/share/doc/todbench-doc/docs/examples/trials.csv"))
assert fit.verdict == "ok" and f"{fit.threshold:.4f}" == "2.8161", fit.to_dict()
frame = next(iter(tb.open_camera("sim:sc2000")))
assert frame.counts.shape == (240, 320) and np.shares_memory(frame.counts, frame.counts)
assert tb.open_session("/root/demo").verdict == "pass"
EOF
inside python3 /root/fit.py

stage "removal"
apt purge todbench todbench-gui libtodbench-dev todbench-doc python3-todbench
left=$(inside find /usr /etc /var/lib -path /usr/share/mime -prune -o -name '*todbench*' -print | grep -v '^/var/lib/apt\|^/var/lib/dpkg' || true)
[ -z "$left" ] || { printf 'files left after the removal:\n%s\n' "$left"; exit 1; }
stage "passed"
