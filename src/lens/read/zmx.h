// SPDX-License-Identifier: MIT
/* zmx.h - a .zmx file on its way into a tree: zmx.c tells the records apart, zmx_system.c and zmx_surface.c
 * read them by the fields of zmx_field.c, zmx_shape.c and zmx_elements.c make surfaces and breaks of them. */
#ifndef SGT_LENS_ZMX_H
#define SGT_LENS_ZMX_H
#include "../base/reader.h"
#include "tree.h"

/* ----------------------------------------------------------------- surfaces */

/* What is behind a surface. */
typedef enum zmx_medium { ZMX_AIR, ZMX_MIRROR, ZMX_GLASS, ZMX_MODEL, ZMX_PICKUP } zmx_medium;

typedef struct zmx_glass {
    zmx_medium medium;
    size_t line;
    const char *name;    /* ZMX_GLASS */
    size_t from;         /* ZMX_PICKUP: the surface it is taken from */
    bool picked;         /* it was one */
    double nd, vd, dPgF; /* ZMX_MODEL; vd 0: no dispersion */
} zmx_glass;

typedef struct zmx_break {
    size_t line;
    bool tilt_first;
    double decenter[2], tilt[3];
} zmx_break;

typedef struct zmx_aperture {
    const char *key; /* CLAP, OBSC, SQAP, ELAP or FLAP; NULL: none */
    size_t line;
    double a, b; /* radii from the inner one, or half widths */
    double offset[2];
} zmx_aperture;

typedef struct zmx_extra { size_t number, line; double value; } zmx_extra;

/* What is picked up from another surface: s x + o, and which number.  PARM: + i. */
typedef enum zmx_picked { ZMX_PICK_CURVATURE, ZMX_PICK_THICKNESS, ZMX_PICK_PARM } zmx_picked;
typedef struct zmx_pick {
    zmx_picked what;
    size_t parm, from, line;
    double scale, offset;
    const char *key;
} zmx_pick;

/* Heights on a grid, as GDAT and GARR give them; line 0: none. */
typedef struct zmx_grid {
    size_t line, columns, rows, count, room; /* count: of heights so far */
    double step[2], *height;
} zmx_grid;

typedef struct zmx_type zmx_type;

enum { ZMX_PARMS = 12 };

typedef struct zmx_surface {
    size_t line;
    const zmx_type *type; /* never NULL */
    const char *comment;  /* NULL: none */
    double curvature, conic, thickness, size;
    size_t curvature_line, conic_line, thickness_line, size_line, parm_line, comment_line;
    double parm[ZMX_PARMS + 1]; /* from 1 */
    unsigned parms_given;       /* bits */
    zmx_extra *extra;
    size_t extras, extra_room;
    zmx_glass glass;
    zmx_break *before, *behind; /* NULL: none */
    zmx_aperture aperture;
    zmx_grid grid;
    size_t focus_line;          /* of a solve for the paraxial focus; 0: none */
    zmx_pick *pick;
    size_t picks, pick_room;
    bool keeps_decenter, keeps_tilt; /* though all are 0: something picks them up */
    /* once it is written: its own map, that of its thickness, and their paths */
    node *map, *step;
    const char *path, *step_path;
} zmx_surface;

/* ------------------------------------------------------------------ records */

/* What becomes of a record.  SOLVE: its value is stored elsewhere.  LEFT: it is not imported.
 * The others are read: once for the system or for a surface (LOOSE: without an end of line,
 * too), or more often (FREE: without an end of line, too); OPEN begins a surface. */
typedef enum zmx_fate {
    ZMX_SOLVE, ZMX_LEFT, ZMX_ONCE, ZMX_LOOSE, ZMX_MANY, ZMX_FREE, ZMX_OPEN
} zmx_fate;

typedef struct zmx zmx;

typedef struct zmx_record {
    const char *key;
    zmx_fate fate;
    void (*read)(zmx *z);
    unsigned which; /* what the reader asks */
} zmx_record;

