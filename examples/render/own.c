/* own.c - the table of this program's own surfaces. */
#include "own.h"

static sgt_objection object_to_edge(const void *self)
{
    const edge *s = self;
    if (!(s->radius > 0)) return (sgt_objection){"radius", "must be above 0"};
    if (!(s->from < s->to)) return (sgt_objection){"to", "must be above from"};
    return (sgt_objection){NULL, NULL};
}

static const sgt_param bulb_params[] = {
    {"iterations", "1", offsetof(mandelbulb, iterations), 1, 1, BULB_MOST_ITERATIONS, SGT_WHOLE},
    {"escape", "1", offsetof(mandelbulb, escape), 1, 1.2, 100, SGT_REAL},
    {0}};
static const sgt_param edge_params[] = {{"radius", "length", offsetof(edge, radius), 1, 0, 1e6, SGT_REAL},
                                        {"from", "length", offsetof(edge, from), 1, -1e6, 1e6, SGT_REAL},
                                        {"to", "length", offsetof(edge, to), 1, -1e6, 1e6, SGT_REAL},
                                        {0}};

const sgt_builtin own_surfaces[] = {
    {"mandelbulb", &mandelbulb_ops, sizeof(mandelbulb), bulb_params, NULL, NULL},
    {"edge", &edge_ops, sizeof(edge), edge_params, object_to_edge, NULL},
    {0},
};
