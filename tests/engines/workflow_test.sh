#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The printed Makefile and Snakefile, for real: a job that fails once and ends its workflow, the workflow again; one table, byte for byte, as
# one process.
# Usage: workflow_test.sh TODBENCH make|snakemake. Exit 0: passed, 77: it is not installed (said on stdout), 1: failed.
set -eu
todbench=$1
tool=$2
. "$(dirname "$0")/one_table.sh"
fail() { echo "FAILED: $*"; tail -n 20 "$work/log"; exit 1; }
command -v "$tool" >/dev/null || { echo "SKIPPED: $tool is not installed (apt-get install $tool)"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export HOME="$work"
cd "$work"
sweep workflow
cat >"$work/program" <<PROGRAM
#!/bin/sh
case "\$*" in
  *"--index 2"*) mkdir "$work/failed" 2>/dev/null && exit 1 ;;
esac
echo "\$*" >>"$work/started"
exec "$todbench" "\$@"
PROGRAM
chmod +x "$work/program"
cd workflow
case $tool in
  make) file=Makefile; run() { make -j 2 >"$work/log" 2>&1; } ;;
  snakemake) file=Snakefile; run() { snakemake --cores 2 --quiet >"$work/log" 2>&1; } ;;
esac
"$todbench" sweep tasks s.toml --for "$tool" --chunk 2 --program "$work/program" --quiet >$file
run && fail "$tool did not say that a job failed"
[ -d "$work/failed" ] || fail "the third job was not reached"
run || fail "$tool says $?"
[ "$(wc -l <"$work/started")" -eq 4 ] || fail "jobs that were done were started again"
cd "$work"
serial_table
same_table workflow
echo "PASSED: $(tail -n +2 serial/s.results/table.csv | wc -l) rows, one table"
