// SPDX-License-Identifier: MIT
/* rays.h - the rays of a command: from a file, from --ray, or through a pupil. */
#ifndef TOOL_RAYS_H
#define TOOL_RAYS_H
#include "../base/tiles.h"

#include <sagitta/aim.h>

typedef struct launch {
    sgt_ray ray;
    size_t number;      /* from 0; in a file, that of its data row, bad rows included */
    size_t field;       /* index in the list of fields; 0 for rays from a file */
    double px, py;      /* where it crosses the pupil, in radii of it; of a launched ray */
    const char *id;     /* from the file; NULL: it has no such column */
    sgt_aimed status;   /* of a launched ray: unless SGT_MET, it is not there */
    double within;      /* if it is not there: as in sgt_launched */
} launch;

/* Rays by column: those of a tile. */
typedef struct ray_block {
    size_t count;
    bool ended;                         /* there are tmin and tmax; else they are 0 and infinite */
    double number[8][TILE_RAYS];        /* o, d, tmin, tmax */
    long long ray[TILE_RAYS];           /* what a launch has of each: its number, */
    int field[TILE_RAYS];
    double px[TILE_RAYS], py[TILE_RAYS];
    const char *id[TILE_RAYS];
    size_t folded;                      /* how many are where the pupil is inside out */
    size_t lost_count, lost_room;
    launch *lost;                       /* those that are not there */
} ray_block;

/* A ray of a block by itself. */
launch rays_launch(const ray_block *b, size_t i);

/* Its columns for a batch. */
static inline sgt_rays rays_columns(const ray_block *b)
{
    const double(*n)[TILE_RAYS] = b->number;
    return (sgt_rays){.o = {n[0], n[1], n[2]}, .d = {n[3], n[4], n[5]}, .tmin = b->ended ? n[6] : NULL,
                      .tmax = b->ended ? n[7] : NULL};
}

typedef struct ray_table ray_table;
typedef struct ray_list {
    size_t count, capacity;
    launch *ray;
    bool ended;         /* the file has a column tmin or tmax */
    bool named;         /* the file has a column `id` */
    size_t longest_id;  /* characters of the longest of them */
    int threads;        /* to read the file with; 0: one */
    bool parts;         /* set by a command that calls rays_part: arrays are then not read whole */
    bool begun;         /* there is a --from, and its place: */
    double from[3];
    bool some;          /* set with `parts`, if only some rows are asked for: others are not looked at */
    /* A file or --from may give places: o holds latitude, longitude, height and d azimuth, elevation, 1 until
     * the command has made rays of them (read/earth.h).  `earth` is set by a command that does. */
    bool earth, places;
    const ray_table *table; /* arrays that are read in parts: `ray` is NULL, `count` with bad rows */
} ray_list;

void rays_add(ray_list *list, launch ray);

/* Reads CSV with a header row from a file ("-": standard input), or arrays of NumPy, into an empty list.  A
 * bad row ends the command, with its line in the message.  With skip_bad bad rows are skipped, and a note on
 * standard error says how many. */
void rays_read(ray_list *list, const char *path, bool skip_bad);

/* The good ones of the rays first ... first + count - 1, at most TILE_RAYS. */
void rays_part(const ray_list *list, size_t first, size_t count, ray_block *to);

/* The tmax that is meant: infinity where both ends are left at their default. */
double ray_end(const sgt_ray *ray);

/* Adds the ray of a --ray: "ox oy oz dx dy dz", optionally followed by "tmin tmax". */
void rays_parse(ray_list *list, const char *text);

/* The same of places: --from "lat lon height" holds for each --look "az el" after it, and that adds a ray. */
void rays_from(ray_list *list, const char *text);
void rays_look(ray_list *list, const char *text);

#endif
