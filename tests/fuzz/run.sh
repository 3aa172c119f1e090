#!/bin/sh
# SPDX-License-Identifier: MIT
# sh tests/fuzz/run.sh [SECONDS] [TARGET...]   fuzzes each target for SECONDS (40) with libFuzzer, one after the other: those
# of fuzz_*.c, unless some are named.
#
# Builds by clang, under its sanitizers, into build/fuzz.  Starts from corpus/ and past/ of this folder; what is new goes
# to build/fuzz/corpus, a finding to build/fuzz/found, and stops its target: the run ends with status 1 and says
# how to see it again.  A finding that is mended is kept in past/TARGET, under a name that tells what it was, where
# the test feeds it to the target with any compiler.
#
#   sh tests/fuzz/run.sh keep [TARGET...]   makes corpus/ anew, as small as it can be with the same coverage, from
#                                           itself and build/fuzz/corpus.
set -eu
cd "$(dirname "$0")/../.."
here=tests/fuzz
build=build/fuzz
seconds=${1:-40}
[ $# -gt 0 ] && shift
targets=${*:-$(cd $here && ls fuzz_*.c | sed 's/fuzz_\(.*\)\.c/\1/')}
# shellcheck disable=SC2086
set -- $targets

sh .ci/install clang libclang-rt-dev meson pkg-config libyaml-dev
if [ ! -f $build/build.ninja ]; then
    CC=clang CXX=clang++ meson setup $build -Dbuildtype=debugoptimized -Db_sanitize=address,undefined -Db_lundef=false \
        "-Dc_args=-fsanitize=fuzzer-no-link -fsanitize=float-cast-overflow -fno-sanitize-recover=all -Wno-pass-failed" \
        -Dexamples=false -Dbenchmark=disabled
fi
for target; do
    meson compile -C $build "fuzz_$target:executable"
    mkdir -p "$build/corpus/$target" $build/found
done

if [ "$seconds" = keep ]; then
    for target; do
        # Long inputs are left out: what they reach shorter ones do.
        find "$build/corpus/$target" -type f -size +1 -delete
        rm -rf $build/small && mkdir $build/small
        "$build/$here/fuzz_$target" -set_cover_merge=1 -use_counters=0 $build/small "$here/corpus/$target" "$build/corpus/$target" >$build/merge.log 2>&1
        rm -f "$here/corpus/$target"/* && cp $build/small/* "$here/corpus/$target"
        echo "$target: $(find "$here/corpus/$target" -type f | wc -l) inputs"
    done
    exit 0
fi

fault=0
for target; do
    dictionary=
    [ -f "$here/$target.dict" ] && dictionary=-dict=$here/$target.dict
    folders="$build/corpus/$target $here/corpus/$target"
    [ -d "$here/past/$target" ] && folders="$folders $here/past/$target"
    echo "== $target, $seconds s"
    # shellcheck disable=SC2086
    if "$build/$here/fuzz_$target" $folders $dictionary -max_total_time="$seconds" -max_len=1000 -timeout=10 \
        -print_final_stats=1 -artifact_prefix="$build/found/$target-" >"$build/$target.log" 2>&1; then
        grep -E 'DONE|number_of_executed' "$build/$target.log"
    else
        fault=1
        grep -a -B 8 -A 2 -E 'not so:|ERROR:|runtime error:' "$build/$target.log" | head -40
        echo "Again: $build/$here/fuzz_$target $build/found/$target-..., the newest; all that was said is in $build/$target.log"
    fi
done
exit $fault
