// SPDX-License-Identifier: MIT
/* zmx_surface.c - the records of a surface in a .zmx file.
 *
 * What is kept of them is in zmx_surface (zmx.h), with the lines where it stands; zmx_elements.c says what
 * shapes, media and breaks they are.
 *
 * A GLASS is a name, a status, a surface and numbers.  The numbers are those of the glass only with status 1,
 * a model; with any other they may be left over from another glass, or be 1.5 and 40.  Status 2 is a pickup,
 * 3 a glass that may be substituted; 0 is a glass as it stands.
 *
 * A TILT OR DECENTER of a surface (SCBD) is a coordinate break, the surface, and another break before its
 * thickness (OpticStudio's help, Tilt/Decenter). */
#include "zmx.h"

#include <math.h>

/* From here on a thickness is infinite, as in OpticStudio's editor. */
static const double FAR_AWAY = 1e10;

static zmx_surface *current(const zmx *z) { return &z->surface[z->count - 1]; }

static void read_surf(zmx *z)
{
    static const char standard[] = "STANDARD"; /* what a surface is without TYPE */
    size_t n = sgt_zmx_whole(z);
    if (n != z->count)
        tree_fail(z->s, z->lines.line, "SURF", "surface %zu is where surface %zu should be", n, z->count);
    z->surface = tree_grow(z->s, z->surface, z->count, &z->room, sizeof *z->surface);
    z->surface[z->count++] =
        (zmx_surface){.line = z->lines.line, .type = sgt_zmx_type((piece){standard, standard + 8})};
}

static void read_type(zmx *z)
{
    piece name = sgt_zmx_needed(z);
    const char *why = sgt_zmx_refused(name);
    current(z)->type = sgt_zmx_type(name);
    if (!current(z)->type)
        tree_fail(z->s, z->lines.line, "TYPE", "surface %zu is of the type %.*s, which is not read%s%s",
                  z->count - 1, sgt_reader_width(name), name.begin, why ? ": " : "", why ? why : "");
    if (z->count == 1 && !sgt_reader_is(name, "STANDARD") && !sgt_reader_is(name, "TILTSURF"))
        tree_fail(z->s, z->lines.line, "TYPE",
                  "surface 0, the object, is of the type %.*s, which is not read", sgt_reader_width(name),
                  name.begin);
}

static void read_comment(zmx *z)
{
    const char *comment = sgt_zmx_text(z);
    if (comment) current(z)->comment = comment, current(z)->comment_line = z->lines.line;
}

static void read_stop(zmx *z)
{
    if (z->stop_line)
        tree_fail(z->s, z->lines.line, "STOP", "surface %zu is a second stop, after that in line %zu",
                  z->count - 1, z->stop_line);
    if (z->count == 1) tree_fail(z->s, z->lines.line, "STOP", "surface 0, the object, cannot be the stop");
    z->stop = z->count - 1, z->stop_line = z->lines.line;
}

/* What a record picks up: from scale offset column; another column than its own is not followed. */
static void read_pick(zmx *z, zmx_picked what, size_t parm)
{
    zmx_surface *f = current(z);
    const double from = sgt_zmx_number_or(z, -1);
    zmx_pick p = {.what = what, .parm = parm, .line = z->lines.line, .key = z->row->key};
    p.scale = sgt_zmx_number_or(z, 1), p.offset = sgt_zmx_number_or(z, 0);
    if (!(from >= 0 && from < (double)z->count) || from != floor(from) || sgt_zmx_number_or(z, 0) != 0) {
        sgt_zmx_tally(z, ZMX_SOLVES, p.line, p.key);
        return;
    }
    p.from = (size_t)from;
    f->pick = tree_grow(z->s, f->pick, f->picks, &f->pick_room, sizeof *f->pick);
    f->pick[f->picks++] = p;
}

/* CURV c solve ...: solves 0 and 1 are a fixed number and a variable, 4 is a pickup: from scale. */
static void read_curvature(zmx *z)
{
    current(z)->curvature = sgt_zmx_number(z), current(z)->curvature_line = z->lines.line;
    const double how = sgt_zmx_number_or(z, 0);
    if (how == 4) read_pick(z, ZMX_PICK_CURVATURE, 0);
    else if (how > 1) sgt_zmx_tally(z, ZMX_SOLVES, z->lines.line, "CURV");
}

