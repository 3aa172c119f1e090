// SPDX-License-Identifier: MIT
/* seq.h - a sequence file of CODE V on its way into a tree: seq.c tells the commands apart, seq_field.c takes
 * their words, seq_system.c and seq_surface.c read them, seq_glass.c knows the names of glasses, and
 * seq_elements.c makes surfaces and breaks of what was read. */
#ifndef SGT_LENS_SEQ_H
#define SGT_LENS_SEQ_H
#include "../base/reader.h"
#include "tree.h"

/* One word of a command, and where it stands. */
typedef struct seq_word {
    piece text;
    size_t line;
    bool quoted;
} seq_word;

/* A number and its line; line 0: it is not given. */
typedef struct seq_number {
    double value;
    size_t line;
} seq_number;

/* ----------------------------------------------------------------- surfaces */

/* What the first number of a surface is: with RDM, without, or not said. */
typedef enum seq_bend { SEQ_UNSAID, SEQ_RADIUS, SEQ_CURVATURE } seq_bend;

typedef enum seq_shape { SEQ_NO_SHAPE, SEQ_SPHERE, SEQ_CONIC, SEQ_ASPHERE } seq_shape;
typedef enum seq_move { SEQ_PLAIN, SEQ_RETURN, SEQ_BEND, SEQ_REVERSE } seq_move; /* none, DAR, BEN, REV */

enum { SEQ_POWERS = 9, SEQ_MOVES = 6, SEQ_TERMS = 8, SEQ_APERTURES = 64 };

typedef enum seq_outline { SEQ_CIRCLE, SEQ_RECTANGLE, SEQ_ELLIPSE } seq_outline;
typedef enum seq_class { SEQ_CLEAR, SEQ_OBSCURES, SEQ_EDGE, SEQ_HOLE } seq_class;

typedef struct seq_aperture {
    seq_outline outline;
    seq_class class;
    piece label; /* L'...'; empty: none */
    size_t line;
    bool given[2];
    double half[2], centre[2], turn; /* half[0] is the radius of a circle */
} seq_aperture;

/* DIF DOE: what it adds to the path is (L / HWL) m times the sum of C_n r^(2n). */
typedef struct seq_phase {
    size_t line;
    bool turned; /* HCT R */
    seq_number order;
    seq_word wavelength; /* nanometres; empty: none */
    double term[SEQ_TERMS];
    double source[6];  /* of the two beams: they must be one */
    bool imaginary[2];
} seq_phase;

typedef struct seq_surface {
    size_t line;
    seq_bend bend;
    seq_shape shape;
    seq_number curve, other_curve, thickness, conic; /* other_curve: in x */
    double power[SEQ_POWERS];                        /* of r^4, r^6 ... */
    size_t power_line;
    seq_word glass;
    bool mirror;
    seq_move kind;
    size_t kind_line, move_line;
    double move[SEQ_MOVES]; /* XDE YDE ZDE ADE BDE CDE */
    seq_aperture *aperture;
    size_t apertures, aperture_room;
    seq_phase *phase; /* NULL: none */
    const char *name; /* NULL: none */
    size_t name_line;
} seq_surface;

/* ----------------------------------------------------------------- commands */

/* What becomes of a command.  IDLE: it moves no ray.  SOLVE: its value is stored elsewhere.  LEFT: it is not
 * imported.  REFUSED: without it this would be another lens.  OPTION: so much is left out up to its GO.
 * READ, TEXT: read; a TEXT may be cut off at the end of the file.  ZOOM: has another command in it. */
typedef enum seq_fate {
    SEQ_IDLE,
    SEQ_SOLVE,
    SEQ_LEFT,
    SEQ_REFUSED,
    SEQ_OPTION,
    SEQ_READ,
    SEQ_TEXT,
    SEQ_ZOOM
} seq_fate;

typedef struct seq seq;

typedef struct seq_command {
    const char *name; /* of three letters: of longer ones the first three count */
    seq_fate fate;
    void (*read)(seq *q);
    unsigned which;  /* what the reader asks; and what may stand with it */
    const char *why; /* of LEFT, REFUSED: more words */
} seq_command;

/* It may stand behind ZOO; it may have the qualifier of a field; of a wavelength, or a term; the class and
 * label of an aperture; and it is of no surface, though in the table of those. */
enum { SEQ_Z = 256, SEQ_F = 512, SEQ_W = 1024, SEQ_L = 2048, SEQ_NO_SURFACE = 4096 };

typedef struct seq_table {
    size_t count;
    const seq_command *command;
} seq_table;
extern const seq_table sgt_seq_surface_commands, sgt_seq_system_commands;

typedef struct seq_list {
    double *value;
    size_t count, room, line;
} seq_list;

/* Fields in the order of their kinds: x and y of each. */
typedef enum seq_lists {
    SEQ_XAN,
    SEQ_YAN,
    SEQ_XOB,
    SEQ_YOB,
    SEQ_XIM,
    SEQ_YIM,
    SEQ_XRI,
    SEQ_YRI,
    SEQ_WL,
    SEQ_WTW,
    SEQ_WTF,
    SEQ_VUX,
    SEQ_VLX,
    SEQ_VUY,
    SEQ_VLY,
    SEQ_LISTS
} seq_lists;

