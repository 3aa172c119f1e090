#!/bin/sh
# SPDX-License-Identifier: MIT
# sh tests/run.sh   from a bare Debian 12 to everything built and every test run.
# Can be run again at any time; words after it go to `meson test`: with --list, everything is built and no test is run.
# Nothing is left out in silence: with all features enabled a missing one ends the set-up, and a test that skips
# itself or a part of itself is a failure here.
set -eu
cd "$(dirname "$0")/.."
build=build/tests
# The python3 that Debian's packages are installed for.  Another one may come first in PATH and lack numpy.
PATH=/usr/bin:$PATH
export PATH

sh .ci/install gcc g++ libc6-dev meson pkg-config python3 \
    libyaml-dev libcairo2-dev libcmocka-dev \
    libceres-dev libeigen3-dev libgoogle-glog-dev libmpfr-dev libflint-arb-dev \
    libgeographiclib-dev proj-data \
    libopenmpi-dev openmpi-bin \
    git mypy universal-ctags python3-dask python3-distributed python3-matplotlib python3-mesonpy python3-pandas python3-pip \
    python3-pytest python3-scipy python3-venv python3-xarray \
    libbenchmark-dev libboost-dev libgsl-dev \
    valgrind llvm python3-gmpy2 python3-mpmath python3-numpy python3-yaml \
    cmake make abigail-tools gfortran rustc octave-dev poppler-utils \
    lowdown mandoc

if [ -f $build/build.ninja ]; then
    # What was not found before may have been installed since.
    meson configure $build --clearcache -Dauto_features=enabled
    meson setup --reconfigure $build
else
    # lib: where CMake, too, looks on every machine
    meson setup $build --libdir=lib -Dauto_features=enabled
fi
meson compile -C $build
count=$(meson test -C $build --list 2>/dev/null | grep -c ' / ')
echo "$count tests"
meson test -C $build --print-errorlogs "$@"
[ "${1:-}" != --list ] || exit 0
ran=$(wc -l < $build/meson-logs/testlog.json)
if [ $# -eq 0 ] && [ "$ran" -ne "$count" ]; then
    echo "$ran of $count tests ran: see $build/meson-logs/testlog.txt" >&2
    exit 1
fi
# A test that skips itself, or a part of itself, says so by a line that begins with one of these words.
skipped=$(grep -cE '^(skipped: |SKIPPED )|"result": "SKIP"' $build/meson-logs/testlog.txt \
    $build/meson-logs/testlog.json | awk -F: '{n += $NF} END {print n}')
if [ "$skipped" -ne 0 ]; then
    echo "skipped, and here nothing may be: see $build/meson-logs/testlog.txt" >&2
    grep -hE '^(skipped: |SKIPPED )' $build/meson-logs/testlog.txt >&2 || :
    exit 1
fi
