/* pictures.c - the options of pictures. */
#include "pictures.h"

#include "../base/input.h"
#include "../read/surface.h"

#include <math.h>

const char pictures_help[] =
    "  --picture FILE     draw the lens with the rays: an svg, png or pdf file by the ending of its name\n"
    "  --plane P          of the picture: yz (the default) and xz are sections; 3d is a view in space.\n"
    "                     The rays of a fan lie in yz; --cross N sends as many in xz\n"
    "  --svg FILE         as --picture; an svg file, whatever its ending\n";

bool pictures_wanted(const pictures *p) { return p->file || p->svg; }

void pictures_check(pictures *p)
{
    if (p->svg) picture_check("svg");
    if (p->file) picture_check("picture"), p->kind = picture_kind_of("picture", p->file);
    if (p->plane_given && !view_named(p->plane_given, &p->plane))
        fail_usage("--plane must be yz, xz or 3d, not \"%s\"", p->plane_given);
    if (p->plane_given && !pictures_wanted(p))
        fail_usage("--plane: is of a picture; give --picture FILE, too");
}

void pictures_reserve(const pictures *p, const char *output, const job *j)
{
    if (!pictures_wanted(p)) return;
    if (output) output_check("output", output);
    if (p->svg) output_reserve("svg", p->svg);
    if (p->file) output_reserve("picture", p->file);
    for (size_t i = 0; i < j->lens.count; i++)
        if (surface_is_level_set(j->element[i].surface))
            note("--%s: element %zu (%s) is not drawn, because it is a level set",
                 p->file ? "picture" : "svg", i + 1, j->lens.surface[i].type);
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
    if (!pictures_wanted(p)) return;
    scene_finish(s);
    if (edge_on(s)) note("--plane xz: all rays lie in the plane x = 0; --cross N sends some in x, too");
    if (p->svg) picture_write(p->svg, PICTURE_SVG, s);
    if (p->file) picture_write(p->file, p->kind, s);
}
