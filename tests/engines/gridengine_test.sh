#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Debian's Grid Engine, a master and an execution daemon on this host in namespaces of their own, on copies of their folders: an array job, an
# element that is deleted in the middle of a task while the others go on, the same script again; one table, byte for byte, as one process.
# Usage: gridengine_test.sh TODBENCH. Exit 0: passed, 77: Grid Engine cannot run here (said why on stdout), 1: failed.
set -eu
todbench=$1
. "$(dirname "$0")/one_table.sh"
home=/var/lib/gridengine
spool=/var/spool/gridengine
skip() { echo "SKIPPED: $*"; exit 77; }
fail() { echo "FAILED: $*"; tail -n 20 "$work"/log/* "$work"/spool/qmaster/messages 2>/dev/null || true; exit 1; }

if [ -z "${TODBENCH_GRIDENGINE_WORK:-}" ]; then
  for tool in sge_qmaster sge_execd qsub ip unshare; do
    PATH=$PATH:/usr/sbin:/sbin command -v $tool >/dev/null ||
      skip "$tool is not installed (apt-get install gridengine-master gridengine-exec gridengine-client iproute2)"
  done
  [ "$(id -u)" -eq 0 ] || skip "the daemons need root"
  unshare -nmu --ipc --pid --fork --mount-proc true 2>/dev/null || skip "this host allows no namespaces"
  work=$(mktemp -d)
  # With the shell everything in its namespace ends, daemons and jobs, and what it mounted.
  code=0
  TODBENCH_GRIDENGINE_WORK=$work timeout -s KILL 300 unshare -nmu --ipc --pid --fork --mount-proc --kill-child bash "$0" "$@" || code=$?
  rm -rf "$work"
  exit $code
fi
work=$TODBENCH_GRIDENGINE_WORK
export PATH=$PATH:/usr/sbin:/sbin SGE_ROOT=$home SGE_CELL=default
chmod 711 "$work"
mkdir -p "$work"/log "$work"/spool/{spooldb,qmaster,execd}
# Grid Engine looks its own address up and takes none of the loopback network.
address=192.0.2.1
hostname engine
{ ip link set lo up && ip addr add $address/32 dev lo; } || skip "no address can be set"
printf '127.0.0.1 localhost\n%s engine\n' $address >"$work/hosts"
cp -a $home "$work/lib"
mkdir -p "$work/lib/default/common"
cat >"$work/lib/default/common/bootstrap" <<CONF
admin_user sgeadmin
default_domain none
ignore_fqdn false
spooling_method berkeleydb
spooling_lib libspoolb
spooling_params $spool/spooldb
binary_path /usr/sbin
qmaster_spool_dir $spool/qmaster
security_mode none
listener_threads 2
worker_threads 2
scheduler_threads 1
CONF
echo engine >"$work/lib/default/common/act_qmaster"
chown -R sgeadmin "$work/lib" "$work/spool"
{ mount --bind "$work/hosts" /etc/hosts && mount --bind "$work/lib" $home && mount --bind "$work/spool" $spool; } || skip "nothing can be mounted"
as_admin() { su sgeadmin -s /bin/sh -c "SGE_ROOT=$home SGE_CELL=default PATH=$PATH $*"; }
as_admin "/usr/share/gridengine/scripts/init_cluster $home default $spool/spooldb sgeadmin" >"$work/log/init" 2>&1 || fail "no cluster was set up"
as_admin sge_qmaster >"$work/log/qmaster" 2>&1 || skip "sge_qmaster does not start"
for _ in $(seq 100); do qconf -sh >/dev/null 2>&1 && break; sleep 0.2; done
qconf -sh >/dev/null 2>&1 || skip "sge_qmaster does not answer"
as_admin "qconf -am root; qconf -ah engine; qconf -as engine" >"$work/log/hosts" 2>&1 || true
sge_execd >"$work/log/execd" 2>&1 || skip "sge_execd does not start"
# Jobs of root are refused by itself.
qconf -sconf | sed 's/^min_\([ug]id\) .*/min_\1 0/' >"$work/global"
as_admin "qconf -Mconf $work/global" >"$work/log/configuration" 2>&1 || fail "root may not submit"
qconf -sq | sed -e 's/^qname .*/qname main.q/' -e 's/^hostlist .*/hostlist engine/' -e 's/^slots .*/slots 2/' -e 's/^pe_list .*/pe_list NONE/' \
  -e 's/^ckpt_list .*/ckpt_list NONE/' -e 's/^load_thresholds .*/load_thresholds NONE/' >"$work/queue"
qconf -Aq "$work/queue" >"$work/log/queue" 2>&1 || fail "no queue was set up"

cd "$work"
# In its folder, as the printed script is used.
submit() { (cd "$1" && "$todbench" sweep tasks s.toml --for gridengine --quiet "${@:2}" >job.sh && qsub -terse -o /dev/null -e /dev/null job.sh) >>log/jobs || fail "$1: nothing was submitted"; }
jobs_left() { qstat; }

serial_table

sweep array
submit array --chunk 2 --program "$todbench"
all_done array
same_table array

# The program of the third element is stopped in the middle of a task, its lock taken; then the element is deleted.
sweep deleted
stopping_program "[ \"\$SGE_TASK_ID\" = 3 ] && [ ! -e '$work/stopped' ]" "$work/deleted/s.results"
submit deleted --chunk 2 --program "$work/stopped-program"
for _ in $(seq 600); do [ -e stopped ] && break; sleep 0.1; done
[ -e stopped ] || fail "no task was stopped in the third element"
qdel "$(tail -n 1 log/jobs | cut -d. -f1)" -t 3 >/dev/null
all_done deleted
"$todbench" sweep collect deleted/s.toml --quiet >/dev/null 2>&1 && fail "a table was made though a task has no result"
submit deleted --chunk 2 --program "$work/stopped-program"
all_done deleted
same_table deleted
echo "PASSED: an array, an element that was deleted and submitted again: one table"
