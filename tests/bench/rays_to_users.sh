#!/bin/sh
# SPDX-License-Identifier: MIT
# sh tests/bench/rays_to_users.sh BUILD [BEFORE]
#
# What rays cost by the time their user has them, in one run: a surface of a lens, an analysis, a file, an array of
# Python.  Each table has its limits beside it.  BEFORE: an earlier build, whose analyses and files run in turn with
# those of this one, and whose lenses behind those of this one.  The machine should be idle: the load stands first.
set -eu
build=$(cd "$1" && pwd)
before=${2:+$(cd "$2" && pwd)}
here=$(cd "$(dirname "$0")" && pwd)
uptime
ninja -C "$build" tests/bench/bench_batch tests/bench/bench_questions >/dev/null
for each in "$build" ${before:+"$before"}; do
    if [ -x "$each/tests/bench/bench_batch" ]; then
        echo "$each"
        "$each/tests/bench/bench_batch" --benchmark_filter='lens.*-1e3|singlet-1e3'
    fi
done
python3 "$here/rays_and_questions.py" "$build" ${before:+--before "$before"}
python3 "$here/files.py" "$build" ${before:+--before "$before/src/tool/sagitta"}
SAGITTA_PYTHON_LIBRARY=$build/python/libsagitta_python.so python3 "$here/python_costs.py"
