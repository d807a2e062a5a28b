#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# A shipped example of a module keeps the contract and sharpens as the others do.
# Usage: modules_test.sh TODBENCH INTERPRETER PACKAGE COMMAND. Exit 0: passed, 77: there is no interpreter (said why on stdout), 1: failed.
set -eu
todbench=$1 interpreter=$2 package=$3 command=$4
command -v "$interpreter" >/dev/null || { echo "SKIPPED: $interpreter is not installed (apt-get install $package)"; exit 77; }
case "$command" in
  *python3*) "$interpreter" -c "import numpy" 2>/dev/null || { echo "SKIPPED: numpy is not installed (apt-get install $package)"; exit 77; } ;;
esac
found=$("$todbench" module check "$command" --limit-ms 120000 --json) || { echo "FAILED: $found"; exit 1; }
for expected in '"linear": *true' '"network_cut"' '\[0(\.0)?, *0(\.0)?, *0(\.0)?, *-0\.25, *2(\.0)?, *-0\.25, *0(\.0)?, *0(\.0)?, *0(\.0)?\]'; do
  echo "$found" | grep -Eq -- "$expected" || { echo "FAILED: no $expected in $found"; exit 1; }
done
echo "PASSED: $found"
