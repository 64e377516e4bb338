#!/usr/bin/env bash
# batch_check.sh [--slurm]: checks scripts/encode.sbatch with a srun that only runs the tasks one after the other, and a
# ghostspace-mpi that lets its first task encode. With --slurm, as root, also with Slurm from Debian on this machine
# (slurmctld, slurmd, munge; ends them again). Exits with 0 if all checks pass.
#
# GHOSTSPACE: program instead of build/release/ghostspace. GHOSTSPACE_MPI: the real program for jobs of Slurm, which run it
# by srun with PMIx and by mpirun.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
ghostspace=${GHOSTSPACE:-$root/build/release/ghostspace}
script=$root/scripts/encode.sbatch
work=$(mktemp -d /tmp/ghostspace-batch.XXXXXX)
started=()
leave() {
  for ((i = ${#started[@]} - 1; i >= 0; --i)); do kill "${started[i]}" 2>/dev/null || true; done
  wait 2>/dev/null || true
  rm -rf "$work"
}
trap leave EXIT
source "$root/scripts/checks/verify.sh"

mkdir -p "$work/bin" "$work/data"
cat >"$work/bin/srun" <<'SH'
#!/bin/sh
for rank in $(seq 0 $((SLURM_NTASKS - 1))); do SLURM_PROCID=$rank "$@" || exit; done
SH
cat >"$work/bin/ghostspace-mpi" <<SH
#!/bin/bash
echo "\${SLURM_PROCID:-0} \$*" >>"$work/calls"
[ "\${SLURM_PROCID:-0}" = 0 ] || exit 0
arguments=()
for one in "\$@"; do [ "\$one" = --resume ] || arguments+=("\$one"); done
exec "$ghostspace" "\${arguments[@]}"
SH
chmod +x "$work"/bin/*
mpi_of_jobs=${GHOSTSPACE_MPI:-}
unset GHOSTSPACE_MPI GHOSTSPACE_LAUNCHER
export PATH=$work/bin:$PATH GHOSTSPACE=$ghostspace
for number in 0 1 2; do
  {
    printf 'NRRD0004\ntype: uint8\ndimension: 3\nsizes: 16 16 16\nencoding: raw\n\n'
    head -c 4096 /dev/zero | tr '\0' "\\$((number + 1))"
  } >"$work/data/step $number.nrrd"
done
cd "$work/data"
status() { "$@" >"$work/out" 2>&1 && echo 0 || echo $?; }
says() { tr '\n' ' ' <"$work/out"; }

verify "one task runs ghostspace" 0 "$(status env SLURM_NTASKS=1 bash "$script" "step 0.nrrd" one.qnv --lossless)"
verify "and writes the stream" yes "$([ -s one.qnv ] && echo yes)"
verify "four tasks run" 0 "$(status env SLURM_NTASKS=4 SLURM_MEM_PER_CPU=1000 SLURM_CPUS_PER_TASK=2 bash "$script" "step 0.nrrd" four.qnv --lossless)"
verify "with the memory of a task" "0 encode --memory 1600M --lossless step 0.nrrd four.qnv" "$(head -1 "$work/calls")"
verify "each of them" 4 "$(wc -l <"$work/calls")"
verify "with the same bytes" "$(sha256sum <one.qnv)" "$(sha256sum <four.qnv)"
verify "the user's --memory stays" 0 "$(status env SLURM_NTASKS=2 SLURM_MEM_PER_CPU=1000 bash "$script" "step 0.nrrd" two.qnv --memory 1G)"
verify "alone" "1 encode --memory 1G step 0.nrrd two.qnv" "$(tail -1 "$work/calls")"
verify "a program of several words" 0 "$(status env SLURM_NTASKS=1 GHOSTSPACE="nice $ghostspace" bash "$script" "step 0.nrrd" words.qnv)"
verify "a requeued job" 0 "$(status env SLURM_NTASKS=2 SLURM_RESTART_COUNT=1 bash "$script" "step 0.nrrd" again.qnv)"
verify "resumes" "1 encode --resume step 0.nrrd again.qnv" "$(tail -1 "$work/calls")"

printf '%s\n' "step 0.nrrd" "step 1.nrrd" "step 2.nrrd" >list
task() { status env SLURM_NTASKS=2 SLURM_ARRAY_TASK_ID="$1" bash "$script" list out; }
verify "task 2 of an array" 0 "$(task 2)"
verify "task 1 of an array" 0 "$(task 1)"
verify "their steps are listed in order" "step 0.nrrd.qnv step 1.nrrd.qnv " \
  "$(sed -n 's/.*"name": "\([^"]*\)".*/\1/p' out/run.qnv.series | tr '\n' ' ')"
verify "and can be drawn" 0 "$(status "$ghostspace" --snapshot "$work/p.png" --size 64x64 --time 1 out/run.qnv.series)"
calls=$(wc -l <"$work/calls")
verify "a finished task" 0 "$(task 2)"
verify "does nothing" "$calls" "$(wc -l <"$work/calls")"
verify "no other file is left" "run.qnv.series step 0.nrrd.qnv step 1.nrrd.qnv " "$(find out -type f ! -name ".run.lock" -printf "%f\n" | sort | tr "\n" " ")"
verify "a line that is missing" 2 "$(task 4)"
verify "is named" "encode.sbatch: list has no line 4; expected --array=1-3 " "$(says)"
verify "a file that is missing" 2 "$(status bash "$script" none.nrrd none.qnv)"
verify "is named, too" "encode.sbatch: none.nrrd: no such file " "$(says)"
verify "no file at all" 2 "$(status bash "$script")"
printf 'no volume' >bad.nrrd
verify "a file that cannot be encoded ends the job" 1 "$(status env SLURM_NTASKS=2 bash "$script" bad.nrrd bad.qnv)"
verify "and leaves no stream" "" "$(ls bad.qnv 2>/dev/null)"

slurm() {
  local tool host
  for tool in slurmctld slurmd munged sbatch; do
    command -v $tool >/dev/null || { echo "skipped: $tool is missing (Debian: slurmctld slurmd slurm-client munge)"; return; }
  done
  [ "$(id -u)" -eq 0 ] || { echo "skipped: Slurm needs root here"; return; }
  host=$(hostname -s)
  mkdir -p "$work/slurm/state" "$work/slurm/spool" "$work/munge"
  head -c 1024 /dev/urandom >"$work/munge/key"
  chmod 700 "$work/munge" && chmod 600 "$work/munge/key"
  chmod 755 "$work" "$work/slurm"
  munged --foreground --force --key-file="$work/munge/key" --socket="$work/munge.socket" --pid-file="$work/munge/pid" \
    --log-file="$work/munge/log" --seed-file="$work/munge/seed" >/dev/null 2>&1 &
  started+=($!)
  cat >"$work/slurm/slurm.conf" <<CONF
ClusterName=check
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$work/munge.socket
CredType=cred/munge
SlurmctldPort=16817
SlurmdPort=16818
StateSaveLocation=$work/slurm/state
SlurmdSpoolDir=$work/slurm/spool
SlurmctldPidFile=$work/slurm/slurmctld.pid
SlurmdPidFile=$work/slurm/slurmd.pid
SlurmctldLogFile=$work/slurm/slurmctld.log
SlurmdLogFile=$work/slurm/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
ReturnToService=2
SlurmdParameters=config_overrides
MailProg=/bin/true
NodeName=$host NodeAddr=127.0.0.1 CPUs=4 RealMemory=8000 State=UNKNOWN
PartitionName=check Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
  export SLURM_CONF=$work/slurm/slurm.conf
  slurmctld -D -c >/dev/null 2>&1 &
  started+=($!)
  slurmd -D -N "$host" >/dev/null 2>&1 &
  started+=($!)
  for _ in $(seq 60); do
    sinfo -h -o %t 2>/dev/null | grep -q idle && break
    sleep 0.5
  done
  if ! sinfo -h -o %t 2>/dev/null | grep -q idle; then
    tail -5 "$work"/slurm/*.log
    verify "Slurm starts" idle "$(sinfo -h -o %t 2>&1)"
    return
  fi
  export PATH=${PATH#"$work/bin:"}
  export GHOSTSPACE_MPI=${mpi_of_jobs:-$work/bin/ghostspace-mpi} OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
  local launchers=(srun) launcher
  # The real program needs PMIx, of Slurm or of mpirun.
  if [ -n "$mpi_of_jobs" ]; then launchers=("srun --mpi=pmix" mpirun); fi
  for launcher in "${launchers[@]}"; do
    export GHOSTSPACE_LAUNCHER=$launcher
    rm -rf out slurm.qnv
    verify "Slurm, $launcher: a job of four tasks" 0 "$(status sbatch --wait --mem-per-cpu=500 --output="$work/job.out" "$script" "step 0.nrrd" slurm.qnv --lossless)"
    cat "$work/job.out"
    verify "Slurm, $launcher: with the same bytes" "$(sha256sum <one.qnv)" "$(sha256sum <slurm.qnv)"
    rm "$work/job.out"
    verify "Slurm, $launcher: an array" 0 "$(status sbatch --wait --array=1-3 --ntasks=2 --mem-per-cpu=500 --output="$work/job.out" "$script" list out)"
    cat "$work/job.out"
    verify "Slurm, $launcher: all steps are listed" 3 "$(grep -c '"name"' out/run.qnv.series)"
  done
}
if [ "${1:-}" = --slurm ]; then slurm; fi
[ $failures -eq 0 ]
