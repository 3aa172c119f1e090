#!/bin/sh
# sh examples/start.sh   from a bare Debian 12 to a scan lens traced, its picture
# written and one difficult ray explained.  Can be run again at any time.
set -eu
cd "$(dirname "$0")/.."
build=build/start
results=build/results

sh .ci/install gcc libc6-dev meson pkg-config libyaml-dev libcairo2-dev

[ -f $build/build.ninja ] || meson setup $build -Dyaml=enabled -Dcairo=enabled -Dexamples=false -Dtests=false
meson compile -C $build
sagitta=$build/src/tool/sagitta

mkdir -p $results
lens=examples/lenses/ftheta.yaml
fans='--field 0 --field 10 --field 20 --fan 9'
# shellcheck disable=SC2086
$sagitta trace $lens $fans --svg $results/ftheta.svg --output $results/ftheta.txt
# shellcheck disable=SC2086
$sagitta trace $lens $fans --format csv --output $results/ftheta.csv
$sagitta diagnose --surface '{type: sphere, radius: -2.2136}' \
    --ray '0 0.5 -5 0 0.3420201433256687 0.9396926207859084' --output $results/ray.txt

echo
echo "A scan lens, 27 rays through it, where they end:"
tail -n 12 $results/ftheta.txt
echo
echo "One ray that misses the vertex of its sphere, step by step:"
cat $results/ray.txt
echo
echo "Written: $results/ftheta.svg (the picture), ftheta.txt and ftheta.csv (every ray at"
echo "every surface), ray.txt.  The command is $sagitta; --help says what it can do."