/* MAZH height zone: where the marginal ray of a zone of the pupil has a height.  Height 0 of zone 0, the
 * paraxial one, is the paraxial focus. */
static void read_marginal(zmx *z)
{
    if (sgt_zmx_number_or(z, 1) == 0 && sgt_zmx_number_or(z, 0) == 0) current(z)->focus_line = z->lines.line;
    else sgt_zmx_tally(z, ZMX_SOLVES, z->lines.line, "MAZH");
}

static void read_thickness_pickup(zmx *z) { read_pick(z, ZMX_PICK_THICKNESS, 0); }

/* PPAR parm from scale offset column */
static void read_parm_pickup(zmx *z)
{
    const double parm = sgt_zmx_number_or(z, 0);
    if (parm >= 1 && parm <= ZMX_PARMS && parm == floor(parm)) read_pick(z, ZMX_PICK_PARM, (size_t)parm);
    else sgt_zmx_tally(z, ZMX_SOLVES, z->lines.line, "PPAR");
}

/* INFINITY, in either case of letters and with a sign. */
static bool infinite(piece word)
{
    static const char infinity[] = "INFINITY";
    if (word.begin < word.end && (*word.begin == '-' || *word.begin == '+')) word.begin++;
    if ((size_t)(word.end - word.begin) != sizeof infinity - 1) return false;
    for (size_t i = 0; i < sizeof infinity - 1; i++)
        if ((word.begin[i] & ~0x20) != infinity[i]) return false;
    return true;
}

static void read_thickness(zmx *z)
{
    piece word = sgt_zmx_needed(z);
    double t = infinite(word) ? (double)INFINITY : sgt_zmx_number_in(z, word);
    current(z)->thickness = fabs(t) >= FAR_AWAY ? (double)INFINITY : t;
    current(z)->thickness_line = z->lines.line;
}

static void read_conic(zmx *z)
{
    current(z)->conic = sgt_zmx_number(z), current(z)->conic_line = z->lines.line;
}
static void read_size(zmx *z) { current(z)->size = sgt_zmx_number(z), current(z)->size_line = z->lines.line; }

static void append_extra(zmx *z, size_t i, double x)
{
    enum { MOST = 1000 };
    zmx_surface *f = current(z);
    if (i < 1 || i > MOST) tree_fail(z->s, z->lines.line, z->row->key, "there is no XDAT %zu", i);
    f->extra = tree_grow(z->s, f->extra, f->extras, &f->extra_room, sizeof *f->extra);
    f->extra[f->extras++] = (zmx_extra){i, z->lines.line, x};
}

static void read_extra(zmx *z)
{
    size_t i = sgt_zmx_whole(z);
    append_extra(z, i, sgt_zmx_number(z));
}

/* PARM 12 + i is XDAT i. */
static void read_parm(zmx *z)
{
    zmx_surface *f = current(z);
    size_t i = sgt_zmx_whole(z);
    double x = sgt_zmx_number(z);
    if (i > ZMX_PARMS) {
        append_extra(z, i - ZMX_PARMS, x);
        return;
    }
    if (f->parms_given >> i & 1)
        tree_fail(z->s, z->lines.line, "PARM", "a second PARM %zu of this surface", i);
    f->parms_given |= 1u << i;
    f->parm[i] = x + 0, f->parm_line = z->lines.line; /* -0 becomes 0 */
}

/* GDAT columns rows step_x step_y x y: where the middle of the grid is. */
static void read_grid(zmx *z)
{
    enum { FEWEST = 4, MOST = 4096 };
    zmx_grid *g = &current(z)->grid;
    g->line = z->lines.line;
    g->columns = sgt_zmx_whole(z), g->rows = sgt_zmx_whole(z);
    for (int i = 0; i < 2; i++) g->step[i] = sgt_zmx_number(z);
    if (g->columns < FEWEST || g->columns > MOST || g->rows < FEWEST || g->rows > MOST)
        tree_fail(z->s, g->line, "GDAT", "a grid of %zu x %zu is not between %d x %d and %d x %d", g->columns,
                  g->rows, (int)FEWEST, (int)FEWEST, (int)MOST, (int)MOST);
    if (!(g->step[0] > 0 && g->step[1] > 0))
        tree_fail(z->s, g->line, "GDAT", "steps of %g and %g; both must be above 0", g->step[0], g->step[1]);
    if (sgt_zmx_number_or(z, 0) != 0 || sgt_zmx_number_or(z, 0) != 0)
        tree_fail(z->s, g->line, "GDAT", "surface %zu: a grid beside the vertex is not read", z->count - 1);
}

