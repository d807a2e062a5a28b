#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# session_of_0_1_test.sh PROGRAM SESSION: a session that version 0.1 wrote is read, and says what it said then.
set -eu
program=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() { echo "$*"; exit 1; }
# Name of a column of a table without quotes -> its field in the last row.
field() { awk -F , -v name="$2" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) column = i } END { print $column }' "$1"; }

cp -r "$2" "$folder/session-0.1"
cd "$folder"
"$program" verify session-0.1 >/dev/null || fail "is not intact"
"$program" report session-0.1 >/dev/null || fail "no report"
"$program" verify session-0.1 >/dev/null || fail "is not intact after its report was made again"
grep -q '^verdict,decision,,,,,,,,pass,' session-0.1/report.csv || fail "$(cat session-0.1/report.csv)"
s75=$(field "$2/curve.csv" s75_mrad)
[ "${s75%%.*}" -eq 2 ] || fail "S75 $s75"
grep -q "^simulated,s75_mrad,16.9,$s75,$(field "$2/curve.csv" s75_ci95_low_mrad),$(field "$2/curve.csv" s75_ci95_high_mrad),95,,mrad,ok,,$" \
  session-0.1/report.csv || fail "$(cat session-0.1/report.csv)"
"$program" range --tod session-0.1 --size-m 2.3 --delta-t-k 16.9 --quiet >/dev/null || fail "no range"
