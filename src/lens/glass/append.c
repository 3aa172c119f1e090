// SPDX-License-Identifier: MIT
/* append.c - a glass that was read, into its catalogue. */
#include "forms.h"

#include <stdint.h>
#include <string.h>

static bool more_room(sgt_catalogue *c)
{
    if (c->count < c->room) return true;
    size_t room = c->room ? 2 * c->room : 64;
    if (room > SIZE_MAX / sizeof *c->glass / 2) return false;
    const sgt_allocator *a = &c->arena.allocator;
    sgt_glass *glass = a->resize(a->context, c->glass, room * sizeof *glass);
    if (glass) c->glass = glass;
    unsigned *addition = a->resize(a->context, c->addition, room * sizeof *addition);
    if (addition) c->addition = addition;
    if (!glass || !addition) return false;
    c->room = room;
    return true;
}

static const char *kept(sgt_catalogue *c, const char *text)
{
    return text ? sgt_arena_text(&c->arena, text, strlen(text)) : NULL;
}

bool sgt_reader_append(const reader *r, sgt_glass g, const char *key)
{
    sgt_catalogue *c = r->catalogue;
    const char *fault = sgt_glass_fault(&g);
    if (fault) return sgt_reader_fail(r, r->line, key, "glass %.60s: %s", g.name, fault);
    double *coefficient = sgt_arena_take(&c->arena, g.count * sizeof *coefficient);
    if (coefficient) memcpy(coefficient, g.coefficient, g.count * sizeof *coefficient);
    const char *name = kept(c, g.name), *maker = kept(c, g.maker), *remark = kept(c, g.remark);
    if (!coefficient || !name || !maker || (g.remark && !remark) || !more_room(c))
        return sgt_reader_fail(r, r->line, key, "no memory");
    g.name = name, g.maker = maker, g.remark = remark, g.coefficient = coefficient;
    g.file = r->file;
    c->addition[c->count] = c->additions;
    c->glass[c->count++] = g;
    return true;
}
