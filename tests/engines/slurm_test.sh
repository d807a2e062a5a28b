#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Debian's Slurm, one controller and two nodes on this host in namespaces of their own: an array job, an array that is too long, an element
# whose node is killed, one that is requeued; the same table, byte for byte, as one process.
# Usage: slurm_test.sh TODBENCH. Exit 0: passed, 77: Slurm cannot run here (said why on stdout), 1: failed.
set -eu
todbench=$1
. "$(dirname "$0")/one_table.sh"
skip() { echo "SKIPPED: $*"; exit 77; }
fail() { echo "FAILED: $*"; tail -n 20 "$work"/log/* 2>/dev/null || true; exit 1; }

if [ -z "${TODBENCH_SLURM_WORK:-}" ]; then
  for tool in slurmctld slurmd sbatch munged ip unshare; do
    PATH=$PATH:/usr/sbin:/sbin command -v $tool >/dev/null || skip "$tool is not installed (apt-get install slurm-wlm munge iproute2)"
  done
  [ "$(id -u)" -eq 0 ] || skip "the daemons need root"
  unshare -nmu --ipc --pid --fork --mount-proc true 2>/dev/null || skip "this host allows no namespaces"
  work=$(mktemp -d)
  # With the shell everything in its namespace ends, daemons and jobs.
  code=0
  TODBENCH_SLURM_WORK=$work timeout -s KILL 300 unshare -nmu --ipc --pid --fork --mount-proc --kill-child bash "$0" "$@" || code=$?
  rm -rf "$work"
  exit $code
fi
work=$TODBENCH_SLURM_WORK
export PATH=$PATH:/usr/sbin:/sbin
mkdir -p "$work"/{state,spool/n1,spool/n2,log,munge}
chmod 711 "$work" "$work/munge"
# Slurm looks addresses up, which takes one that is not of the loopback network.
address=192.0.2.1
{ ip link set lo up && ip addr add $address/32 dev lo; } || skip "no address can be set"

head -c 1024 /dev/urandom >"$work/munge/key"
chmod 400 "$work/munge/key"
munged --force --socket="$work/munge/socket" --key-file="$work/munge/key" --pid-file="$work/munge/pid" --log-file="$work/munge/log" \
  --seed-file="$work/munge/seed" || skip "munged does not start"
export SLURM_CONF=$work/slurm.conf
cat >"$SLURM_CONF" <<CONF
ClusterName=todbench
SlurmctldHost=$(hostname)($address)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$work/munge/socket
CryptoType=crypto/munge
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool/%n
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/%n.pid
SlurmctldLogFile=$work/log/slurmctld
SlurmdLogFile=$work/log/%n
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/none
MpiDefault=none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=1,bf_interval=1
ReturnToService=2
SlurmdTimeout=3
KillWait=2
MaxArraySize=5
NodeName=n1 NodeAddr=$address Port=17001 CPUs=2
NodeName=n2 NodeAddr=$address Port=17002 CPUs=2
PartitionName=all Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
CONF
slurmctld -c || skip "slurmctld does not start"
# A node: a host name and processes of its own, which end together.
node() {
  unshare -u --pid --fork --mount-proc --kill-child sh -c "hostname $1; exec slurmd -D -f '$SLURM_CONF'" >"$work/log/$1.out" 2>&1 &
  echo $! >"$work/$1.outside"
}
node n1
node n2
for _ in $(seq 100); do
  [ "$(sinfo -h -o '%T %D' 2>/dev/null)" = "idle 2" ] && break
  sleep 0.2
done
[ "$(sinfo -h -o '%T %D')" = "idle 2" ] || skip "the nodes do not come up: $(tail -n 1 "$work"/log/n1)"

cd "$work"
jobs_left() { squeue -h -r; }
echo "--output=/dev/null" >site
submit() { "$todbench" sweep submit "$1/s.toml" --engine slurm --options site --quiet "${@:2}"; }

serial_table

sweep array
submit array 2>refusal && fail "an array of 8 elements was taken where 5 is the limit"
grep -qi "array" refusal || fail "nobody said why the array was refused"
submit array --chunk 2
all_done array
same_table array

# On the second node a program is stopped in the middle of a task, its lock taken; then the node is lost.
sweep lost-node
stopping_program '[ "$(hostname)" = n2 ] && [ -z "${SLURM_RESTART_COUNT:-}" ]' "$work/lost-node/s.results"
submit lost-node --chunk 2 --program "$work/stopped-program"
for _ in $(seq 300); do [ -e stopped ] && break; sleep 0.1; done
[ -e stopped ] || fail "no task was stopped on the second node"
kill -KILL "$(cat n2.outside)"
node_is_down() { sinfo -h -n n2 -o '%T' | grep -q down; }
for _ in $(seq 300); do node_is_down && break; sleep 0.2; done
node_is_down || scontrol update nodename=n2 state=down reason=killed
# Slurm waits two minutes before it starts such a job again.
for job in $(squeue -h -r -t PD -o %i); do scontrol update jobid="$job" starttime=now || true; done
all_done lost-node
same_table lost-node
grep -q "requeue" log/slurmctld || fail "no element was requeued"

node n2
sweep requeued
cat >slow-program <<PROGRAM
#!/bin/bash
[ -n "\${SLURM_RESTART_COUNT:-}" ] || { touch "$work/slow.\$SLURM_ARRAY_TASK_ID"; sleep 3600; }
exec "$todbench" "\$@"
PROGRAM
chmod +x slow-program
submit requeued --chunk 4 --program "$work/slow-program"
for _ in $(seq 300); do [ -e slow.0 ] && [ -e slow.1 ] && break; sleep 0.1; done
for job in $(squeue -h -r -o %i); do scontrol requeue "$job" || true; done
for _ in $(seq 300); do [ -z "$(squeue -h -r -t R,CG -o %i)" ] && break; sleep 0.1; done
# A node takes no job whose credential is not younger than the end of its first run, in whole seconds.
for job in $(squeue -h -r -o %i); do scontrol update jobid="$job" starttime=now+2 || true; done
all_done requeued
same_table requeued
echo "PASSED: an array, an array that is too long, a lost node, a requeue: one table"
