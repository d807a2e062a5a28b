#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# check_packages.sh BUILD_FOLDER [PACKAGE...]: checks packages, desktop files and manual pages with the tools of Debian and the desktop. A check whose
# tool is missing is skipped with a message.
set -u
build=$1
shift
here=$(dirname "$0")
failed=0

check() {
  tool=$1
  shift
  if ! command -v "$tool" >/dev/null; then
    echo "skipped: $tool is not installed"
  elif said=$("$tool" "$@" 2>&1); then
    echo "passed: $tool"
  else
    printf 'FAILED: %s\n%s\n' "$tool" "$said"
    failed=1
  fi
}

[ $# -eq 0 ] || check lintian --fail-on error --allow-root "$@"
check desktop-file-validate "$here/todbench-gui.desktop"
check appstreamcli validate --no-net "$build/package/org.todbench.todbench.metainfo.xml"
check bash -n "$here/todbench.bash"
check zsh -n "$here/todbench.zsh"
check fish --no-execute "$here/todbench.fish"
unpacked=$(mktemp -d)
trap 'rm -rf "$unpacked"' EXIT
if command -v mandoc >/dev/null; then
  for page in "$build"/package/man/*/*.gz; do
    gunzip -c "$page" >"$unpacked/$(basename "$page" .gz)"
  done
  check mandoc -Tlint -Wwarning "$unpacked"/todbench*.1
else
  echo "skipped: mandoc is not installed"
fi
exit $failed
