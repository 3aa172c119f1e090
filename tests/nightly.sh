#!/bin/sh
# sh tests/nightly.sh [FUZZ_SECONDS [CLIFF_SECONDS]]   what takes too long for every change; some hours on an
# idle machine of two cores.
#
#   scale      all random tests, oracles and proofs with twenty times the cases (SAGITTA_TEST_SCALE=10, 0.5 by day;
#              SAGITTA_TEST_SEED chooses other cases: the day of the year, unless it is set)
#   rest       what a plain `meson test` leaves out: the suite `nightly` (random lenses against mpmath, the ways of a
#              search, the costs of a render, the library as a subproject, the wheel, Python under valgrind, interval.h
#              by each compiler, breaks of the saved interface that are planted)
#   tapes      random formulas against Arb, their operations and rays to them, ten minutes each
#   cliffs     the search for ordinary input that costs many times the usual (bench/cliff_search.cpp), for
#              CLIFF_SECONDS (7200); its log has the worst fifty, each a line for `bench_ordinary --case`
#   platforms  the library on other systems (platforms/run.py): all sums, the speed, and the oracles by wine and qemu at
#              a tenth of their scale
#   examples   under AddressSanitizer and UBSan
#   fuzz       each target for FUZZ_SECONDS (2400), from corpora that grow in build/fuzz/corpus from night to night
#   mutants    single edits of the library that the tests must notice (mutants/run.py)
#
# Each stage runs whatever became of those before it, and writes to build/nightly/STAGE.log; the end of a failed one's
# log is shown.  Ends with status 1 if a stage failed.  Needs what tests/run.sh installs; more it installs itself.
set -u
cd "$(dirname "$0")/.."
fuzz_seconds=${1:-2400}
cliff_seconds=${2:-7200}
logs=build/nightly
build=build/tests
failed=
mkdir -p $logs

stage() {  # stage NAME COMMAND...
    name=$1
    shift
    echo "== $name, $(date +%H:%M)"
    began=$(date +%s)
    if "$@" >"$logs/$name.log" 2>&1; then
        echo "   passed, $(($(date +%s) - began)) s"
    else
        echo "   FAILED, $(($(date +%s) - began)) s, see $logs/$name.log:"
        tail -25 "$logs/$name.log"
        failed="$failed $name"
    fi
}

sanitized_examples() {
    rm -rf $logs/sanitized
    meson setup $logs/sanitized -Dbuildtype=debugoptimized -Db_sanitize=address,undefined -Dtests=false &&
        meson compile -C $logs/sanitized && meson test -C $logs/sanitized --suite examples --timeout-multiplier 3
}

if [ ! -f $build/build.ninja ]; then
    meson setup $build --libdir=lib -Dauto_features=enabled || exit 1
fi
meson compile -C $build || exit 1
sh .ci/install clang || exit 1

SAGITTA_TEST_SEED=${SAGITTA_TEST_SEED:-$(date +%j)}
export SAGITTA_TEST_SEED
SAGITTA_TEST_SCALE=10 stage scale meson test -C $build --no-rebuild --timeout-multiplier 0 --print-errorlogs \
    --suite unit --suite batch --suite oracle --suite interval --suite extremes \
    --suite sensitivity --suite geo --suite catalogue --suite lens --suite formula
stage rest meson test -C $build --print-errorlogs --suite nightly
for what in operations roots; do
    stage tapes_$what $build/tests/formula/test_formula_$what --seconds 600 --seed "$SAGITTA_TEST_SEED" --random
done
meson compile -C $build bench_ordinary || exit 1
stage cliffs $build/tests/bench/bench_ordinary --search --seconds "$cliff_seconds" --seed "$SAGITTA_TEST_SEED"
sh .ci/install ninja-build musl-tools gcc-mingw-w64-x86-64-posix g++-mingw-w64-x86-64-posix wine64 qemu-user \
    gcc-aarch64-linux-gnu g++-aarch64-linux-gnu libc6-dev-arm64-cross \
    gcc-s390x-linux-gnu g++-s390x-linux-gnu libc6-dev-s390x-cross || exit 1
stage platforms python3 tests/platforms/run.py --oracles
stage examples sanitized_examples
stage fuzz sh tests/fuzz/run.sh $((4 * fuzz_seconds))
if [ -f tests/mutants/run.py ]; then
    stage mutants python3 tests/mutants/run.py
fi

echo "== seed $SAGITTA_TEST_SEED, failed:${failed:- none}"
[ -z "$failed" ]
