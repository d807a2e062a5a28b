#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# demonstration_program_test.sh TODBENCH TODBENCH_DEMO: the program that "./run demo" builds has the same demonstration as the whole one, and
# nothing else.
set -eu
todbench=$1
demonstration=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

"$todbench" demo --help >"$folder/whole"
"$demonstration" demo --help >"$folder/alone"
grep -q -- --full "$folder/whole"
cmp "$folder/whole" "$folder/alone"
[ "$("$todbench" --version)" = "$("$demonstration" --version)" ]
set +e
"$demonstration" demo --camera none 2>"$folder/alone"
[ $? -eq 2 ] || exit 1
"$todbench" demo --camera none 2>"$folder/whole"
cmp "$folder/whole" "$folder/alone" || exit 1
"$demonstration" measure 2>"$folder/refused"
[ $? -eq 2 ] && grep -q "unknown command 'measure'" "$folder/refused"