typedef struct zmx_table {
    size_t count; /* at most ZMX_RECORDS */
    const zmx_record *record;
    const char *idle; /* keywords of four characters that have no effect on rays */
} zmx_table;

extern const zmx_table sgt_zmx_surface_records, sgt_zmx_system_records;

/* Numbers of a record such as YFLN; line 0: there is none. */
typedef struct zmx_list { double *value; size_t count, room, line; } zmx_list;

typedef enum zmx_lists {
    ZMX_XFLN, ZMX_YFLN, ZMX_FWGN, ZMX_XFLD, ZMX_YFLD, ZMX_FWGT, /* the second three: older files */
    ZMX_WAVM, ZMX_WAVM_WEIGHT, ZMX_WAVN, ZMX_WWGN, ZMX_WAVL, ZMX_WWGT, /* here the last four */
    ZMX_VIGNETTING, ZMX_LISTS = ZMX_VIGNETTING + 10
} zmx_lists;

/* Remarks that are told once for each keyword, with how many there were. */
typedef enum zmx_tally {
    ZMX_BREAKS, ZMX_TILTED, ZMX_SCBD, ZMX_RETURNS, ZMX_SOLVES, ZMX_PICKUPS, ZMX_MODELS,
    ZMX_FLAP, ZMX_UNUSED, ZMX_BREAK_GLASS, ZMX_APERTURES, ZMX_VIGNETTED, ZMX_TALLIES
} zmx_tally;

typedef struct zmx_count { const char *key; size_t line, count; } zmx_count;

enum { ZMX_RECORDS = 48, ZMX_UNKNOWN = 32, ZMX_KEYS = 12 }; /* KEYS: those that share a remark */

/* A row of an operand: what it gives a configuration. */
typedef struct zmx_operand {
    const char *key, *text;  /* text: the value; NULL: the row could not be read */
    size_t line, at, configuration, parameter, known; /* known: its row in zmx_operands.c */
    double value;            /* NaN: it is no number */
} zmx_operand;

struct zmx {
    source *s;
    reader lines;          /* only its text, line and end */
    const zmx_record *row; /* what is read, */
    piece rest;            /* what is left of it, */
    unsigned field;        /* and the field that was read last, from 1 */

    const char *name, *units;           /* NULL: none */
    size_t line, name_line, units_line; /* line: of the first record */
    node *makers;                       /* NULL: none */
    const char *pupil, *pupil_key;      /* the keys of the lens file and of this one */
    double pupil_size;
    size_t pupil_line; /* 0: none */
    char *note; /* the paragraph that is read */
    size_t note_length, note_room, blank_notes;
    bool note_goes_on;
    unsigned field_type;
    bool telecentric, afocal;
    int aiming; /* 0: at the pupil; 1, 2: at the stop, with its paraxial or its real size */
    size_t aiming_line;
    size_t fields, waves; /* SIZE_MAX: not given */
    size_t ftyp_line, primary, primary_line;
    size_t configurations, configuration, configuration_line;
    zmx_operand *operand;
    size_t operands, operand_room;
    zmx_list list[ZMX_LISTS];

    zmx_surface *surface;
    size_t count, room;
    size_t stop, stop_line; /* the surface; 0: none */
    bool behind;            /* records of the system stand behind the surfaces */
    size_t surfaces, breaks; /* that are written */

    zmx_count tally[ZMX_TALLIES][ZMX_KEYS], unknown[ZMX_UNKNOWN];
    size_t unknowns, others; /* others: unknown records that found no room */
    struct { zmx_count count; size_t met; } record[2][ZMX_RECORDS];
};

/* zmx_field.c: the next field of the record.  What is missing or wrong is told, with its number. */
piece sgt_zmx_field(zmx *z); /* empty: there is none */
piece sgt_zmx_needed(zmx *z);
double sgt_zmx_number_in(zmx *z, piece word);
double sgt_zmx_number(zmx *z);
double sgt_zmx_number_or(zmx *z, double otherwise);
size_t sgt_zmx_whole(zmx *z); /* from 0 */
size_t sgt_zmx_whole_or(zmx *z, size_t otherwise);
char *sgt_zmx_text(zmx *z); /* to the end of the line; NULL: nothing */

