/* fuzz_lens.c - bytes as a lens file, and as a surface given on the command line.
 *
 * What is accepted is finite and legal: a lens of it can be traced, and no surface of it is SGT_INVALID.
 * What is refused is refused in words that name a line of the text.  A grid's file is a part of the input
 * (tool.h). */
#include "tool.h"

#include "../../src/tool/read/lens.h"
#include "../../src/tool/read/surface.h"

static const char SOURCE[] = "text";

static void require_surface(sgt_surface s, const char *type, double size)
{
    const sgt_builtin *b = sgt_builtins;
    while (b->type && strcmp(b->type, type) != 0) b++;
    REQUIRE(b->type && b->ops == s.ops, "%s", type);
    for (const sgt_param *p = b->params; p->name; p++) {
        const void *at = (const char *)s.self + p->offset;
        const sgt_numbers *table = at;
        const double *x = at;
        size_t count = (size_t)p->count;
        double whole;
        if (p->kind == SGT_TERMS) {
            size_t terms;
            memcpy(&terms, (const char *)at + sizeof(sgt_surface *), sizeof terms);
            REQUIRE(terms <= count, "%s: %zu terms", type, terms);
            continue;
        }
        if (p->kind == SGT_LIST || p->kind == SGT_TABLE) {
            REQUIRE((table->rows <= count || p->kind == SGT_LIST) && table->columns <= count &&
                        (!table->rows || table->x),
                    "%s: %s: %zu rows, %zu columns", type, p->name, table->rows, table->columns);
            x = table->x, count = table->rows * table->columns;
        } else if (p->kind != SGT_REAL && p->kind != SGT_VECTOR) {
            whole = *(const int *)at, x = &whole;
        }
        for (size_t i = 0; i < count; i++)
            REQUIRE(isfinite(x[i]) && (x[i] == 0 || (x[i] >= p->lo && x[i] <= p->hi)), "%s: %s[%zu] = %a",
                    type, p->name, i, x[i]);
    }
    if (b->object)
        REQUIRE(!b->object(s.self).reason, "%s: %s: %s", type, b->object(s.self).param,
                b->object(s.self).reason);
    sgt_hit hit = sgt_intersect(s, (sgt_ray){{0, size, -1}, {0, 0.1, 1}, 0, 0},
                                &(sgt_options){.max_evals = 50});
    REQUIRE(hit.status != SGT_INVALID, "%s", type);
}

/* "text:LINE: what is wrong". */
static void require_message(const uint8_t *data, size_t size)
{
    if (status == EXIT_USAGE) return; /* a wavelength that the lens does not have */
    REQUIRE(status == EXIT_BAD_INPUT && message_length > 0, "status %d", (int)status);
    REQUIRE(message_length < 1500, "a message of %d characters", message_length);
    REQUIRE(strncmp(message, "text:", 5) == 0, "\"%s\"", message);
    char *end;
    unsigned long line = strtoul(message + 5, &end, 10);
    REQUIRE(line >= 1 && line <= lines_of(data, size), "line %lu of %zu: \"%s\"", line, lines_of(data, size),
            message);
    if (strcmp(end, ": control characters are not allowed") == 0) {
        size_t before = 1, i = 0;
        while (i < size && (data[i] >= 32 || data[i] == '\n' || data[i] == '\t') && data[i] < 127)
            before += data[i++] == '\n';
        REQUIRE(i == size || data[i] >= 127 || data[i] == '\r' || line == before, "line %zu: \"%s\"", before,
                message);
    }
    REQUIRE(end[0] == ':' && end[1] == ' ' && end[2], "\"%s\"", message);
}

static void require_lens(const lens *l)
{
    REQUIRE(l->name && l->units && l->wavelengths >= 1 && l->count >= 1 && l->fields >= 1, "%zu surfaces",
            l->count);
    REQUIRE(isnan(l->wavelength) || (l->wavelength > 0 && isfinite(l->wavelength)), "%a", l->wavelength);
    REQUIRE(l->object_distance > 0 && l->object_index > 0 && isfinite(l->object_index), "%a %a",
            l->object_distance, l->object_index);
    REQUIRE(isnan(l->pupil_semi_diameter) || (l->pupil_semi_diameter > 0 && isfinite(l->pupil_semi_diameter)),
            "%a", l->pupil_semi_diameter);
    REQUIRE(!isinf(l->pupil_distance), "%a", l->pupil_distance);
    for (size_t i = 0; i < l->fields; i++) REQUIRE(fabs(l->field[i]) < 90, "%a", l->field[i]);
    REQUIRE(l->stop < l->count, "stop %zu", l->stop);
    double before = l->object_index;
    for (size_t i = 0; i < l->count; i++) {
        const sgt_element *e = &l->element[i];
        const lens_surface *s = &l->surface[i];
        const sgt_pose *p = &e->pose;
        const double place[] = {p->origin.x, p->origin.y, p->origin.z, p->ex.x,          p->ex.y,
                                p->ex.z,     p->ey.x,     p->ey.y,     p->ey.z,          p->ez.x,
                                p->ez.y,     p->ez.z,     s->z,        e->semi_diameter, s->index};
        for (size_t j = 0; j < COUNT_OF(place); j++)
            REQUIRE(isfinite(place[j]), "element %zu: %zu: %a", i, j, place[j]);
        double turn = p->ex.x * p->ex.x + p->ex.y * p->ex.y + p->ex.z * p->ex.z;
        REQUIRE(turn == 0 || fabs(turn - 1) < 1e-14, "element %zu: an axis of length^2 %a", i, turn);
        REQUIRE(e->semi_diameter >= 0 && s->index > 0, "element %zu: %a %a", i, e->semi_diameter, s->index);
        REQUIRE(s->mirror ? e->index == SGT_MIRROR && s->index == before : e->index == s->index,
                "element %zu: index %a", i, e->index);
        before = s->index;
        require_surface(e->surface, s->type, e->semi_diameter);
    }
    sgt_ray ray = {.d = {0, 0.01, 1}};
    sgt_passage met[4];
    size_t n = l->count < 4 ? l->count : 4, passed = sgt_trace(n, l->element, l->object_index, &ray, met,
                                                               NULL, &(sgt_options){.max_evals = 50});
    for (size_t i = 0; i < n && i <= passed; i++)
        REQUIRE(met[i].hit.status != SGT_INVALID || i > 0, "element %zu", i);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static lens l;
    volatile size_t wavelength = 1, wavelengths = 1;
    size = split(data, size);
    do {
        read_anew(data, size);
        if (setjmp(refused) == 0) {
            l = lens_read(SOURCE, wavelength);
            wavelengths = l.wavelengths;
            require_lens(&l);
        } else {
            require_message(data, size);
            REQUIRE(status != EXIT_USAGE, "wavelength %zu of %zu", (size_t)wavelength, (size_t)wavelengths);
        }
    } while (wavelength < 3 && ++wavelength <= wavelengths);

    read_anew(data, size);
    if (setjmp(refused) == 0) {
        char *text = memory_text((const char *)data, size);
        sgt_surface s = surface_parse(SOURCE, text);
        const sgt_builtin *b = sgt_builtins;
        while (b->type && b->ops != s.ops) b++;
        REQUIRE(b->type, "a surface of the table");
        while (b[1].ops == s.ops) b++; /* of the types that share it the one with most parameters */
        require_surface(s, b->type, 0.1);
    } else {
        require_message(data, size);
    }
    free_all();
    return 0;
}
