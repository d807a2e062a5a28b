#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs one fuzzing target, beginning with its kept inputs. Usage: run_target.sh NAME SECONDS, from the root of the tree.
# New inputs go to build/fuzz/corpus/NAME, what is found to build/fuzz/findings/NAME-*, what it says to build/fuzz/NAME.log.
set -eu
name=$1
seconds=$2
mkdir -p "build/fuzz/corpus/$name" build/fuzz/findings
status=0
"build/fuzz/tests/fuzz/fuzz_$name" -max_total_time="$seconds" -max_len=65536 -rss_limit_mb=2048 -malloc_limit_mb=1024 -timeout=20 \
  -print_final_stats=1 -artifact_prefix="build/fuzz/findings/$name-" "build/fuzz/corpus/$name" "tests/fuzz/corpus/$name" \
  >"build/fuzz/$name.log" 2>&1 || status=$?
inputs=$(sed -n 's/^stat::number_of_executed_units: *//p' "build/fuzz/$name.log")
if [ "$status" -eq 0 ]; then
  echo "fuzz $name: ${inputs:-no} inputs" >&2
  exit 0
fi
echo "fuzz $name: found something, see build/fuzz/$name.log" >&2
grep -E "SUMMARY|ERROR" "build/fuzz/$name.log" >&2 || tail -n 5 "build/fuzz/$name.log" >&2
exit 1
