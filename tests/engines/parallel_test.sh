#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The same table, byte for byte, from one process, from four at a time, and from GNU parallel that is killed with one of its jobs and resumed.
# Usage: parallel_test.sh TODBENCH. Exit 0: passed, 77: there is no GNU parallel (said on stdout), 1: failed.
set -eu
todbench=$1
fail() { echo "FAILED: $*"; exit 1; }
parallel --version 2>/dev/null | grep -q "^GNU parallel" || {
  echo "SKIPPED: GNU parallel is not installed (apt-get install parallel)"
  exit 77
}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export HOME="$work" # parallel writes there
cd "$work"

for way in serial local parallel; do
  mkdir "$way"
  cat >"$way/s.toml" <<'SWEEP'
kind = "estimate"
where = "detector_um <= pitch_um"
[base]
accuracy = "draft"
delta_t_k = [16.9]
[grid]
netd_k = [0.05, 0.2, 0.4]
detector_um = [30, 42.5]
[repeat]
seeds = 2
SWEEP
done
"$todbench" sweep run serial/s.toml --quiet
"$todbench" sweep run local/s.toml --quiet --jobs 4 --chunk 1

# The job of tasks 4 and 5 kills parallel and, when it has taken its lock, its own process; the second time it does as the others.
cat >program <<PROGRAM
#!/bin/sh
case "\$*" in
  *4-5*)
    if mkdir "$work/killed" 2>/dev/null; then
      "$todbench" "\$@" &
      while kill -0 \$! 2>/dev/null && ! ls parallel/s.results/*/*.lock >/dev/null 2>&1; do :; done
      kill -KILL \$!
      wait \$! || true
      kill -KILL "\$PARALLEL_PID"
      exit 1
    fi
    ;;
esac
echo "\$*" >>"$work/started"
exec "$todbench" "\$@"
PROGRAM
chmod +x program
list() { "$todbench" sweep tasks parallel/s.toml --for parallel --chunk 2 --program ./program --quiet; }
list >jobs
[ "$(wc -l <jobs)" -eq 6 ] || fail "expected 6 jobs"
parallel --will-cite --joblog log --jobs 1 <jobs && fail "parallel was to be killed"
[ -d killed ] || fail "the third job was not reached"
[ "$(wc -l <started)" -eq 2 ] || fail "expected two jobs before the kill"
parallel --will-cite --joblog log --resume --jobs 2 <jobs || fail "parallel says $?"
[ "$(wc -l <started)" -eq 6 ] || fail "jobs that were done were started again"

for way in serial local parallel; do "$todbench" sweep collect "$way/s.toml" --quiet; done
cmp serial/s.results/table.csv local/s.results/table.csv || fail "four jobs differ from one process"
cmp serial/s.results/table.csv parallel/s.results/table.csv || fail "parallel differs from one process"
echo "PASSED: $(tail -n +2 serial/s.results/table.csv | wc -l) rows, one table"