/* GARR i height slopes ... hole: in their order. */
static void read_height(zmx *z)
{
    zmx_grid *g = &current(z)->grid;
    const size_t i = sgt_zmx_whole(z);
    const double height = sgt_zmx_number(z);
    if (!g->line || i != g->count || i >= g->columns * g->rows)
        tree_fail(z->s, z->lines.line, "GARR",
                  "height %zu is where height %zu should be, of %zu x %zu (GDAT)", i, g->count, g->columns,
                  g->rows);
    for (int k = 0; k < 3; k++) sgt_zmx_number_or(z, 0);
    if (sgt_zmx_number_or(z, 0) != 0)
        tree_fail(z->s, z->lines.line, "GARR", "a grid with a hole (height %zu) is not read", i);
    g->height = tree_grow(z->s, g->height, g->count, &g->room, sizeof *g->height);
    g->height[g->count++] = height;
}

/* Where the name of a glass ends: before a status, 0 ... 9, and another number or the end of the line.  So
 * a name may have blanks in it. */
static piece glass_name(zmx *z)
{
    piece name = sgt_zmx_needed(z);
    for (;;) {
        piece after = z->rest, word = sgt_reader_word(&after), next = sgt_reader_word(&after);
        double x;
        if (word.begin == word.end) return name;
        if (word.end - word.begin == 1 && *word.begin >= '0' && *word.begin <= '9' &&
            (next.begin == next.end || sgt_reader_number(next, &x)))
            return name;
        name.end = word.end, z->rest.begin = word.end;
    }
}

/* A glass by its name: status 0, and 3, one that may be substituted. */
static void named_glass(zmx *z, zmx_glass *g, piece name)
{
    if (sgt_reader_is(name, "___BLANK"))
        tree_fail(z->s, g->line, "GLAS", "surface %zu: ___BLANK is the name of no glass", z->count - 1);
    if (sgt_reader_is(name, "MIRROR"))
        g->medium = ZMX_MIRROR;
    else if (!sgt_reader_is(name, "AIR"))
        g->medium = ZMX_GLASS, g->name = sgt_zmx_copy(z, name);
}

/* GLAS name status pickup nd vd dPgF ...: the numbers are those of the glass with status 1 only; with the
 * others they may be left from another glass. */
static void read_glass(zmx *z)
{
    zmx_glass g = {.line = z->lines.line};
    piece name = glass_name(z);
    size_t status = sgt_zmx_whole_or(z, 0);
    if (status == 1) {
        sgt_zmx_field(z);
        g.medium = ZMX_MODEL, g.nd = sgt_zmx_number(z);
        g.vd = sgt_zmx_number_or(z, 0), g.dPgF = sgt_zmx_number_or(z, 0);
        sgt_zmx_tally(z, ZMX_MODELS, g.line, "GLAS");
    } else if (status == 2) {
        g.medium = ZMX_PICKUP, g.from = sgt_zmx_whole(z);
    } else if (status == 0 || status == 3) {
        named_glass(z, &g, name);
    } else {
        tree_fail(z->s, g.line, "GLAS", "surface %zu: a glass of the status %zu is not read", z->count - 1,
                  status);
    }
    current(z)->glass = g;
}

/* CLAP a b from: from a surface whose aperture it copies; 0: none. */
static void read_aperture(zmx *z)
{
    zmx_aperture *a = &current(z)->aperture;
    if (a->key)
        tree_fail(z->s, z->lines.line, z->row->key,
                  "surface %zu has a second aperture, after that in line %zu", z->count - 1, a->line);
    a->key = z->row->key, a->line = z->lines.line;
    a->a = sgt_zmx_number(z), a->b = sgt_zmx_number(z);
    if (sgt_zmx_number_or(z, 0) != 0) sgt_zmx_tally(z, ZMX_SOLVES, a->line, a->key);
}

static void read_offset(zmx *z)
{
    zmx_aperture *a = &current(z)->aperture;
    a->offset[0] = sgt_zmx_number(z), a->offset[1] = sgt_zmx_number(z);
}

