// SPDX-License-Identifier: MIT
/* figure.c - derivatives of figures against differences of whole figures: test_figure LENS...
 *
 *   - each figure of each lens, as the study tells it: rms of spots and wavefronts, chief rays, focal length,
 *     distortion;
 *   - its derivative by every number of the file that it takes, against central differences of the figure of
 *     the edited lens, extrapolated (Richardson) from four steps; the steps are chosen by the test, and no
 * ray of the differences goes back;
 *   - one call for all paths has the numbers of one call for each;
 *   - the sum of the squares of residuals is the square of the last value, and the Jacobian gives its
 * gradient;
 *   - what has no derivative is refused with its path;
 *   - with an allocator that fails at each place in turn nothing is lost. */
#include "counted.h"

#include "require.h"

#include <sagitta/figure.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 600, VALUES = 64, PATHS_OF_LENS = 12 };

static const char *const kind_name[] = {"spot", "opd", "chief", "efl", "distortion"};
static size_t compared, sharp, refused;
static double worst[5];

typedef struct reading {
    sgt_figure *of;
    double x;
    sgt_figure_count size;
    double value[VALUES], noise[VALUES];
} reading;

static sgt_study_options options_of(void)
{
    static const sgt_pattern hexapolar = SGT_PATTERN_HEXAPOLAR;
    return (sgt_study_options){.open = true, .pattern = &hexapolar, .rays = 2};
}

/* An rms has a kink where it is 0; its square has none. */
static bool values_at(sgt_figure *f, double x, bool squares, double value[VALUES])
{
    sgt_figure_out out = {.value = value};
    if (!sgt_figure_eval(f, &x, &out, NULL) || out.lost) return false;
    for (size_t v = 0; squares && v < sgt_figure_size(f).values; v++) value[v] *= value[v];
    return true;
}

/* The derivative of each value at x, from four steps; *known: how far its last digits can be trusted. */
static bool difference(sgt_figure *f, double x, bool squares, double h, size_t values, const double noise[],
                       double by[VALUES], double known[VALUES])
{
    double table[4][VALUES], up[VALUES], down[VALUES];
    for (int i = 0; i < 4; i++, h /= 2) {
        if (!values_at(f, x + h, squares, up) || !values_at(f, x - h, squares, down)) return false;
        const double width = (x + h) - (x - h);
        for (size_t v = 0; v < values; v++) table[i][v] = (up[v] - down[v]) / width;
    }
    for (size_t v = 0; v < values; v++) {
        double last = 0;
        for (int order = 1; order < 4; order++) {
            last = table[3][v];
            for (int i = 3; i >= order; i--)
                table[i][v] += (table[i][v] - table[i - 1][v]) / (ldexp(1, 2 * order) - 1);
        }
        by[v] = table[3][v], known[v] = fabs(table[3][v] - last) + 4 * noise[v] / h;
    }
    return true;
}

static void compare(const char *file, sgt_figure_kind kind, const char *path, reading *r, double gradient[],
                    double error[])
{
    double best[VALUES], spread[VALUES], by[VALUES], known[VALUES];
    const double scale = r->x != 0 ? fabs(r->x) : 1;
    const bool squares = kind == SGT_FIGURE_SPOT || kind == SGT_FIGURE_OPD;
    for (size_t v = 0; v < r->size.values; v++) {
        best[v] = spread[v] = HUGE_VAL;
        if (squares)
            gradient[v] *= 2 * r->value[v], error[v] *= 2 * r->value[v],
                r->noise[v] *= 2 * r->value[v] + r->noise[v];
    }
    for (int e = 4; e <= 20; e += 4) {
        if (!difference(r->of, r->x, squares, ldexp(scale, -e), r->size.values, r->noise, by, known))
            continue;
        for (size_t v = 0; v < r->size.values; v++)
            if (known[v] < spread[v]) spread[v] = known[v], best[v] = by[v];
    }
    for (size_t v = 0; v < r->size.values; v++) {
        if (isnan(r->value[v]) || !isfinite(best[v])) continue;
        const double value = squares ? r->value[v] * r->value[v] : fabs(r->value[v]);
        const double off = fabs(gradient[v] - best[v]), size = fmax(fabs(best[v]), 1e-6 * value / scale);
        compared++;
        if (spread[v] < 1e-8 * size) sharp++, worst[kind] = fmax(worst[kind], off / size);
        REQUIRE(off <= error[v] + 3 * spread[v] + 1e-9 * size,
                "%s: %s by %s, value %zu: %.12g, not %.12g (+- %.2g); "
                "value %.6g",
                file, kind_name[kind], path, v, gradient[v], best[v], spread[v], r->value[v]);
    }
}

