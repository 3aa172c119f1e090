// SPDX-License-Identifier: MIT
/* study.h (of the room) - a study that is being asked: its fields, wavelengths and points, and their rays in
 * blocks. */
#ifndef SGT_STUDY_STUDY_H
#define SGT_STUDY_STUDY_H
#include "../base/arena.h"
#include "../optics/launch.h"
#include "../optics/pattern.h"

#include <sagitta/study.h>

struct sgt_study {
    sgt_study_options opt;
    const sgt_lens *lens;
    sgt_launcher *from;
    double um;                  /* the unit of length in micrometres; NaN: not known */
    bool rms_alone;             /* of a row rms and means alone are read: no errors, no coarse points */
};

/* The lens at a wavelength. */
typedef struct band {
    sgt_wavelength at;          /* number 0: none of the lens */
    double weight, before;
    sgt_element *element;
    sgt_first_order data;
} band;

typedef struct kept_map kept_map; /* pass.c */

/* What asking needs; an analysis reads all of it. */
struct sgt_asking {
    const sgt_study *study;
    const sgt_lens *lens;
    const sgt_launcher *from;
    const sgt_analysis *of;
    const void *options;
    const sgt_sink *sink;
    sgt_error *error;
    arena memory;               /* freed when all is answered */
    size_t bands;
    band *band;                 /* [bands] */
    band primary;
    size_t fields;
    sgt_field_kind kind;
    const sgt_lens_field *at;   /* [fields] */
    size_t *number;             /* [fields] from 1 */
    bool of_lens;               /* these are numbers of fields of the lens */
    sgt_field_beam *beam;       /* [fields] */
    sgt_pupil fine, coarse;     /* the points; with half as many rays across, if that can be */
    size_t kept_maps;           /* of aims, [fields * bands] at most */
    kept_map *kept_map;
    bool counts;                /* fates of what is traced now are counted */
    sgt_study_total total;
    bool failed;
};

/* Sets bands, primary and fields; the points of the pupil.  false: failed, as *error says. */
bool sgt_ask_begin(sgt_asking *a);
bool sgt_ask_pupil(sgt_asking *a);

/* Memory until all is answered, zeroed; NULL: none, and the asking has failed. */
void *sgt_ask_room(sgt_asking *a, size_t count, size_t size);

/* Fills in the error; false. */
bool sgt_ask_fail(sgt_asking *a, const char *key, const char *words, ...) SGT_LAUNCH_PRINTF(3, 4);

/* The same of a setting of the analysis, or of "rays": no key of the file is to blame. */
bool sgt_ask_refuse(sgt_asking *a, const char *setting, const char *words, ...) SGT_LAUNCH_PRINTF(3, 4);

void sgt_ask_row(const sgt_asking *a, const void *row);
void sgt_ask_say(const sgt_asking *a, sgt_remark_of_study kind, const char *words, ...)
    SGT_LAUNCH_PRINTF(3, 4);

/* The unit of lengths in a sentence. */
const char *sgt_ask_units(const sgt_asking *a);

/* The field of the study that is farthest from the axis. */
const sgt_lens_field *sgt_ask_farthest(const sgt_asking *a);

/* A copy of the elements of a band with the last one moved by z along its own z. */
sgt_element *sgt_ask_moved(sgt_asking *a, const band *b, double z);

/* The ends of the chief rays at the primary wavelength: [fields * surfaces], with element[s] those of image
 * surface s.  NULL: failed. */
sgt_ray_end *sgt_ask_chiefs(sgt_asking *a, size_t surfaces, sgt_element *const element[]);

/* Calls work(data, i, slot) for i < tasks in any thread, and take(data, i, slot) in order, in the thread that
 * asks.  work: false is a failure for want of memory.  slot: `size` bytes, which are not cleared.  What is
 * taken may be taken while later tasks are worked on: so work reads nothing that take writes.
 *
 *     prepare    NULL, or called in the thread that asks, before tasks first, first + 1, ... are worked on;
 *                false: it failed, and has said so */
