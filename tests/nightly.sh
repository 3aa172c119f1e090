#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# bash tests/nightly.sh [STAGE...]   what takes too long for every change, or these of its stages; some ten hours
# on an idle machine of two cores.
#
#   scale      all random tests, oracles and proofs with twenty times the cases (SAGITTA_TEST_SCALE=10, 0.5 by day, or
#              NIGHT_SCALE; SAGITTA_TEST_SEED chooses other cases: the day of the year, unless it is set)
#   rest       what a plain `meson test` leaves out: the suite `nightly` (random lenses against mpmath, the ways of a
#              search, the costs of a render, the library as a subproject and found by CMake, the wheel, Python under
#              valgrind, sagitta-mpi, twenty times a rank killed, interval.h by each compiler, flags of fast arithmetic, breaks of the saved interface that are
#              planted, a later version of it)
#   tapes      random formulas against Arb, their operations and rays to them, each for NIGHT_TAPE_SECONDS (600)
#   cliffs     the search for ordinary input that costs many times the usual (bench/cliff_search.cpp), for
#              NIGHT_CLIFF_SECONDS (7200); its log has the worst fifty, each a line for `bench_ordinary --case`
#   platforms  the library on other systems (platforms/run.py): all sums, the speed, and the oracles by wine and qemu at
#              a tenth of their scale
#   examples   under AddressSanitizer and UBSan
#   fuzz       each target for NIGHT_FUZZ_SECONDS (2400), from corpora that grow in build/fuzz/corpus from night to
#              night
#   mutants    single edits of the library that the tests must notice (mutants/run.py): a seventh of them, so that
#              seven nights in a row try each
#
# Each stage runs whatever became of those before it, and writes to build/nightly/STAGE.log.  Its time and the processor
# time that it took are told; of a failed one the end of the log is shown.  Ends with status 1 if a stage failed.
# What is needed and is not there is installed.
set -u
cd "$(dirname "$0")/.."
all=(scale rest tapes cliffs platforms examples fuzz mutants)
logs=build/nightly
build=build/tests
failed=
mkdir -p $logs

run() {  # run STAGE COMMAND...
    local name=$1
    shift
    echo "== $name, $(date +%H:%M)"
    local TIMEFORMAT='   %0R s, %0U s of processor' status=0
    time "$@" >"$logs/$name.log" 2>&1 || status=$?
    [ $status -ne 0 ] || return 0
    echo "   FAILED, see $logs/$name.log:"
    tail -25 "$logs/$name.log"
    failed="$failed $name"
}

scale() {
    SAGITTA_TEST_SCALE=${NIGHT_SCALE:-10} meson test -C $build --no-rebuild --timeout-multiplier 0 --print-errorlogs \
        --suite unit --suite batch --suite oracle --suite interval --suite extremes \
        --suite sensitivity --suite geo --suite catalogue --suite lens --suite formula --suite tool
}

rest() {
    meson compile -C $build bench && meson test -C $build --print-errorlogs --suite nightly
}

tapes() {
    local what status=0
    for what in operations roots; do
        $build/tests/formula/test_formula_$what --seconds "${NIGHT_TAPE_SECONDS:-600}" \
            --seed "$SAGITTA_TEST_SEED" --random || status=1
    done
    return $status
}

cliffs() {
    meson compile -C $build bench_ordinary &&
        $build/tests/bench/bench_ordinary --search --seconds "${NIGHT_CLIFF_SECONDS:-7200}" --seed "$SAGITTA_TEST_SEED"
}

platforms() {
    sh .ci/install ninja-build musl-tools gcc-mingw-w64-x86-64-posix g++-mingw-w64-x86-64-posix wine64 qemu-user \
        gcc-aarch64-linux-gnu g++-aarch64-linux-gnu libc6-dev-arm64-cross \
        gcc-s390x-linux-gnu g++-s390x-linux-gnu libc6-dev-s390x-cross &&
        python3 tests/platforms/run.py --oracles
}

examples() {
    rm -rf $logs/sanitized
    meson setup $logs/sanitized -Dbuildtype=debugoptimized -Db_sanitize=address,undefined -Dtests=false &&
        meson compile -C $logs/sanitized && meson test -C $logs/sanitized --suite examples --timeout-multiplier 3
}

fuzz() {
    sh tests/fuzz/run.sh "${NIGHT_FUZZ_SECONDS:-2400}"
}

mutants() {
    python3 tests/mutants/run.py --share $((10#$(date +%j) % 7))/7
}

for one in "$@"; do
    case " ${all[*]} " in
        *" $one "*) ;;
        *) echo "tests/nightly.sh: $one is no stage: ${all[*]}" >&2; exit 2 ;;
    esac
done

# What the README's test command builds, without its tests.
sh tests/run.sh --list >/dev/null || exit 1
sh .ci/install clang || exit 1
SAGITTA_TEST_SEED=${SAGITTA_TEST_SEED:-$((10#$(date +%j)))}
export SAGITTA_TEST_SEED
for one in "${@:-${all[@]}}"; do
    run "$one" "$one"
done

echo "== seed $SAGITTA_TEST_SEED, failed:${failed:- none}"
[ -z "$failed" ]