/* false: it is refused. */
static bool try_path(const sgt_lens *lens, const char *file, sgt_figure_kind kind, const char *path)
{
    const sgt_study_options study = options_of();
    sgt_error e = {0};
    double gradient[VALUES], error[VALUES], value[VALUES];
    reading r = {.of = sgt_figure_new(lens, &study, &(sgt_figure_options){.kind = kind}, 1, &path, &e)};
    if (!r.of) return false;
    r.size = sgt_figure_size(r.of);
    sgt_figure_start(r.of, &r.x);
    sgt_figure_out out = {.value = value, .value_err = r.noise, .gradient = gradient, .gradient_err = error};
    if (r.size.values > VALUES || !sgt_figure_eval(r.of, NULL, &out, &e)) {
        refused++;
        REQUIRE(*e.words, "%s: %s by %s: refused without words", file, kind_name[kind], path);
        if (getenv("SHOW"))
            printf("%s: %s by %s: refused: %s: %s\n", file, kind_name[kind], path, e.key, e.words);
        sgt_figure_free(r.of);
        return false;
    }
    if (r.size.values <= VALUES) {
        memcpy(r.value, value, r.size.values * sizeof *value);
        compare(file, kind, path, &r, gradient, error);
    }
    sgt_figure_free(r.of);
    return true;
}

/* Several paths at once: the same numbers; the sum of squares; the gradient by the Jacobian. */
static void try_together(const sgt_lens *lens, const char *file, sgt_figure_kind kind, size_t count,
                         const char *const path[])
{
    const sgt_study_options study = options_of();
    sgt_figure *f = sgt_figure_new(lens, &study, &(sgt_figure_options){.kind = kind}, count, path, NULL);
    if (!f || count == 0) {
        sgt_figure_free(f);
        return;
    }
    const sgt_figure_count size = sgt_figure_size(f);
    double *residual = calloc(size.residuals + 1, sizeof *residual), gradient[VALUES * PATHS_OF_LENS],
           value[VALUES];
    double *jacobian = calloc(size.residuals * count + 1, sizeof *jacobian), square = 0;
    sgt_figure_out out = {.residual = residual, .jacobian = jacobian, .value = value, .gradient = gradient};
    const bool fine = size.values <= VALUES && sgt_figure_eval(f, NULL, &out, NULL);
    REQUIRE(fine, "%s: %s by %zu paths", file, kind_name[kind], count);
    for (size_t i = 0; fine && i < size.residuals; i++) square += residual[i] * residual[i];
    const size_t last = size.values - 1;
    if (fine && kind <= SGT_FIGURE_OPD)
        REQUIRE(fabs(sqrt(square) - value[last]) <= 1e-12 * value[last], "%s: %s: %g, not %g", file,
                kind_name[kind], sqrt(square), value[last]);
    for (size_t m = 0; fine && m < count; m++) {
        double own = 0, alone[VALUES], size_of = 0;
        for (size_t i = 0; i < size.residuals; i++) {
            own += residual[i] * jacobian[i * count + m];
            size_of += jacobian[i * count + m] * jacobian[i * count + m];
        }
        if (kind <= SGT_FIGURE_OPD)
            REQUIRE(fabs(own - value[last] * gradient[last * count + m]) <=
                        1e-11 * sqrt(size_of) * value[last],
                    "%s: %s by %s: %g by the Jacobian, not %g", file, kind_name[kind], path[m],
                    own / value[last], gradient[last * count + m]);
        sgt_figure *one =
            sgt_figure_new(lens, &study, &(sgt_figure_options){.kind = kind}, 1, &path[m], NULL);
        sgt_figure_out by_one = {.value = value, .gradient = alone};
        REQUIRE(one && sgt_figure_eval(one, NULL, &by_one, NULL), "%s: %s by %s", file, kind_name[kind],
                path[m]);
        for (size_t v = 0; v < size.values; v++) {
            const double x = gradient[v * count + m];
            REQUIRE(x == alone[v] || (isnan(x) && isnan(alone[v])) || fabs(x - alone[v]) <= 1e-9 * fabs(x),
                    "%s: %s by %s: %.17g together, %.17g alone", file, kind_name[kind], path[m], x, alone[v]);
        }
        sgt_figure_free(one);
    }
    free(residual), free(jacobian);
    sgt_figure_free(f);
}

/* ------------------------------------------------------------------------- memory */

