# SPDX-License-Identifier: GPL-3.0-or-later
# What the tests of schedulers have in common, to be sourced: a small sweep, the table that one process makes of it, and that another way made
# the same. Of whoever sources it: $todbench, the program; fail SENTENCE, which ends the test; and, for all_done, jobs_left, which prints what
# the scheduler still has.

# sweep FOLDER: eight tasks in it.
sweep() {
  mkdir "$1"
  cat >"$1/s.toml" <<'SWEEP'
kind = "estimate"
[base]
accuracy = "draft"
delta_t_k = [16.9, 1.93]
[grid]
netd_k = [0.05, 0.2]
detector_um = [30, 42.5]
[repeat]
seeds = 2
SWEEP
}

serial_table() {
  sweep serial
  "$todbench" sweep run serial/s.toml --quiet >/dev/null
  "$todbench" sweep collect serial/s.toml --quiet >/dev/null
}

# all_done FOLDER
all_done() {
  for _ in $(seq 600); do
    [ -z "$(jobs_left)" ] && return 0
    sleep 0.2
  done
  jobs_left
  fail "$1: jobs are left"
}

# same_table FOLDER: what is in it against the table of one process.
same_table() {
  "$todbench" sweep collect "$1/s.toml" --quiet >/dev/null || { "$todbench" sweep status "$1/s.toml"; fail "$1: not all tasks have a result"; }
  cmp serial/s.results/table.csv "$1/s.results/table.csv" || fail "$1: another table than that of one process"
  echo "passed: $1"
}

# stopping_program CONDITION RESULTS: makes stopped-program, todbench that is stopped in the middle of a task, its lock taken, where the shell's
# CONDITION holds; then the file "stopped" is there.
stopping_program() {
  cat >stopped-program <<PROGRAM
#!/bin/bash
if $1; then
  "$todbench" "\$@" &
  while kill -0 \$! 2>/dev/null; do
    for lock in $2/*/*.lock; do
      if [ -f "\$lock" ] && [ "\$(sed -n 2p "\$lock")" = \$! ] && [ "\$(sed -n 1p "\$lock")" = "\$(hostname)" ]; then
        kill -STOP \$!
        # Too late where its task has come to its end meanwhile.
        if [ -f "\$lock" ]; then touch "$work/stopped"; sleep 3600; fi
        kill -CONT \$!
      fi
    done
  done
  wait
  exit
fi
exec "$todbench" "\$@"
PROGRAM
  chmod +x stopped-program
}
