#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# window_test.sh PROGRAM: the manual of the window, and a session that is not there.
set -eu
export QT_QPA_PLATFORM=offscreen
program=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() { echo "$*"; exit 1; }

TODBENCH_RELEASE_DATE=2026-11-22 "$program" --manual "$folder/todbench-gui.1" 2>"$folder/said" || fail "$(cat "$folder/said")"
for option in sessions theme size screenshots report; do
  grep -q "^\.B .*\\\\-\\\\-$option" "$folder/todbench-gui.1" || fail "no --$option in the manual"
done
grep -q "manual" "$folder/todbench-gui.1" && fail "the manual has the option that writes it"
if command -v mandoc >/dev/null; then mandoc -Tlint -Wwarning "$folder/todbench-gui.1"; fi

code=0
"$program" "$folder/none/session.toml" 2>"$folder/said" || code=$?
[ $code -eq 2 ] || fail "exit code $code"
grep -q "none: not a session folder" "$folder/said" || fail "$(cat "$folder/said")"
[ ! -e "$folder/none" ] || fail "made a folder"
