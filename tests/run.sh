#!/bin/sh
# sh tests/run.sh   from a bare Debian 12 to everything built and every test run.
# Can be run again at any time; words after it go to `meson test`.
set -eu
cd "$(dirname "$0")/.."
build=build/tests

sh .ci/install gcc g++ libc6-dev meson pkg-config python3 \
    libyaml-dev libcairo2-dev libcmocka-dev \
    libceres-dev libeigen3-dev libgoogle-glog-dev libmpfr-dev libflint-arb-dev \
    libgeographiclib-dev proj-data \
    git mypy python3-matplotlib python3-mesonpy python3-pip python3-pytest python3-scipy python3-venv \
    libbenchmark-dev libboost-dev libgsl-dev \
    valgrind llvm python3-mpmath python3-numpy python3-yaml \
    cmake make abigail-tools gfortran rustc octave-dev

if [ -f $build/build.ninja ]; then
    # What was not found before may have been installed since.
    meson configure $build --clearcache
    meson setup --reconfigure $build
else
    # lib: where CMake, too, looks on every machine
    meson setup $build --libdir=lib
fi
meson compile -C $build
meson test -C $build --print-errorlogs "$@"
