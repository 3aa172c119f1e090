// SPDX-License-Identifier: MIT
/* checksum.c for the surfaces about the Earth (geo.h): checksum_earth [PART].  The geoid is rough, and its
 * grid made here. */
#define _POSIX_C_SOURCE 200809L /* mkstemp */
#include "checksum.h"

#include <sagitta/geo.h>
#include <unistd.h>

/* A .gtx grid of the globe every ten degrees, big-endian, of heights to +-80 m that know nothing of their
 * neighbours. */
static sgt_geoid *rough_geoid(generator *g)
{
    enum { ROWS = 19, COLUMNS = 36 };
    unsigned char bytes[40 + 4 * ROWS * COLUMNS], *at = bytes;
    const double where[4] = {-90, -180, 10, 10};
    for (int i = 0; i < 4; i++)
        for (int shift = 56; shift >= 0; shift -= 8) *at++ = (unsigned char)(bits_of(where[i]) >> shift);
    float pole = 0;
    for (int i = 0; i < 2 + ROWS * COLUMNS; i++) {
        float height = (float)uniform(g, -80, 80);
        if ((i > 2 && i < 2 + COLUMNS) || i > 2 + (ROWS - 1) * COLUMNS) height = pole; /* one at each */
        pole = height;
        uint32_t word = i == 0 ? ROWS : COLUMNS;
        if (i > 1) memcpy(&word, &height, sizeof word);
        for (int shift = 24; shift >= 0; shift -= 8) *at++ = (unsigned char)(word >> shift);
    }
    char path[] = "/tmp/checksum_earth.XXXXXX";
    sgt_error error = {.words = "no file can be written in /tmp"};
    int file = mkstemp(path);
    sgt_geoid *geoid = file >= 0 && write(file, bytes, sizeof bytes) == (ssize_t)sizeof bytes
                           ? sgt_geoid_open(path, &error)
                           : NULL;
    if (file >= 0) close(file), unlink(path);
    if (!geoid) fprintf(stderr, "%s\n", error.words);
    return geoid;
}

static void add_type(const sgt_builtin *type, generator *g, int rounds, const sgt_geoid *geoid)
{
    while (rounds-- > 0) {
        specimen s = {.type = type, .size = 6.4e6};
        double h = chance(g, 0.3) ? 0 : chance(g, 0.9) ? uniform(g, -1e3, 1e5) : hostile_number(g);
        if (type->ops == &sgt_geodetic_height_ops) {
            bool own = chance(g, 0.4);
            sgt_geodetic_height with = {.a = own ? 6.4e6 : 0, .f = own ? uniform(g, -0.3, 0.5) : 0, .h = h};
            memcpy(&s.with, &with, sizeof with);
        } else if (type->ops == &sgt_level_gravity_ops) {
            bool level = chance(g, 0.3);
            sgt_level_gravity with = {.h = level ? 0 : h, .potential = level ? uniform(g, 5e7, 6.3e7) : 0};
            memcpy(&s.with, &with, sizeof with);
        } else {
            sgt_geoid_height with = {.geoid = geoid, .h = h};
            memcpy(&s.with, &with, sizeof with);
        }
        survey(g, &s);
        sgt_options opt = chance(g, 0.6) ? (sgt_options){0} : hostile_options(g);
        size_t n = (size_t)below(g, BATCH + 1);
        for (size_t i = 0; i < n; i++) {
            rays[i] = i % 2 ? hostile_ray(g, &s) : ordinary_ray(g, &s);
            sgt_vec3 gradient;
            add_number(type->ops->value(&s.with, rays[i].o, &gradient)), add_vector(gradient);
        }
        if (listed) printf("    %s  h %a\n", type->type, h), print_options(&opt);
        add_surface(surface_of(&s), n, &opt);
    }
}

int main(int argc, char **argv)
{
    generator g = {test_seed(2)};
    double scale = test_scale();
    sgt_geoid *geoid = rough_geoid(&g);
    if (!geoid) return 1;
    for (const sgt_builtin *b = sgt_geo_builtins(); b->type; b++) {
        generator own = {random_bits(&g)};
        if (begin(b->type, argc, argv)) add_type(b, &own, (int)(40 * scale) + 1, geoid), end(b->type);
    }
    sgt_geoid_close(geoid);
    return 0;
}
