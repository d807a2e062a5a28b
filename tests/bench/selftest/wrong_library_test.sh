#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# wrong_library_test.sh PROGRAM LIBRARY: the self-test passes, and ends with 7 with a function of the system that is wrong by
# one in a million.
set -eu
program=$1 library=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export XDG_STATE_HOME="$folder"

"$program" selftest --json >"$folder/right.json"
status=0
LD_PRELOAD="$library" "$program" selftest --json >"$folder/wrong.json" || status=$?

[ "$status" -eq 7 ] || { echo "exit code $status in place of 7" >&2; exit 1; }
grep -q '"failed":0' "$folder/right.json"
if grep -q '"failed":0' "$folder/wrong.json"; then
  echo "no case failed" >&2
  exit 1
fi
