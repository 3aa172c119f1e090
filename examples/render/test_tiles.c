// SPDX-License-Identifier: MIT
/* test_tiles.c - do threads and tiles leave a picture alone?
 *
 *     test_tiles SCENE.yaml ...
 *
 * Each scene, as light and as painted, in threads and tiles of many sizes: the numbers of every pixel,
 * before they become bytes, are those of one thread that draws pixel by pixel; so are the counts. */
#include "read.h"
#include "tiles.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 31, HEIGHT = 21, SAMPLES = 3 };

static bool same(const char *file, const scene *s, paint_kind paint)
{
    static const struct {
        int threads, tile;
    } ways[] = {{1, 1}, {1, 2}, {1, TILE}, {2, TILE}, {3, TILE}, {2, 5}, {3, 7}, {1, 100}};
    picture wanted = picture_new(s->width, s->height), p = picture_new(s->width, s->height);
    tally count_wanted = {0};
    bool good = true;
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        order o = {.samples = SAMPLES,
                   .threads = ways[i].threads,
                   .tile = ways[i].tile,
                   .frame = 5,
                   .paint = paint,
                   .name = file};
        tally count = {0};
        tiles_render(s, 0.5, &o, i ? &p : &wanted, i ? &count : &count_wanted);
        if (i == 0) continue;
        bool pixels = memcmp(p.pixel, wanted.pixel, sizeof *p.pixel * WIDTH * HEIGHT) == 0;
        if (pixels && memcmp(&count, &count_wanted, sizeof count) == 0) continue;
        printf("FAILED %s, paint %d: %d threads, tiles of %d change the %s\n", file, (int)paint, o.threads,
               o.tile, pixels ? "counts" : "pixels");
        good = false;
    }
    free(p.pixel), free(wanted.pixel);
    return good;
}

int main(int count, char *files[])
{
    static scene s;
    bool good = count > 1;
    for (int i = 1; i < count; i++) {
        read_scene(&s, files[i]);
        s.width = WIDTH, s.height = HEIGHT;
        for (int paint = PAINT_LIGHT; paint <= PAINT_STATUS; paint++)
            good = same(files[i], &s, (paint_kind)paint) && good;
        scene_free(&s);
    }
    return !good;
}
