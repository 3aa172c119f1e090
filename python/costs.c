/* costs.c - what costs.py compares Python with: the same calls, on the same rays, from C.
 *
 *     costs RAYS ROUNDS LENS SURFACE     RAYS: 6 rows of doubles, as the machine has them
 *
 * Prints the least seconds of processor time of sgt_intersect_batch of the surface and of sgt_trace_batch of
 * the lens. */
#include <sagitta/lens.h>
#include <sagitta/system.h>

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* As numpy has its arrays: where they stand in their cache lines, and what of them is in large pages, is worth
 * a tenth of the time. */
static void *array(size_t n, size_t size)
{
    const size_t page = 4096, bytes = n * size;
    char *x = malloc(bytes);
#ifdef MADV_HUGEPAGE
    if (x && bytes >= (size_t)1 << 22) {
        size_t skip = page - (size_t)((uintptr_t)x % page);
        (void)madvise(x + skip, bytes - skip, MADV_HUGEPAGE);
    }
#endif
    if (x) memset(x, 1, bytes); /* the pages are there, as those that Python uses again */
    return x;
}

static double *doubles(size_t n) { return array(n, sizeof(double)); }

int main(int count, char **word)
{
    sgt_lens_error error;
    if (count != 5) return 2;
    sgt_lens *lens = sgt_lens_read(word[3], NULL, &error);
    sgt_lens *one = sgt_lens_read_surface("surface", word[4], NULL, &error);
    FILE *f = fopen(word[1], "rb");
    if (!lens || !one || !f) return 2;
    fseek(f, 0, SEEK_END);
    size_t n = (size_t)ftell(f) / (6 * sizeof(double));
    rewind(f);
    double *o = doubles(3 * n), *d = doubles(3 * n), *p = doubles(3 * n), *normal = doubles(3 * n);
    double *t = doubles(n), *t_err = doubles(n), *t_lo = doubles(n), *p_err = doubles(n);
    int *whole = array(n, sizeof *whole);
    signed char *status = array(n, 1);
    if (!o || !d || !p || !normal || !t || !t_err || !t_lo || !p_err || !whole || !status) return 2;
    if (fread(o, sizeof *o, 3 * n, f) != 3 * n || fread(d, sizeof *d, 3 * n, f) != 3 * n) return 2;
    sgt_rays rays = {{o, o + n, o + 2 * n}, {d, d + n, d + 2 * n}, NULL, NULL};
    sgt_hits hits = {status, whole, t, t_err, t_lo, {p, p + n, p + 2 * n},
                     {normal, normal + n, normal + 2 * n}, p_err};
    sgt_traced traced = {status, whole, {p, p + n, p + 2 * n}, {normal, normal + n, normal + 2 * n}, t};
    double best[2] = {1e9, 1e9};
    for (int round = 0; round < atoi(word[2]); round++) {
        double begin = now();
        sgt_intersect_batch(one->element[0].surface, n, rays, hits, NULL);
        double middle = now();
        sgt_trace_batch(lens->count, lens->element, lens->index_before, n, rays, traced, NULL, NULL);
        double end = now();
        if (middle - begin < best[0]) best[0] = middle - begin;
        if (end - middle < best[1]) best[1] = end - middle;
    }
    printf("%.9f %.9f\n", best[0], best[1]);
    free(o), free(d), free(p), free(normal), free(t), free(t_err), free(t_lo), free(p_err), free(whole);
    free(status);
    fclose(f), sgt_lens_free(one), sgt_lens_free(lens);
    return 0;
}