char *sgt_zmx_copy(zmx *z, piece text);
void sgt_zmx_tally(zmx *z, zmx_tally which, size_t line, const char *key);

/* A type of surface, and what of its records means something. */
struct zmx_type {
    const char *name;
    unsigned parms; /* PARM 1 ... parms do */
    bool zeroth;    /* and PARM 0 */
    bool round;     /* CURV and CONI do */
    bool extras;    /* XDAT does */
    bool heights;   /* GDAT and GARR do */
    bool powers;    /* PARM i is the i-th of its coefficients in the lens file */
    bool alone;     /* PARM 1 ... 4 decentre and tilt it, and nothing behind it */
    bool aslant;    /* it is a plane with the slopes of PARM 1 and 2 */
    void (*write)(zmx *z, const zmx_surface *f, node *map); /* NULL: a break */
};

/* The type of that name; NULL: it is not read.  zmx_phase.c: of all; zmx_shape.c: without a phase. */
const zmx_type *sgt_zmx_type(piece name);
const zmx_type *sgt_zmx_shape(piece name);
/* zmx_shape.c */
const char *sgt_zmx_refused(piece name); /* why a type is not read, where that can be said; else NULL */
size_t sgt_zmx_number_of(const zmx *z, const zmx_surface *f);
void sgt_zmx_set_word(zmx *z, node *map, const char *key, size_t line, const char *text);
void sgt_zmx_set_number(zmx *z, node *map, const char *key, size_t line, double x);

/* A plane, sphere or conic; with PARM 1 ... 8 as powers. */
void sgt_zmx_write_standard(zmx *z, const zmx_surface *f, node *map);
void sgt_zmx_write_asphere(zmx *z, const zmx_surface *f, node *map);
/* XDAT 1 ... most, 0 where there is none; *line is that of the last one. */
double *sgt_zmx_extras(zmx *z, const zmx_surface *f, size_t most, size_t *line);

/* The terms of a surface: how many there are, where they begin, and the radius that they are scaled by. */
typedef struct zmx_terms {
    double *value; /* from 0 */
    size_t count, line;
    double norm;
} zmx_terms;

/* XDAT `first` counts them, the next is their radius, and behind that they stand. */
zmx_terms sgt_zmx_terms(zmx *z, const zmx_surface *f, size_t first, size_t most);
/* x / norm^power */
double sgt_zmx_by_norm(zmx *z, const zmx_surface *f, size_t line, double x, double norm, size_t power);

/* The factors of x^i y^j; rows and columns grow as they are set. */
enum { XY_ORDER = 20, XY_TERMS = 230 }; /* terms of order 1 ... 20 */
typedef struct zmx_xy {
    double factor[XY_ORDER + 1][XY_ORDER + 1];
    size_t width[XY_ORDER + 1], rows;
} zmx_xy;

void sgt_zmx_add_xy(zmx_xy *t, size_t i, size_t j, double factor);
node *sgt_zmx_rows(zmx *z, size_t line, const zmx_xy *t);
/* Adds the terms x, y, x^2, xy ... of XDAT; the line of the last one. */
size_t sgt_zmx_polynomial(zmx *z, const zmx_surface *f, zmx_xy *xy);
/* The Zernike terms of XDAT as a surface; NULL: none. */
node *sgt_zmx_zernike(zmx *z, const zmx_surface *f, bool fringe);

/* zmx_system.c: behind the last NOTE. */
void sgt_zmx_end_note(zmx *z);

/* zmx_operands.c: keeps a row behind MNUM; gives the lens, which is that of the active configuration, the
 * values of another, and returns how many operands there are that can be read.  The rest is told. */
void sgt_zmx_operand(zmx *z, piece key);
size_t sgt_zmx_configure(zmx *z, size_t wanted);

/* zmx_system.c and zmx_elements.c: what was read becomes keys of the root. */
void sgt_zmx_write_system(zmx *z, node *root);
void sgt_zmx_write_surfaces(zmx *z, node *root);

#endif
