#!/usr/bin/env bash
# A profile on a real Slurm of one node, started here and stopped in the end:
#   slurm_test.sh GLINT_BENCH [iterations (250) [patience (1)]]     patience: factor of how long is waited
# One worker is killed with -9 in the middle, one task is told that its time is over and goes back into the
# queue; trained files and scores are those of a run without a cluster. With slurmdbd and mariadbd jobs are
# accounted, and `status` asks sacct, else squeue. 77: no Slurm here, or not root.
set -euo pipefail
bench=$(readlink -f "$1") iterations=${2:-250} patience=${3:-1}
for program in slurmctld slurmd munged sbatch; do
  PATH=$PATH:/usr/sbin command -v $program >/dev/null || { echo "no $program: skipped"; exit 77; }
done
PATH=$PATH:/usr/sbin
[ "$(id -u)" -eq 0 ] || { echo "not root: skipped"; exit 77; }

folder=$(mktemp -d /tmp/glint_slurm.XXXXXX)
daemons=()
finish() {
  for id in "${daemons[@]}"; do kill -9 "$id" 2>/dev/null || true; done
  [ -z "${KEEP:-}" ] && rm -rf "$folder" || echo "kept: $folder"
}
trap finish EXIT
# What keeps Slurm from starting here is none of ours.
skip() { echo "skipped: $*"; tail -n 5 "$folder"/*.log; exit 77; }
fail() {
  echo "FAILED: $*" >&2
  tail -n 30 "$folder"/*.log "$folder"/slurm/smoke/slurm/*.log >&2 2>/dev/null || true
  exit 1
}

node=$(hostname -s)
mkdir "$folder/state" "$folder/spool" "$folder/munge"
chmod 755 "$folder"
dd if=/dev/urandom of="$folder/munge/key" bs=1024 count=1 status=none
chmod 400 "$folder/munge/key"
cat >"$folder/slurm.conf" <<CONF
ClusterName=glint
SlurmctldHost=$node(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthInfo=socket=$folder/munge/socket,cred_expire=2
SlurmctldPort=16817
SlurmdPort=16818
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
MaxArraySize=3
NodeName=$node NodeAddr=127.0.0.1 CPUs=2 RealMemory=2000
PartitionName=all Nodes=$node Default=YES State=UP MaxTime=INFINITE
CONF
export SLURM_CONF=$folder/slurm.conf
accounted=
if command -v slurmdbd >/dev/null && command -v mariadbd >/dev/null; then
  accounted=yes
  cat >>"$folder/slurm.conf" <<CONF
AccountingStorageType=accounting_storage/slurmdbd
AccountingStorageHost=localhost
AccountingStoragePort=16819
AccountingStoragePass=$folder/munge/socket
CONF
  cat >"$folder/slurmdbd.conf" <<CONF
DbdHost=localhost
DbdPort=16819
SlurmUser=root
AuthInfo=socket=$folder/munge/socket
StorageType=accounting_storage/mysql
StorageHost=127.0.0.1
StoragePort=16820
StorageUser=root
StorageLoc=slurm
LogFile=$folder/slurmdbd.log
PidFile=$folder/slurmdbd.pid
CONF
  chmod 600 "$folder/slurmdbd.conf"
fi

# A database of its own, and Slurm's door to it; both end with this script.
start_accounting() {
  local mysql=$folder/mysql
  mariadb-install-db --no-defaults --user=root --datadir="$mysql" --auth-root-authentication-method=normal \
    >"$folder/mysql_install.log" 2>&1
  mariadbd --no-defaults --user=root --datadir="$mysql" --bind-address=127.0.0.1 --port=16820 \
    --socket="$folder/mysql.socket" --innodb-buffer-pool-size=64M >"$folder/mysql.log" 2>&1 &
  daemons+=($!)
  for _ in $(seq 200); do mariadb-admin --no-defaults --socket="$folder/mysql.socket" ping >/dev/null 2>&1 && break; sleep 0.1; done
  SLURM_CONF=$folder/slurm.conf slurmdbd
  for _ in $(seq 200); do sacctmgr -i -n list cluster >/dev/null 2>&1 && break; sleep 0.1; done
  daemons+=("$(cat "$folder/slurmdbd.pid")")
  sacctmgr -i add cluster glint >"$folder/sacctmgr.log" 2>&1 || true
}
munged --force --key-file="$folder/munge/key" --socket="$folder/munge/socket" --pid-file="$folder/munge/pid" \
  --log-file="$folder/munged.log" --seed-file="$folder/munge/seed" || skip "munged does not start"
daemons+=("$(cat "$folder/munge/pid")")
[ -z "$accounted" ] || start_accounting || skip "no accounting"
slurmctld -c && slurmd || skip "slurmctld and slurmd do not start"
for _ in $(seq 100); do sinfo -h -o %T 2>/dev/null | grep -q idle && break; sleep 0.1; done
daemons+=("$(cat "$folder/slurmd.pid")" "$(cat "$folder/slurmctld.pid")")
sinfo -h -o %T | grep -q idle || skip "the node is not idle"

common=(--profile smoke --methods "2dgs,envgs,glint,pgsr" --iterations "$iterations" --device cpu --data "$folder/data"
  --checkpoint-seconds 0.5 --quiet)
echo "== without a cluster"
"$bench" all "${common[@]}" --out "$folder/local" >"$folder/local.out"
rm -rf "$folder/data"  # so that there is a job which makes it

echo "== submitted"
"$bench" all "${common[@]}" --out "$folder/slurm" --executor slurm --force --sbatch=--comment=glint 2>&1 | tee "$folder/submitted.txt"
jobs=$folder/slurm/smoke/slurm/jobs.jsonl
cat "$jobs"
[ "$(grep -c '"stage":"cells"' "$jobs")" -eq 2 ] || fail "four cells with MaxArraySize 3 are not two arrays"

worker_of() { pgrep -f -- "all --no-tables --executor inline .*--out $folder/slurm .*--cell room_1/$1/0 " | head -n 1; }
wait_for() {  # METHOD: until it has a checkpoint; its worker
  for _ in $(seq $((600 * patience))); do
    if [ -f "$folder/slurm/smoke/runs/room_1/$1/0/checkpoint/state.safetensors" ] && [ -n "$(worker_of "$1")" ]; then
      worker_of "$1"
      return
    fi
    sleep 0.1
  done
}
echo "== a worker is killed"
killed=$(wait_for envgs)
[ -n "$killed" ] && kill -9 "$killed" || fail "no worker of envgs to kill"
"$bench" status "${common[@]:0:4}" --out "$folder/slurm" --data "$folder/data" | tee "$folder/status.txt"
echo "== a task is told that its time is over"
[ -n "$(wait_for glint)" ] || fail "no worker of glint"
for task in $(squeue -h -r -t RUNNING -o %A); do
  scontrol show job "$task" | grep -q "StdOut=.*cells" && { scancel --batch --signal=USR1 "$task" || true; }
done

# Slurm keeps what was requeued back for two minutes, so that the end of the first try does not meet the second;
# here five seconds will do.
declare -A since
for _ in $(seq $((1800 * patience))); do
  [ -n "$(squeue -h)" ] || break
  for task in $(squeue -h -r -t PENDING -o '%i %r' | awk '$2 == "BeginTime" { print $1 }'); do
    since[$task]=${since[$task]:-$SECONDS}
    [ $((SECONDS - since[$task])) -lt 5 ] || scontrol update JobId="$task" StartTime=now || true
  done
  sleep 0.2
done
[ -z "$(squeue -h)" ] || fail "jobs are left: $(squeue)"
echo "== results"
grep "Requeuing" "$folder/slurmctld.log" || fail "no task went back into the queue"
content() { (cd "$1/smoke/runs" && find . -name '*.ply' -not -name 'mesh*' -exec sha256sum {} + | sort -k 2); }
[ -n "$(content "$folder/local")" ] || fail "the local run left nothing"
diff <(content "$folder/local") <(content "$folder/slurm") || fail "other surfels than without a cluster"
for run in local slurm; do [ -f "$folder/$run/smoke/tables/summary.md" ] && [ -f "$folder/$run/smoke/report/index.html" ] || fail "no tables of $run"; done
"$bench" status "${common[@]:0:8}" --out "$folder/slurm" --data "$folder/data" | tee "$folder/status.txt"
[ "$(grep -c ' done ' "$folder/status.txt")" -eq 4 ] || fail "not all cells are done"
"$bench" compare "$folder/local/smoke" "$folder/slurm/smoke" --tolerance 0 --quiet >"$folder/compare.txt" || { cat "$folder/compare.txt"; fail "other scores than without a cluster"; }
[ -z "$accounted" ] || sacct -X -P -o JobID,JobName,State,ExitCode,Elapsed,NodeList | tee "$folder/sacct.txt"
echo "four cells on Slurm: the same surfels and scores as without"
