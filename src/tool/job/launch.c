// SPDX-License-Identifier: MIT
/* launch.c - the rays of the fields of a lens, by the library's launcher. */
#include "launch.h"

#include "../base/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Memory that lasts until the command ends: a size of 0 gives a block back. */
static void *resize_lasting(void *context, void *block, size_t size)
{
    (void)context;
    if (size) return block ? memory_grow(block, size, 1) : memory_take(size, 1);
    memory_drop(block);
    return NULL;
}

launch_pattern launch_points(sgt_pattern pattern, size_t n, uint64_t seed)
{
    static const sgt_allocator lasting = {.resize = resize_lasting};
    const sgt_pupil *pupil = sgt_pupil_new(pattern, n, seed, &lasting);
    return (launch_pattern){.count = sgt_pupil_count(pupil), .pattern = pupil};
}

void launch_points_part(const launch_pattern *points, size_t first, size_t count, sgt_pupil_point at[])
{
    if (points->pattern) sgt_pupil_part(points->pattern, first, count, at);
    else memcpy(at, points->at + first, count * sizeof *at);
}

/* Launchers are freed when the command ends. */
static sgt_launcher **launchers;
static size_t launcher_count, launcher_capacity;

static void free_launchers(void)
{
    for (size_t i = 0; i < launcher_count; i++) sgt_launcher_free(launchers[i]);
}

launch_how launch_by(const lens *l, const sgt_lens_aim *aim)
{
    sgt_error e;
    const sgt_launcher_options options = {.aim = aim, .wavelength = isnan(l->wavelength) ? 0 : l->wavelength};
    launch_how how = {.from = sgt_launcher_new(l->of, &options, &e)};
    if (!how.from) lens_refuse(&e);
    if (!launchers) atexit(free_launchers);
    launchers = memory_room(launchers, launcher_count, &launcher_capacity, sizeof(sgt_launcher *));
    launchers[launcher_count++] = how.from;
    return how;
}

const char *launch_words(sgt_aimed status, double within)
{
    char text[200];
    if (status == SGT_NO_SUCH_RAY)
        return "there is no ray, as is proven for all that the rims in front let through";
    if (!(within > 0)) return "no ray was found, but there may be one";
    snprintf(text, sizeof text,
             "no ray was found (none within %g pupil radii; beyond that there may be one)", within);
    return memory_text(text, strlen(text));
}

static void note_missing(launch_how *how, const launch *l)
{
    enum { TOLD = 4 };
    const size_t before = how->none + how->undecided;
    if (before < TOLD)
        note("ray %zu (field %zu, px %g, py %g of the stop): %s", l->number,
             how->field_number[l->field] + 1, l->px, l->py, launch_words(l->status, l->within));
    else if (before == TOLD) note("and more rays that are not there");
    *(l->status == SGT_NO_SUCH_RAY ? &how->none : &how->undecided) += 1;
}

void launch_take(launch_how *how, const ray_block *b)
{
    for (size_t i = 0; i < b->lost_count; i++) note_missing(how, &b->lost[i]);
    how->folded += b->folded;
}

sgt_field_beam launch_beam(const launch_how *how, sgt_field_kind kind, sgt_lens_field at)
{
    sgt_field_beam beam;
    sgt_error e;
    if (!sgt_launch_field(how->from, kind, &at, &beam, &e)) lens_refuse(&e);
    return beam;
}

enum { LAUNCH_PART = 64 }; /* with all that is known of them they stay in the nearest cache */

/* Adds a ray to the block, without its columns. */
static inline void put_number(ray_block *to, size_t number, size_t field, sgt_pupil_point p)
{
    const size_t i = to->count++;
    to->ray[i] = (long long)number, to->field[i] = (int)field, to->px[i] = p.x, to->py[i] = p.y;
}

/* Adds a ray to the block. */
static void put_launched(ray_block *to, const sgt_launched *l, size_t number, size_t field, sgt_pupil_point p)
{
    if (l->status != SGT_MET) {
        to->lost = memory_room(to->lost, to->lost_count, &to->lost_room, sizeof *to->lost);
        to->lost[to->lost_count++] = (launch){.ray = l->ray, .number = number, .field = field, .px = p.x,
                                              .py = p.y, .status = l->status, .within = l->within};
        return;
    }
    const double value[] = {l->ray.o.x, l->ray.o.y, l->ray.o.z, l->ray.d.x, l->ray.d.y, l->ray.d.z};
    for (int k = 0; k < 6; k++) to->number[k][to->count] = value[k];
    put_number(to, number, field, p);
    to->folded += l->folded;
}

void launch_part(const launch_plan *plan, size_t first, size_t count, ray_block *to)
{
    sgt_launched launched[LAUNCH_PART];
    sgt_pupil_point p[LAUNCH_PART];
    to->count = to->lost_count = to->folded = 0;
    for (size_t done = 0, part; done < count; done += part) {
        const size_t number = first + done, field = number / plan->points->count;
        const size_t point = number % plan->points->count, left = plan->points->count - point;
        part = count - done < left ? count - done : left;
        if (part > LAUNCH_PART) part = LAUNCH_PART;
        launch_points_part(plan->points, point, part, p);
        double *n[6];
        for (int k = 0; k < 6; k++) n[k] = to->number[k] + to->count;
        if (sgt_launch_columns(plan->how->from, &plan->beam[field], part, p, n, n + 3)) {
            for (size_t i = 0; i < part; i++) put_number(to, number + i, field, p[i]);
            continue;
        }
        if (!sgt_launch_rays(plan->how->from, &plan->beam[field], plan->element,
                             plan->traced->index_before, part, p, launched, NULL))
            fail_input("out of memory");
        for (size_t i = 0; i < part; i++) put_launched(to, &launched[i], number + i, field, p[i]);
    }
}

void launch_field(ray_list *list, launch_how *how, const lens *traced, const sgt_element *element,
                  size_t field, sgt_field_kind kind, sgt_lens_field at, const launch_pattern *points)
{
    const sgt_field_beam beam = launch_beam(how, kind, at);
    const launch_plan plan = {.how = how, .traced = traced, .element = element, .fields = 1,
                              .beam = &beam, .points = points};
    ray_block *b = memory_take(1, sizeof *b);
    for (size_t first = 0, count; first < points->count; first += count) {
        count = points->count - first < TILE_RAYS ? points->count - first : TILE_RAYS;
        launch_part(&plan, first, count, b);
        for (size_t i = 0; i < b->count; i++) b->ray[i] += (long long)how->count, b->field[i] = (int)field;
        for (size_t i = 0; i < b->count; i++) rays_add(list, rays_launch(b, i));
        for (size_t i = 0; i < b->lost_count; i++) b->lost[i].number += how->count, b->lost[i].field = field;
        for (size_t i = 0; i < b->lost_count; i++) rays_add(&how->missing, b->lost[i]);
        launch_take(how, b);
    }
    how->count += points->count;
}

void launch_note(const launch_how *how, size_t wavelengths)
{
    if (how->none + how->undecided)
        note("%zu of %zu rays are not there; this is proven for %zu", how->none + how->undecided,
             how->count * wavelengths, how->none);
    if (how->undecided)
        note("%zu undecided: sagitta diagnose with the same options and --ray I shows why", how->undecided);
    if (how->folded)
        note("%zu of %zu rays come through the pupil where it is folded: they reach the stop in reversed "
             "order, and another ray of the field may reach the same point",
             how->folded, how->count * wavelengths);
}