/* With an allocator that fails at each place in turn: the error says so, nothing is lost, and the figure asks
 * again as if nothing had been. */
static void try_memory(const char *path, sgt_figure_kind kind, const char *const by[2])
{
    const sgt_lens_options opt = {.allocator = &counted};
    const sgt_pattern fan = SGT_PATTERN_FAN;
    const sgt_study_options study = {.allocator = &counted, .pattern = &fan, .rays = 3};
    double value[VALUES], gradient[VALUES * 2], again[VALUES * 2];
    sgt_figure_out out = {.value = value, .gradient = gradient};
    sgt_lens *lens = sgt_lens_read(path, &opt, NULL);
    REQUIRE(lens, "%s", path);
    const long base = held;
    bool made = false;
    for (long i = 0; lens && !made && i < 4000; i++) {
        sgt_error e = {0};
        before_failure = i;
        sgt_figure *f = sgt_figure_new(lens, &study, &(sgt_figure_options){.kind = kind}, 2, by, &e);
        made = f && sgt_figure_eval(f, NULL, &out, &e);
        REQUIRE(made || strstr(e.words, "no memory"), "%s: %s: %s: %s", path, kind_name[kind], e.key,
                e.words);
        before_failure = -1;
        if (f && !made) {
            sgt_figure_out whole = {.value = value, .gradient = again};
            REQUIRE(sgt_figure_eval(f, NULL, &whole, &e), "%s: %s: %s", path, kind_name[kind], e.words);
        }
        sgt_figure_free(f);
        REQUIRE(held == base, "%s: %s: %ld blocks are lost", path, kind_name[kind], held - base);
    }
    REQUIRE(made, "%s: %s", path, kind_name[kind]);
    sgt_lens_free(lens);
    REQUIRE(held == 0, "%ld blocks are lost", held);
}

/* Of a phase, of facets or of an ideal lens: few lenses have one, so each is tried. */
static bool is_of_phase(const char *path)
{
    return strstr(path, "phase") || strstr(path, "facets") || strstr(path, "focal_length");
}

int main(int count, char **argument)
{
    static sgt_lens_path at[MOST];
    const char *scale = getenv("SAGITTA_TEST_SCALE"), *seed = getenv("SAGITTA_TEST_SEED");
    const double cases = scale ? atof(scale) : 0.5;
    const size_t few = cases > 1 ? MOST : cases < 0.1 ? 3 : cases < 1 ? PATHS_OF_LENS / 2 : PATHS_OF_LENS;
    for (int i = 1; i < count; i++) {
        sgt_error e = {0};
        sgt_lens *lens = sgt_lens_read(argument[i], NULL, &e);
        REQUIRE(lens, "%s: %s: %s", argument[i], e.key, e.words);
        if (!lens) continue;
        size_t paths = sgt_lens_paths(lens, MOST, at);
        if (paths > MOST) paths = MOST;
        const size_t stride = (paths + few - 1) / few, first = seed ? (size_t)atol(seed) % stride : 0;
        const char *name = strrchr(argument[i], '/'), *file = name ? name + 1 : argument[i];
        for (int kind = 0; kind < 5; kind++) {
            const char *taken[PATHS_OF_LENS];
            size_t together = 0;
            for (size_t p = 0; p < paths; p++)
                if ((p % stride == first ||
                     (kind < SGT_FIGURE_CHIEF && cases >= 0.1 && is_of_phase(at[p].path))) &&
                    try_path(lens, file, (sgt_figure_kind)kind, at[p].path) &&
                    together < PATHS_OF_LENS)
                    taken[together++] = at[p].path;
            try_together(lens, file, (sgt_figure_kind)kind, together, taken);
        }
        sgt_lens_free(lens);
    }
    static const char *const shape[] = {"surfaces[1].radius", "surfaces[1].thickness"},
                      *const waves[] = {"surfaces[1].phase.lines", "surfaces[1].thickness"};
    for (int kind = 0; kind < 5 && count > 1; kind++) try_memory(argument[1], (sgt_figure_kind)kind, shape);
    for (int i = 1; i < count; i++)
        if (strstr(argument[i], "phases.yaml")) try_memory(argument[i], SGT_FIGURE_SPOT, waves);
    printf("%zu derivatives compared, %zu of them to 1e-8 or better, %zu refused; worst of these:", compared,
           sharp, refused);
    for (int k = 0; k < 5; k++) printf(" %s %.2g", kind_name[k], worst[k]);
    printf("\n");
    return faults != 0;
}
