/* launch.c - the rays of the fields of a lens, by the library's launcher. */
#include "launch.h"

#include "../base/memory.h"

#include <math.h>
#include <stdlib.h>

launch_pattern launch_points(sgt_pattern pattern, size_t n, uint64_t seed)
{
    size_t count = sgt_pupil_points(pattern, n, seed, 0, NULL);
    sgt_pupil_point *at = memory_take(count, sizeof *at);
    sgt_pupil_points(pattern, n, seed, count, at);
    return (launch_pattern){.count = count, .n = n, .at = at, .pattern = pattern};
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
    sgt_lens_error e;
    const sgt_launcher_options options = {.aim = aim, .wavelength = isnan(l->wavelength) ? 0 : l->wavelength};
    launch_how how = {.from = sgt_launcher_new(l->of, &options, &e)};
    if (!how.from) lens_refuse(&e);
    if (!launchers) atexit(free_launchers);
    launchers = memory_room(launchers, launcher_count, &launcher_capacity, sizeof(sgt_launcher *));
    launchers[launcher_count++] = how.from;
    return how;
}

static void note_missing(launch_how *how, const launch *l, sgt_aimed status)
{
    enum { TOLD = 4 };
    const bool none = status == SGT_NO_SUCH_RAY;
    const size_t before = how->none + how->undecided;
    if (before < TOLD)
        note("ray %zu (field %zu, px %g, py %g): %s through this point of the stop", l->number, l->field + 1,
             l->px, l->py, none ? "there is no ray, as is proven," : "no ray was found, nor excluded,");
    else if (before == TOLD) note("and more rays that are not there");
    *(none ? &how->none : &how->undecided) += 1;
}

void launch_field(ray_list *list, launch_how *how, const lens *traced, size_t field, sgt_field_kind kind,
                  sgt_lens_field at, const launch_pattern *points)
{
    enum { PART = 4096 };
    sgt_field_beam beam;
    sgt_lens_error e;
    if (!sgt_launch_field(how->from, kind, &at, &beam, &e)) lens_refuse(&e);
    const size_t room = points->count < PART ? points->count : PART;
    sgt_launched *launched = memory_take(room, sizeof *launched);
    for (size_t first = 0; first < points->count; first += PART) {
        const size_t left = points->count - first, part = left < PART ? left : PART;
        const sgt_pupil_point *p = points->at + first;
        if (!sgt_launch_rays(how->from, &beam, traced->element, traced->index_before, part, p, launched))
            fail_input("out of memory");
        for (size_t i = 0; i < part; i++) {
            const launch l = {.ray = launched[i].ray, .number = how->count++, .field = field, .px = p[i].x,
                              .py = p[i].y};
            if (launched[i].status != SGT_MET) {
                note_missing(how, &l, launched[i].status);
                continue;
            }
            how->folded += launched[i].folded;
            rays_add(list, l);
        }
    }
}

void launch_note(const launch_how *how, size_t wavelengths)
{
    if (how->none + how->undecided)
        note("%zu of %zu rays are not there: of %zu that is proven", how->none + how->undecided,
             how->count * wavelengths, how->none);
    if (how->folded)
        note("%zu of %zu rays come through the pupil where it is folded: they reach the stop in reversed "
             "order, "
             "and another ray of the field may reach the same point",
             how->folded, how->count * wavelengths);
}
