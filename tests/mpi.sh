#!/bin/sh
# mpi.sh STAGE: ensemble_mpi.c, as tests/examples.sh has installed and built it in STAGE/a.out: the end has the same bits
# with 1 and with 2 processes, and after a kill in the middle of the run, however often.
set -eu
cd "$1"
last=4000
ends() {
    rm -f orbits.*
    mpirun --oversubscribe -n "$1" ./a.out $last
    mv orbits.end "end.$1"
}
ends 1
ends 2
cmp end.1 end.2

# a lock of Open MPI's that a run left as it was killed, which holds no other up
locked=/dev/shm/sem.OMPIO_orbits.end
rm -f orbits.*
trap 'rm -f $locked' EXIT
[ ! -d /dev/shm ] || head -c 32 /dev/zero >$locked
status=0
timeout 60 mpirun --oversubscribe -n 2 ./a.out $last >locked.out || status=$?
rm -f $locked
[ $status = 0 ] || { echo "a lock that was left behind holds up a run"; exit 1; }
cmp end.1 orbits.end

sum_of() { [ ! -e orbits.state ] || cksum <orbits.state; }
rm -f orbits.*
kills=0
while [ $kills -lt 2 ]; do
    mpirun --oversubscribe -n 2 ./a.out $last >killed.out 2>&1 &
    run=$!
    before=$(sum_of)
    waited=0
    while [ "$(sum_of)" = "$before" ] && [ $waited -lt 200 ]; do
        sleep 0.05
        waited=$((waited + 1))
    done
    pkill -KILL -P $run || true
    kill -KILL $run 2>/dev/null || true
    wait $run 2>/dev/null && break # it had ended before
    kills=$((kills + 1))
done
[ $kills -gt 0 ] || { echo "no run was killed"; exit 1; }
mpirun --oversubscribe -n 2 ./a.out $last >after.out
cat after.out
! grep -q '^from step 0 ' after.out
cmp end.1 orbits.end