/* SCBD when order mode x y a b c: when is 1 before the surface, 2 behind it, 3 a coordinate return. */
static void read_tilt(zmx *z)
{
    zmx_break b = {.line = z->lines.line};
    size_t when = sgt_zmx_whole(z);
    if (when == 3) {
        sgt_zmx_tally(z, ZMX_RETURNS, z->lines.line, "SCBD");
        return;
    }
    if (when != 1 && when != 2) tree_fail(z->s, b.line, "SCBD", "field 1: %zu is not 1, 2 or 3", when);
    b.tilt_first = sgt_zmx_number(z) != 0;
    sgt_zmx_number(z); /* where the numbers came from */
    double *to[] = {&b.decenter[0], &b.decenter[1], &b.tilt[0], &b.tilt[1], &b.tilt[2]};
    bool moves = false;
    for (size_t i = 0; i < sizeof to / sizeof *to; i++) {
        *to[i] = sgt_zmx_number(z);
        moves = moves || *to[i] != 0;
    }
    if (!moves) return;
    zmx_break **at = when == 1 ? &current(z)->before : &current(z)->behind;
    if (*at) tree_fail(z->s, b.line, "SCBD", "a second SCBD %zu of surface %zu", when, z->count - 1);
    *at = tree_room(z->s, 1, sizeof **at);
    **at = b;
    sgt_zmx_tally(z, ZMX_SCBD, b.line, "SCBD");
}

/* --------------------------------------------------------------- the table */

static const zmx_record surface_rows[] = {
    /* the most frequent first */
    {"SURF", ZMX_OPEN, read_surf, 0},
    {"CURV", ZMX_ONCE, read_curvature, 0},
    {"DISZ", ZMX_LOOSE, read_thickness, 0},
    {"DIAM", ZMX_ONCE, read_size, 0},
    {"TYPE", ZMX_ONCE, read_type, 0},
    {"PARM", ZMX_MANY, read_parm, 0},
    {"GLAS", ZMX_ONCE, read_glass, 0},
    {"CONI", ZMX_ONCE, read_conic, 0},
    {"GARR", ZMX_MANY, read_height, 0},
    {"GDAT", ZMX_ONCE, read_grid, 0},
    {"XDAT", ZMX_MANY, read_extra, 0},
    {"COMM", ZMX_LOOSE, read_comment, 0},
    {"STOP", ZMX_ONCE, read_stop, 0},
    {"SCBD", ZMX_MANY, read_tilt, 0},
    {"CLAP", ZMX_MANY, read_aperture, 0},
    {"OBSC", ZMX_MANY, read_aperture, 0},
    {"SQAP", ZMX_MANY, read_aperture, 0},
    {"ELAP", ZMX_MANY, read_aperture, 0},
    {"FLAP", ZMX_MANY, read_aperture, 0},
    {"OBDC", ZMX_ONCE, read_offset, 0},
    {"SQOB", ZMX_LEFT, NULL, 0}, /* obscurations, spiders, apertures of the user */
    {"ELOB", ZMX_LEFT, NULL, 0},
    {"SPID", ZMX_LEFT, NULL, 0},
    {"UDAD", ZMX_LEFT, NULL, 0},
    {"COAT", ZMX_LEFT, NULL, 0},
    {"MAZH", ZMX_FREE, read_marginal, 0},
    {"CHZH", ZMX_SOLVE, NULL, 0},
    {"EDGE", ZMX_SOLVE, NULL, 0},
    {"PZUP", ZMX_FREE, read_thickness_pickup, 0},
    {"PKUP", ZMX_SOLVE, NULL, 0},
    {"PPAR", ZMX_FREE, read_parm_pickup, 0},
};

_Static_assert(sizeof surface_rows / sizeof *surface_rows <= (size_t)ZMX_RECORDS, "zmx counts them");

/* Drawings, substrates of mirrors (MIRR), mechanical semi-diameters (MEMA), physical optics (POPS), variables
 * (VPAR, VDSZ), thermal expansion (TCED). */
const zmx_table sgt_zmx_surface_records = {sizeof surface_rows / sizeof *surface_rows, surface_rows,
                                           "FIMP HIDE MIRR SLAB MEMA POPS SSID VPAR VDSZ TCED "};
