// SPDX-License-Identifier: MIT
/* Nanoseconds a ray of batches of first roots, a line for each family: its name and the number.  run.py
 * runs it on one system after the other, again and again, and takes medians.
 *
 *     speed [MILLISECONDS]    for each family at least so long (20)
 *
 * Surfaces and rays are of the kind of tests/cost/cases.c: c = 0.1, k = -0.6, rim 4, departures of 0.01;
 * 1000 rays from z = -5, uniform in the disk of radius 2.5, with slopes up to 0.15.  Arrays are in the
 * processor's cache. */
#include <math.h>
#include <sagitta/surfaces.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#ifdef _WIN32
#include <windows.h>
#else
#include <time.h>
#endif

#define RIM 4
#define BASE .c = 0.1, .k = -0.6, .semi_diameter = RIM

enum { RAYS = 1000 };

static double now(void) /* in ns */
{
#ifdef _WIN32
    LARGE_INTEGER count, each;
    QueryPerformanceCounter(&count), QueryPerformanceFrequency(&each);
    return 1e9 * (double)count.QuadPart / (double)each.QuadPart;
#else
    struct timespec t;
    timespec_get(&t, TIME_UTC);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
#endif
}

static double uniform(double lo, double hi) /* splitmix64 */
{
    static uint64_t state = 0x1234567;
    uint64_t z = state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return lo + (hi - lo) * ((double)((z ^ (z >> 31)) >> 11) * 0x1p-53);
}

static double in[6][RAYS], t[RAYS], t_err[RAYS], p[3][RAYS], n[3][RAYS];
static sgt_status status[RAYS];

static void draw_rays(double radius, double from, double slope)
{
    for (int i = 0; i < RAYS; i++) {
        double x, y, l = uniform(-slope, slope), m = uniform(-slope, slope);
        do x = uniform(-radius, radius), y = uniform(-radius, radius);
        while (x * x + y * y > radius * radius);
        in[0][i] = x, in[1][i] = y, in[2][i] = from;
        in[3][i] = l, in[4][i] = m, in[5][i] = sqrt(1 - l * l - m * m);
    }
}

static void measure(const char *family, const sgt_surface_ops *ops, const void *self, double least)
{
    const sgt_surface surface = {ops, self};
    const sgt_rays rays = {{in[0], in[1], in[2]}, {in[3], in[4], in[5]}, NULL, NULL};
    const sgt_hits hits = {
        .status = status, .t = t, .t_err = t_err, .p = {p[0], p[1], p[2]}, .n = {n[0], n[1], n[2]}};
    size_t hit = sgt_intersect_batch(surface, RAYS, rays, hits, NULL); /* the first touch of all */
    double best = HUGE_VAL, end = now() + least;
    for (int turn = 0; turn < 3 || now() < end; turn++) {
        double begin = now();
        sgt_intersect_batch(surface, RAYS, rays, hits, NULL);
        double took = (now() - begin) / RAYS;
        if (took < best) best = took;
    }
    printf("%s %.2f\n", family, hit > 0 ? best : (double)NAN);
}

int main(int argc, char **argv)
{
    static const double terms[] = {0, 0, 0, 0.01, -0.004, 0.006, 0.003, -0.002, 0.001, 0.002, 0.001};
    const sgt_conic sphere = {.c = 0.1, .semi_diameter = RIM};
    const sgt_even_asphere asphere = {BASE, .a = {0, 1e-4, -2e-6, 1e-8}};
    const sgt_numbers of_terms = {terms, 1, sizeof terms / sizeof *terms};
    const sgt_zernike zernike = {BASE, .norm = RIM, .order = SGT_NOLL, .a = of_terms};
    const sgt_biconic biconic = {.c_x = 0.1, .k_x = -0.6, .c_y = 0.08, .k_y = 0.2, .semi_diameter = RIM};
    const sgt_torus torus = {.major = 2, .minor = 0.8};
    const sgt_julia julia = {.c = {-0.2, 0.8, 0, 0}, .iterations = 8};
    double least = 1e6 * (argc > 1 ? atof(argv[1]) : 20);

    draw_rays(2.5, -5, 0.15);
    measure("sphere", &sgt_conic_ops, &sphere, least);
    measure("even_asphere", &sgt_even_asphere_ops, &asphere, least);
    measure("zernike", &sgt_zernike_ops, &zernike, least);
    measure("biconic", &sgt_biconic_ops, &biconic, least);
    measure("torus", &sgt_torus_ops, &torus, least);
    draw_rays(1, -3, 0.05);
    measure("julia", &sgt_julia_ops, &julia, least);
    return 0;
}
