/* costs.c - what costs.py compares Python with: the same calls, on the same rays, from C.
 *
 *     costs RAYS ROUNDS LENS SURFACE     RAYS: 6 rows of doubles, as the machine has them
 *
 * Prints the least seconds of processor time of sgt_intersect_batch of the surface and of sgt_trace_batch of
 * the lens. */
#include <sagitta/lens.h>
#include <sagitta/system.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

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
    double *ray = malloc(6 * n * sizeof *ray), *out = malloc(16 * n * sizeof *out);
    int *whole = malloc(n * sizeof *whole);
    signed char *status = malloc(n);
    if (!ray || !out || !whole || !status || fread(ray, sizeof *ray, 6 * n, f) != 6 * n) return 2;
    memset(out, 1, 16 * n * sizeof *out); /* the pages are there, as those that Python uses again */
    memset(whole, 1, n * sizeof *whole), memset(status, 1, n);
    sgt_rays rays = {{ray, ray + n, ray + 2 * n}, {ray + 3 * n, ray + 4 * n, ray + 5 * n}, NULL, NULL};
    double *at[16];
    for (size_t i = 0; i < 16; i++) at[i] = out + i * n;
    sgt_hits hits = {status, whole, at[0], at[1], at[2], {at[3], at[4], at[5]}, {at[6], at[7], at[8]}, at[9]};
    sgt_traced traced = {status, whole, {at[0], at[1], at[2]}, {at[3], at[4], at[5]}, at[6]};
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
    free(status), free(whole), free(out), free(ray);
    fclose(f), sgt_lens_free(one), sgt_lens_free(lens);
    return 0;
}