typedef struct rounds {
    size_t first, tasks, size;  /* tasks first ... first + tasks - 1 */
    void *data;
    bool (*prepare)(void *data, size_t first, size_t tasks);
    bool (*work)(void *data, size_t i, void *slot);
    void (*take)(void *data, size_t i, void *slot);
} rounds;
bool sgt_ask_rounds(sgt_asking *a, const rounds *r);
enum { ROUND = 64, ROUND_MOST = 1024, ROUND_BYTES = 1 << 18 }; /* how many tasks go at once (study.c) */

/* (shard.c) For a study of one share, or one that joins them.  How many shares a pass of so many tasks has,
 * and the first task of a share; what is said at the beginning of each share of a pass, so that who joins
 * notices parts that are not of this study: it is written (k of 0), or read of share k and compared; bytes
 * that are written, or read of share k.  false: it failed, and has said so. */
typedef struct sgt_shard_of_pass { uint64_t cells, blocks, size; } sgt_shard_of_pass;
size_t sgt_shard_shares(const sgt_asking *a, size_t tasks);
size_t sgt_shard_begin(size_t tasks, size_t k, size_t of);
bool   sgt_shard_head(sgt_asking *a, size_t k, sgt_shard_of_pass head);
bool   sgt_shard_put(sgt_asking *a, size_t size, const void *bytes);
bool   sgt_shard_get(sgt_asking *a, size_t k, size_t size, void *bytes);
bool   sgt_shard_wrong(sgt_asking *a, size_t k);

/* (shard.c) sgt_ask_rounds, of which a shard works on some tasks; who joins has their slots from it. */
bool sgt_shard_rounds(sgt_asking *a, const rounds *r);

/* Is this one of several programs or shares, and does not join them?  Then nothing is told. */
static inline bool sgt_ask_shards(const sgt_asking *a)
{
    return a->study->opt.shard && a->study->opt.shard->number;
}

/* A pass: the rays of many cells, each a field at a wavelength, in blocks of PUPIL_PART points.
 *
 *     place   which beam and which elements: in any thread; false: failed, with a fault in *fault
 *     block   in any thread: what is made of the rays of a block, in `sum`, `size` bytes, zeroed
 *     merge   NULL, or adds one such sum to another.  Then sums are merged in a tree of the blocks' numbers
 *             (`exact`: in any order), and `end` gets that of the cell; `take` gets the first `shown` blocks
 *             of each cell
 *     take    in order: of each block, with what `block` made
 *     end     in order: a cell is done, with the fates of its rays */
typedef struct cell {
    const sgt_field_beam *beam;
    const sgt_element *element;
    double before;
    sgt_field_beam own;         /* room for a beam that is made for this cell */
} cell;

typedef struct pass {
    sgt_asking *ask;
    const sgt_pupil *points;
    size_t cells, size, spare;  /* spare: bytes behind the sum for `block`, which are not cleared */
    unsigned wanted;            /* of an end (launch.h): END_POINT, ...; the others are not worked out */
    bool takes_ends;            /* they are kept for `take`, which else gets NULL */
    bool before;                /* later passes depend on it */
    bool alone;                 /* only what came before tells whether it is needed: who joins traces it */
    bool exact;                 /* `merge` does not round */
    size_t shown;
    void *data;
    bool (*place)(const struct pass *p, size_t i, cell *out, sgt_error *fault);
    void (*block)(const struct pass *p, size_t i, size_t count, sgt_ray_end end[], void *sum);
    void (*take)(const struct pass *p, size_t i, size_t count, const sgt_ray_end end[], const void *sum);
    void (*merge)(const void *p, void *into, const void *more);
    void (*end)(const struct pass *p, size_t i, const sgt_fates *fates, void *sum);
    /* Of a cell whose ray was lost: what the study knows of it, to be filled in. */
    void (*lost)(const struct pass *p, size_t i, sgt_lost_ray *out);
} pass;
bool sgt_ask_pass(const pass *p);