typedef struct seq_count {
    const char *key;
    size_t line, count;
} seq_count;

/* A glass of a PRV block. */
typedef struct seq_private {
    seq_word name;
    bool series; /* LAU */
    bool told, told_plain;
    size_t count;
    double *value;
    seq_number *um; /* the wavelengths that held then */
    size_t ums;
    struct seq_private *next; /* of the same hash */
} seq_private;

/* A fictitious glass, and how many surfaces have it. */
typedef struct seq_model {
    piece code;
    size_t line, count;
    double nd, vd;
} seq_model;

/* A glass of the catalogue, by the letters and digits of its name. */
typedef struct seq_known {
    const char *name, *maker;
    struct seq_known *next;
} seq_known;

enum { SEQ_UNKNOWN = 32, SEQ_HASH = 4096, SEQ_COMMANDS = 112, SEQ_MODELS = 16 };

struct seq {
    source *s;
    const char *at, *end;          /* what is left of the text */
    size_t line;                   /* at `at` */
    bool whole;                    /* the command has an end of line or a ; */
    seq_word *word;                /* of the command */
    size_t words, word_room, next; /* next: the one to be taken */
    const seq_command *row;        /* what is read */

    /* the qualifiers of the command; of surfaces, from and to */
    bool placed;
    size_t from, to, zoom, field, term, work;
    bool zooms; /* it stands behind ZOO, with one value */
    seq_class class;
    bool classed;
    piece label;

    size_t first;  /* the line of the first command */
    seq_bend bend; /* of the lines to come */
    seq_surface *surface;
    size_t count, room, image_line; /* image_line 0: SI has not come */
    size_t current;
    size_t stop, stop_line;          /* 0: none */
    size_t focus_line;               /* PIM */
    size_t crossings, crossing_line; /* IC Y */
    size_t option_line;              /* of an option whose GO has not come */
    bool in_private, ended;
    size_t private_line, behind, behind_line; /* commands behind the last GO */

    const char *name, *units, *pupil, *pupil_key; /* NULL: none */
    size_t name_line, units_line, pupil_line;
    double pupil_size;
    seq_number reference;
    seq_list list[SEQ_LISTS];
    int fields;           /* the x list of those that hold; -1: none */
    bool uses_apertures;  /* CA */
    size_t aperture_line; /* of the first that clips */

    size_t positions, positions_line, position; /* of a zoom; position from 1 */
    size_t zoomed, zoomed_line;

    seq_private *own[SEQ_HASH];
    seq_number *um; /* PWL */
    size_t ums, um_room;
    seq_known **known; /* NULL: not asked yet */
    seq_model model[SEQ_MODELS];
    size_t models, other_models, other_models_line;

    seq_count unknown[SEQ_UNKNOWN];
    size_t unknowns, others, others_line;
    size_t zoomed_row[2][SEQ_COMMANDS]; /* the line, of those that some position has its own value of */
    seq_count met[2][SEQ_COMMANDS], extra[2][SEQ_COMMANDS];
};

/* seq_field.c: the words of a command, one after another.  What is missing or wrong is told. */
bool sgt_seq_is(piece word, const char *small); /* whatever the case of letters */
const seq_word *sgt_seq_more(seq *q);           /* NULL: there is none */
seq_word sgt_seq_needed(seq *q);
bool sgt_seq_number_of(piece word, double *x); /* 1.5, -.67, 1D-5 */
double sgt_seq_number_in(seq *q, const seq_word *w);
double sgt_seq_number(seq *q);
size_t sgt_seq_whole(seq *q, size_t least);
char *sgt_seq_text(seq *q); /* all that is left */
char *sgt_seq_copy(seq *q, piece text);
/* A number times a power of ten, rounded once. */
double sgt_seq_scaled(seq *q, const seq_word *w, int power);
/* The same of a wavelength in nanometres; an error if it is below 1. */
double sgt_seq_wave(seq *q, const seq_word *w, int power);
unsigned sgt_seq_asked(const seq *q); /* `which` of its row, below SEQ_Z */
size_t sgt_seq_line(const seq *q);    /* of the command */
void sgt_seq_set_word(seq *q, node *map, const char *key, size_t line, const char *text);
void sgt_seq_set_number(seq *q, node *map, const char *key, size_t line, double x);

/* seq_glass.c */
void sgt_seq_read_private(seq *q); /* a command within a PRV block */
/* Sets what is behind a surface, or in front of the first. */
void sgt_seq_set_medium(seq *q, node *map, const seq_surface *f, bool object);

/* seq_system.c and seq_elements.c: what was read becomes keys of the root. */
double sgt_seq_wavelength(const seq *q, size_t i); /* micrometres */
void sgt_seq_write_system(seq *q, node *root);
void sgt_seq_write_surfaces(seq *q, node *root);

/* Whether a text looks like a sequence file, and like a .zmx file, by its first lines. */
bool sgt_seq_looks(const char *text, size_t length);

#endif
