// SPDX-License-Identifier: MIT
/* pictures.c - the options of a picture. */
#include "pictures.h"

#include "../base/input.h"
#include "chart.h"
#include "../read/surface.h"

#include <math.h>

void pictures_check(const pictures *p)
{
    if (p->file) chart_check("picture", p->file);
    else if (p->plane) fail_usage("--plane: is of a picture; give --picture FILE, too");
}

view_plane pictures_plane(const pictures *p) { return p->plane ? (view_plane)(p->plane - 1) : VIEW_YZ; }

void pictures_reserve(const pictures *p, const char *output, const job *j)
{
    if (!p->file) return;
    if (output) output_check("output", output);
    output_reserve("picture", p->file);
    for (size_t i = 0; i < j->lens.count; i++)
        if (surface_is_level_set(j->element[i].surface))
            note("--picture: element %zu (%s) is not drawn, because it is a level set", i + 1,
                 j->lens.surface[i].type);
}

/* Do all rays lie in the plane x = 0, seen from its edge? */
static bool edge_on(const scene *s)
{
    double most = 0;
    for (size_t i = 0; i < s->paths; i++)
        for (size_t k = 0; k < s->path[i].count; k++) most = fmax(most, fabs(s->path[i].at[k].x));
    return s->view.plane == VIEW_XZ && s->paths > 1 && s->job->fields > 0 && most < 1e-9 * s->lead;
}

void pictures_write(const pictures *p, scene *s)
{
    if (!p->file) return;
    scene_finish(s);
    if (edge_on(s)) note("--plane xz: all rays lie in the plane x = 0; --cross N sends some in x, too");
    picture_write(p->file, picture_kind_of("picture", p->file), s);
}