/* For cells field * bands + band of the study: place and lost. */
bool sgt_place_study(const pass *p, size_t i, cell *out, sgt_error *fault);
void sgt_lost_study(const pass *p, size_t i, sgt_lost_ray *out);

void sgt_fates_count(sgt_fates *f, const sgt_ray_end *end);
void sgt_fates_add(sgt_fates *f, const sgt_fates *more);
sgt_fate_counts sgt_fates_row(const sgt_fates *f);
int  sgt_fate_of(const sgt_ray_end *end);

/* In an analysis: its rows and their columns, the struct of its options, and the settings. */
#define ROWS_OF(type, table)                                                                \
    .row_size = sizeof(type), .columns = sizeof(table) / sizeof *(table), .column = (table)
#define OPTIONS_OF(type) .options_size = sizeof(type), .options_room = offsetof(type, reserved_)
#define SETTINGS_OF(table) .settings = sizeof(table) / sizeof *(table), .setting = (table)

/* The columns that several analyses have. */
#define COLUMN_FIELD(row)                                                                                    \
    {.name = "field", SGT_COLUMN_COUNT, SGT_UNIT_NONE, SGT_COLUMN_GROUPS, offsetof(row, field), 0,           \
     "the field, counted from 1"}
#define COLUMN_WAVELENGTH(row, flags)                                                                        \
    {.name = "wavelength", SGT_COLUMN_WAVELENGTH, SGT_UNIT_MICROMETRE, flags, offsetof(row, wavelength), 0,  \
     "micrometres; all: together, as the lens weighs them"}
#define COLUMN_PUPIL(row, x, y)                                                                              \
    {.name = "px", SGT_COLUMN_NUMBER, SGT_UNIT_PUPIL, 0, offsetof(row, x), 0, "the point of the pupil,"},    \
    {.name = "py", SGT_COLUMN_NUMBER, SGT_UNIT_PUPIL, 0, offsetof(row, y), 0, "in radii of it"}
#define COLUMN_OF_FATE(row)                                                                                  \
    {.name = "fate", SGT_COLUMN_FATE, SGT_UNIT_NONE, 0, offsetof(row, fate), 0,                              \
     "passed; missed, clipped, tir, evanescent, lost; none: proven, no such ray"}
#define COLUMN_FATES(row)                                                                                    \
    {.name = "missed", SGT_COLUMN_COUNT, SGT_UNIT_NONE, SGT_COLUMN_DETAIL, offsetof(row, fates.missed), 0,   \
     "what became of"},                                                                                      \
    {.name = "clipped", SGT_COLUMN_COUNT, SGT_UNIT_NONE, SGT_COLUMN_DETAIL, offsetof(row, fates.clipped), 0, \
     "the other rays"},                                                                                      \
    {.name = "tir", SGT_COLUMN_COUNT, SGT_UNIT_NONE, SGT_COLUMN_DETAIL, offsetof(row, fates.tir), 0,         \
     "totally reflected"},                                                                                   \
    {.name = "evanescent", SGT_COLUMN_COUNT, SGT_UNIT_NONE, SGT_COLUMN_DETAIL,                               \
     offsetof(row, fates.evanescent), 0, "the order of a phase does not exist for them"},                    \
    {.name = "lost", SGT_COLUMN_COUNT, SGT_UNIT_NONE, SGT_COLUMN_DETAIL, offsetof(row, fates.lost), 0,       \
     "it could not be decided"},                                                                             \
    {.name = "none", SGT_COLUMN_COUNT, SGT_UNIT_NONE, SGT_COLUMN_DETAIL, offsetof(row, fates.none), 0,       \
     "proven: there is no such ray"},                                                                        \
    {.name = "proven", SGT_COLUMN_COUNT, SGT_UNIT_NONE, SGT_COLUMN_DETAIL | SGT_COLUMN_PROVEN,               \
     offsetof(row, fates.proven), 0, "passed, and proven at each surface"}

#endif
