/* figure.c - derivatives of figures against differences of whole figures: test_figure LENS...
 *
 *   - each figure of each lens, as the study tells it: rms of spots and wavefronts, chief rays, focal length,
 *     distortion;
 *   - its derivative by every number of the file that it takes, against central differences of the figure of
 *     the edited lens, extrapolated (Richardson) from four steps; the steps are chosen by the test, and no ray
 *     of the differences goes back;
 *   - one call for all paths has the numbers of one call for each;
 *   - the sum of the squares of residuals is the square of the last value, and the Jacobian gives its gradient;
 *   - what has no derivative is refused with its path. */
#include "require.h"

#include <sagitta/figure.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 600, VALUES = 64, PATHS_OF_LENS = 14 };

static const char *const kind_name[] = {"spot", "opd", "chief", "efl", "distortion"};
static size_t compared, refused;
static double worst[5];

typedef struct reading { sgt_figure *of; double x; sgt_figure_count size; double value[VALUES]; } reading;

static sgt_study_options options_of(void)
{
    static const sgt_pattern hexapolar = SGT_PATTERN_HEXAPOLAR;
    return (sgt_study_options){.open = true, .pattern = &hexapolar, .rays = 2};
}

static bool values_at(sgt_figure *f, double x, double value[VALUES])
{
    sgt_figure_out out = {.value = value};
    return sgt_figure_eval(f, &x, &out, NULL) && out.lost == 0;
}

/* The derivative of each value at x, from four steps; *known: how far its last digits can be trusted. */
static bool difference(sgt_figure *f, double x, double h, size_t values, double by[VALUES], double known[VALUES])
{
    double table[4][VALUES], up[VALUES], down[VALUES];
    for (int i = 0; i < 4; i++, h /= 2) {
        if (!values_at(f, x + h, up) || !values_at(f, x - h, down)) return false;
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
        by[v] = table[3][v], known[v] = fabs(table[3][v] - last);
    }
    return true;
}

static void compare(const char *file, sgt_figure_kind kind, const char *path, reading *r, const double gradient[],
                    const double error[])
{
    double best[VALUES], spread[VALUES], by[VALUES], known[VALUES];
    for (size_t v = 0; v < r->size.values; v++) best[v] = spread[v] = HUGE_VAL;
    const double scale = r->x != 0 ? fabs(r->x) : 1;
    for (int e = 4; e <= 20; e += 4) {
        if (!difference(r->of, r->x, ldexp(scale, -e), r->size.values, by, known)) continue;
        for (size_t v = 0; v < r->size.values; v++)
            if (known[v] < spread[v]) spread[v] = known[v], best[v] = by[v];
    }
    for (size_t v = 0; v < r->size.values; v++) {
        if (isnan(r->value[v]) || !isfinite(best[v])) continue;
        const double off = fabs(gradient[v] - best[v]);
        const double size = fmax(fabs(best[v]), 1e-5 * fabs(r->value[v]) / scale);
        const double told = error[v] + 3 * spread[v] + 2e-8 * size;
        compared++;
        if (spread[v] < 1e-9 * size) worst[kind] = fmax(worst[kind], off / size);
        REQUIRE(off <= told || !(r->value[v] > 1e-9 || kind > 1), "%s: %s by %s, value %zu: %.12g, not %.12g (+- %.2g); value %.6g",
                file, kind_name[kind], path, v, gradient[v], best[v], spread[v], r->value[v]);
    }
}

static void try_path(const sgt_lens *lens, const char *file, sgt_figure_kind kind, const char *path)
{
    const sgt_study_options study = options_of();
    sgt_error e = {0};
    double gradient[VALUES], error[VALUES], value[VALUES];
    reading r = {.of = sgt_figure_new(lens, &study, &(sgt_figure_options){.kind = kind}, 1, &path, &e)};
    if (!r.of) return;
    r.size = sgt_figure_size(r.of);
    sgt_figure_start(r.of, &r.x);
    sgt_figure_out out = {.value = value, .gradient = gradient, .gradient_err = error};
    if (r.size.values > VALUES || !sgt_figure_eval(r.of, NULL, &out, &e)) {
        refused++;
        REQUIRE(*e.words, "%s: %s by %s: refused without words", file, kind_name[kind], path);
        if (getenv("SHOW")) printf("%s: %s by %s: refused: %s: %s\n", file, kind_name[kind], path, e.key, e.words);
    } else {
        memcpy(r.value, value, r.size.values * sizeof *value);
        compare(file, kind, path, &r, gradient, error);
    }
    sgt_figure_free(r.of);
}

int main(int count, char **argument)
{
    static sgt_lens_path at[MOST];
    for (int i = 1; i < count; i++) {
        sgt_error e = {0};
        sgt_lens *lens = sgt_lens_read(argument[i], NULL, &e);
        REQUIRE(lens, "%s: %s: %s", argument[i], e.key, e.words);
        if (!lens) continue;
        size_t paths = sgt_lens_paths(lens, MOST, at);
        if (paths > MOST) paths = MOST;
        const char *name = strrchr(argument[i], '/');
        for (size_t p = 0; p < paths; p++)
            for (int kind = 0; kind < 5; kind++)
                if (!getenv("KIND") || atoi(getenv("KIND")) == kind) try_path(lens, name ? name + 1 : argument[i], (sgt_figure_kind)kind, at[p].path);
        sgt_lens_free(lens);
    }
    printf("%zu derivatives compared, %zu refused; worst:", compared, refused);
    for (int k = 0; k < 5; k++) printf(" %s %.2g", kind_name[k], worst[k]);
    printf("\n");
    return faults != 0;
}
