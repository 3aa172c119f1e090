#!/bin/sh
# sh docs/accuracy_t_tol.sh SAGITTA    the table of t_tol in accuracy.md: a thousand rays and
# one asphere, by `sagitta intersect --t-tol`.  The rays lie on two sunflower spirals, so that
# they are the same everywhere: origins in the disk of radius 2.5 at z = -5, slopes up to 0.15.
set -eu
sagitta=$1
there=$(mktemp -d)
trap 'rm -r "$there"' EXIT
surface='{type: even_asphere, curvature: 0.1, conic: -0.6, coefficients: [0, 1e-4, -2e-6, 1e-8], semi_diameter: 4}'
awk 'BEGIN {
    print "ox,oy,oz,dx,dy,dz"
    for (i = 0; i < 1000; i++) {
        r = 2.5 * sqrt((i + 0.5) / 1000); a = 2.399963229728653 * i
        s = 0.15 * sqrt((i * 377 % 1000 + 0.5) / 1000); b = 1.7 * i
        printf "%.17g,%.17g,-5,%.17g,%.17g,%.17g\n", r * cos(a), r * sin(a), s * cos(b), s * sin(b), sqrt(1 - s * s)
    }
}' > "$there/rays.csv"

echo "t_tol,hits,mean evals,max evals,median t_err,max t_err,max change of t"
for x in 0 1e-15 1e-12 1e-9 1e-6 1e-3; do
    "$sagitta" intersect --surface "$surface" --rays "$there/rays.csv" --t-tol $x --format csv --output "$there/$x.csv"
    tail -n +2 "$there/$x.csv" | cut -d, -f5 | sort -g > "$there/errors"
    paste -d, "$there/0.csv" "$there/$x.csv" | awk -F, -v x=$x -v median="$(sed -n 500p "$there/errors")" 'NR > 1 {
        n++; hits += $15 == "hit"; evals += $24; if ($24 > most) most = $24
        if ($17 > worst) worst = $17
        d = $16 - $4; if (d < 0) d = -d; if (d > moved) moved = d
    } END { printf "%s,%d,%.2f,%d,%.2g,%.2g,%.2g\n", x, hits, evals / n, most, median, worst, moved }'
done
