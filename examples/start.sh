#!/bin/sh
# SPDX-License-Identifier: MIT
# sh examples/start.sh   from a bare Debian 12 to a scan lens traced, its picture
# written and one difficult ray explained.  Can be run again at any time.
set -eu
cd "$(dirname "$0")/.."
build=build/start
results=build/results

sh .ci/install gcc g++ libc6-dev meson pkg-config libyaml-dev libcairo2-dev \
    libgeographiclib-dev proj-data # the surfaces about the Earth, and their geoid

# For a first picture soon: the command alone, for this processor, with half of the optimiser (-O1).  It gives the
# same bits.  A build to be installed or measured has none of these three (README.md).
options='-Dyaml=enabled -Dcairo=enabled -Dgeographiclib=enabled -Dexamples=false -Dtests=false -Dmpi=disabled
    -Dclones=none -Doptimization=1'
if ${CC:-cc} -march=native -E -x c /dev/null >/dev/null 2>&1; then
    options="$options -Dc_args=-march=native"
fi
# An old build may know of no GeographicLib, as it was installed just now.
if [ -f $build/build.ninja ]; then
    meson configure $build --clearcache
    # shellcheck disable=SC2086
    meson setup --reconfigure $build $options
else
    # shellcheck disable=SC2086
    meson setup $build --libdir=lib $options
fi
ninja -C $build src/tool/sagitta
sagitta=$build/src/tool/sagitta

mkdir -p $results
lens=examples/lenses/ftheta.yaml
fans='--field 0 --field 10 --field 20 --fan 9'
# shellcheck disable=SC2086
$sagitta trace $lens $fans --picture $results/ftheta.svg --output $results/ftheta.txt
# shellcheck disable=SC2086
$sagitta trace $lens $fans --format csv --output $results/ftheta.csv

# A steep ray, as the library takes it; and as Newton's method fares with it when
# the gradient has been scaled to unit length (which settles nothing: exit status 1).
steep='0 0.5 -5 0 0.3420201433256687 0.9396926207859084'
{
    $sagitta diagnose --surface '{type: sphere, radius: -2.2136}' --ray "$steep"
    echo
    $sagitta diagnose --surface '{type: sphere, radius: -2.2136}' --ray "$steep" \
        --method newton-normalised --max-evals 8 || [ $? -eq 1 ]
} > $results/ray.txt

echo
echo "A scan lens and 27 rays; the last of them, surface by surface:"
echo
{ head -n 1 $results/ftheta.txt; tail -n 10 $results/ftheta.txt; }
echo
echo "A steep ray explained; then the same ray with the classic mistake:"
echo
cat $results/ray.txt
echo
echo "Written to $results:"
echo "  ftheta.svg   the picture"
echo "  ftheta.txt   every ray at every surface; ftheta.csv the same, to the last bit"
echo "  ray.txt      the steep ray"
echo "The command is $sagitta; --help says what else it does."
