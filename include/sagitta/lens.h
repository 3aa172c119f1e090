// SPDX-License-Identifier: MIT
/* lens.h - the glass that lenses are made of: catalogues of dispersion, and the index of
 * a glass at a wavelength.
 *
 * This is a library of its own, sagitta_lens; the core needs none of it.  It allocates,
 * by an allocator of the caller's choice, and reads files.
 *
 * UNITS.  Wavelengths are micrometres.  Indices are those of the formula: makers give
 * them relative to air of 20 C and one atmosphere.  Nothing is converted.
 *
 * THREADS.  Functions that take a const catalogue or a glass may run in any number of
 * threads at once.  sgt_catalogue_add... needs the catalogue for itself.  Numbers have a
 * point in any locale, as long as no other thread sets the locale meanwhile.
 *
 *     sgt_error error;
 *     sgt_catalogue *c = sgt_catalogue_new(NULL);
 *     sgt_glass glass;
 *     if (c && sgt_catalogue_add(c, NULL, &error) &&
 *         sgt_catalogue_find(c, "SCHOTT N-BK7", 0, NULL, &glass, &error))
 *         printf("%.5f\n", sgt_glass_index(&glass, sgt_spectral_line("d")));   1.51680
 *     sgt_catalogue_free(c); */
#ifndef SAGITTA_LENS_H
#define SAGITTA_LENS_H
#include <sagitta/formula.h>
#include <sagitta/surfaces.h>
#include <sagitta/system.h>
#include <stdint.h>
#ifdef __cplusplus
extern "C" {
#endif

/* Where memory comes from.  `resize` works as realloc.  If block is NULL, it returns a
 * new block.  If size is 0, it frees the block and returns NULL.  If there is no memory,
 * it returns NULL and leaves the block as it was. */
typedef struct sgt_allocator {
    void *(*resize)(void *context, void *block, size_t size);
    void *context;
} sgt_allocator;

/* ---------------------------------------------------------------- formulas
 *
 * w is the wavelength, C1, C2 ... the coefficients in the order of the file.
 *
 * 1 ... 9: those of refractiveindex.info (M. N. Polyanskiy, Dispersion formulas, 2021).
 * Terms go on as long as there are coefficients, missing ones are 0.
 *   1  n^2 = 1 + C1 + C2 w^2 / (w^2 - C3^2) + C4 w^2 / (w^2 - C5^2) + ...
 *   2  n^2 = 1 + C1 + C2 w^2 / (w^2 - C3) + C4 w^2 / (w^2 - C5) + ...
 *   3  n^2 = C1 + C2 w^C3 + C4 w^C5 + ...
 *   4  n^2 = C1 + C2 w^C3 / (w^2 - C4^C5) + C6 w^C7 / (w^2 - C8^C9)
 *          + C10 w^C11 + C12 w^C13 + ...
 *   5  n = C1 + C2 w^C3 + C4 w^C5 + ...
 *   6  n = 1 + C1 + C2 / (C3 - w^-2) + C4 / (C5 - w^-2) + ...
 *   7  n = C1 + C2 / (w^2 - 0.028) + C3 / (w^2 - 0.028)^2 + C4 w^2 + C5 w^4 + C6 w^6
 *   8  (n^2 - 1) / (n^2 + 2) = C1 + C2 w^2 / (w^2 - C3) + C4 w^2
 *   9  n^2 = C1 + C2 / (w^2 - C3) + C4 (w - C5) / ((w - C5)^2 + C6)
 *
 * 101 ... 113: formulas 1 ... 13 of .agf catalogues (OpticStudio's manual, The glass
 * dispersion formulas).  All coefficients that the formula names are needed.
 *   1  Schott      n^2 = C1 + C2 w^2 + C3 w^-2 + C4 w^-4 + C5 w^-6 + C6 w^-8
 *   2  Sellmeier 1 n^2 = 1 + sum of 3: C1 w^2 / (w^2 - C2) ...
 *   3  Herzberger  n = C1 + C2 L + C3 L^2 + C4 w^2 + C5 w^4 + C6 w^6, L = 1/(w^2 - 0.028)
 *   4  Sellmeier 2 n^2 = 1 + C1 + C2 w^2 / (w^2 - C3^2) + C4 / (w^2 - C5^2)
 *   5  Conrady     n = C1 + C2 / w + C3 / w^3.5
 *   6  Sellmeier 3 as 2, with 4 terms
 *   7  Handbook 1  n^2 = C1 + C2 / (w^2 - C3) - C4 w^2
 *   8  Handbook 2  n^2 = C1 + C2 w^2 / (w^2 - C3) - C4 w^2
 *   9  Sellmeier 4 n^2 = C1 + C2 w^2 / (w^2 - C3) + C4 w^2 / (w^2 - C5)
 *   10 Extended    as 1, + C7 w^-10 + C8 w^-12
 *   11 Sellmeier 5 as 2, with 5 terms
 *   12 Extended 2  as 1, + C7 w^4 + C8 w^6
 *   13 Extended 3  n^2 = C1 + C2 w^2 + C3 w^4 + C4 w^-2 + C5 w^-4 ... + C9 w^-12
 *
 * SGT_DISPERSION_PAIRS: C1 a wavelength, C2 the index there, C3 the next wavelength ...,
 *   rising.  Straight lines between them, and beyond the ends the lines there; one pair
 *   is one index for all.
 * SGT_DISPERSION_MODEL: C1 = nd, C2 = vd (0: no dispersion), C3 = the deviation of PgF
 *   from the normal line 0.6438 - 0.001682 vd (0 if missing).  n = nd + a v + b v^2 with
 *   v = x / (1 + 2.5 x), x = w - 0.5875618 (Buchdahl's coordinate), a and b such that
 *   nF - nC = (nd - 1) / vd and ng - nF = PgF (nF - nC).  APPROXIMATE: good to some 1e-4
 *   in the visible; ranges and catalogues do not bind it. */
enum {
    SGT_DISPERSION_AGF = 100, /* plus the number */
    SGT_DISPERSION_PAIRS = 201,
    SGT_DISPERSION_MODEL = 202
};

/* A glass as plain data.  One from a catalogue borrows its texts and coefficients:
 * they last until sgt_catalogue_free.  One of your own may be filled in by hand: begin
 * with zeros, set formula, count and coefficient. */
typedef struct sgt_glass {
    const char   *name;         /* NULL: none */
    const char   *maker;        /* of an .agf file: its name without the ending */
    const char   *remark;       /* what a user should know, or NULL */
    const char   *file;         /* where it stands, and the line from 1; or NULL */
    size_t        line;
    int           formula;      /* as above */
    size_t        count;        /* of coefficients */
    const double *coefficient;
    double        from, to;     /* where the formula was fitted, um; 0 and 0: not known */
    double        nd, vd;       /* as the catalogue prints them; 0: it does not */
    unsigned long long reserved_[4]; /* leave it zero */
} sgt_glass;

/* The index of refraction at a wavelength in um, also outside the range of the glass: ask
 * sgt_glass_covers.  NaN: the wavelength is not positive and finite, the formula is
 * unknown or lacks coefficients, or its value is not a positive number (n^2 < 0, a pole).
 * Rounding: observed below 1e-15 of n for all glasses that ship (docs/glass.md). */
SGT_API double sgt_glass_index(const sgt_glass *glass, double um);

/* Whether a wavelength lies in the range of the glass; true if that is not known. */
SGT_API bool sgt_glass_covers(const sgt_glass *glass, double um);

/* Is a glass sound, whatever the wavelength?  false: `error` (may be NULL) says what is
 * wrong (an unknown formula, too few coefficients, pairs that do not rise ...). */
SGT_API bool sgt_glass_sound(const sgt_glass *glass, sgt_error *error);

/* The wavelength, um, of a spectral line: i h g F' F e d D C' C r s t (SCHOTT, TIE-29);
 * NaN for another name. */
SGT_API double sgt_spectral_line(const char *name);

/* -------------------------------------------------------------- catalogues */

typedef struct sgt_catalogue sgt_catalogue;

/* An empty catalogue; NULL: no memory.  The allocator (NULL: malloc) is copied. */
SGT_API sgt_catalogue *sgt_catalogue_new(const sgt_allocator *allocator);
SGT_API void           sgt_catalogue_free(sgt_catalogue *catalogue); /* NULL: nothing */

/* Adds the glasses of a file, or of all files of a folder with a known ending, in the
 * order of their names.  Endings, in either case:
 *   .agf          a catalogue as OpticStudio writes it
 *   .csv          the form of the table that ships: maker,glass,formula,from_um,to_um,
 *                 and coefficients with blanks between; # begins a comment
 *   .yml, .yaml   one material of refractiveindex.info: formula 1 ... 9, tabulated n, nk.
 *                 Its name is that of the file, its maker the folder's
 * UTF-8, UTF-16 (with and without mark) or Latin-1; lines end as they like.
 *
 * path NULL: the table that ships.  It is looked for in the environment variable
 * SAGITTA_GLASS (a file or folder; nothing else is then tried), in the folder
 * <datadir>/sagitta/glass of the installation, and in the source tree this was built
 * from.
 *
 * false: `error` (may be NULL) says what and where.  Glasses of files read before remain;
 * of the file at fault none does.  A file that ends in the middle of a line of numbers is
 * at fault: it may be cut off. */
SGT_API bool sgt_catalogue_add(sgt_catalogue *catalogue, const char *path,
                               sgt_error *error);

/* The same of text in memory.
 *
 *     name    a file's name, for messages; its ending gives the form
 *     text    need not end with a zero
 *     length  of text, bytes
 */
SGT_API bool sgt_catalogue_add_text(sgt_catalogue *catalogue, const char *name,
                                    const char *text, size_t length,
                                    sgt_error *error);

/* How many glasses there are, and the one at a place from 0, in the order in which they
 * were added; false: there is none. */
SGT_API size_t sgt_catalogue_count(const sgt_catalogue *catalogue);
SGT_API bool   sgt_catalogue_glass(const sgt_catalogue *catalogue, size_t place,
                                   sgt_glass *glass);

/* Finds a glass.
 *
 *     name                  `NAME` or `MAKER NAME`, in either case of letters
 *     makers_count, makers  whose glass is wanted, best first; 0 and NULL: no wish
 *     glass                 written; glass->maker says whose it is
 *
 * If several glasses have the name, these rules choose one, in this order:
 *   - the maker that comes first in `makers`;
 *   - the latest call of sgt_catalogue_add...;
 *   - the maker that comes first in SCHOTT, OHARA, HOYA, CDGM, HIKARI, SUMITA;
 *   - the glass that was added first.
 * false: there is none, and `error` (may be NULL) lists the nearest names. */
SGT_API bool sgt_catalogue_find(const sgt_catalogue *catalogue, const char *name,
                                size_t makers_count, const char *const *makers,
                                sgt_glass *glass, sgt_error *error);

/* ------------------------------------------------------------------- lenses
 *
 * A lens as a file gives it: a row of elements for sgt_trace, and what a user launches
 * rays by.  Formats: the lens file of docs/lens_file.md (YAML, any ending), .zmx as
 * OpticStudio writes it, .seq of CODE V.  Lengths are in the unit of the file, angles in
 * degrees.
 *
 *     sgt_error error;
 *     sgt_lens *lens = sgt_lens_read("triplet.zmx", NULL, &error);
 *     if (!lens) { printf("%s:%zu: %s\n", error.file, error.line, error.words); ... }
 *     sgt_trace(lens->count, lens->element, lens->index_before, &ray, NULL, &fate, NULL);
 *     sgt_lens_free(lens); */

/* What a user should know of a lens that was read.  Nothing is ignored in silence. */
typedef enum sgt_remark_kind {
    SGT_REMARK_NOTE,     /* of interest: which maker's glass, a wavelength out of range */
    SGT_REMARK_TURNED,   /* turned into something else, such as a solve into its value */
    SGT_REMARK_LEFT_OUT  /* not imported, though rays may depend on it */
} sgt_remark_kind;

typedef struct sgt_lens_remark {
    sgt_remark_kind kind;
    size_t      line;   /* from 1 */
    const char *key;    /* the record or key */
    const char *words;  /* a sentence without a full stop; of what was turned it begins
                           "taken as", of what was left out "left out:" */
    unsigned long long reserved_[2];
} sgt_lens_remark;

/* How a file defines the size of the pupil.  Only SGT_PUPIL_RADIUS is a length. */
typedef enum sgt_pupil_kind {
    SGT_PUPIL_NONE,             /* not given */
    SGT_PUPIL_RADIUS,           /* the semi-diameter of the entrance pupil */
    SGT_PUPIL_F_NUMBER,         /* focal length / diameter of the entrance pupil */
    SGT_PUPIL_WORKING_F_NUMBER, /* paraxial, at the conjugates given: 1 / (2 n' u') */
    SGT_PUPIL_OBJECT_NA,        /* n sin of the marginal ray's angle at the object */
    SGT_PUPIL_OBJECT_ANGLE,     /* that angle, degrees */
    SGT_PUPIL_STOP_SIZE         /* the image of the stop at its size; no number */
} sgt_pupil_kind;

/* What the numbers of the fields are. */
typedef enum sgt_field_kind {
    SGT_FIELD_ANGLE,           /* degrees; the chief ray has the slopes (tan x, tan y) */
    SGT_FIELD_OBJECT_HEIGHT,   /* lengths, as all that follow */
    SGT_FIELD_PARAXIAL_IMAGE_HEIGHT,
    SGT_FIELD_REAL_IMAGE_HEIGHT
} sgt_field_kind;

/* Vignetting factors shrink the pupil of a field: a point x, y of the unit circle becomes
 * dx + x (1 - cx), dy + y (1 - cy), turned by angle (degrees, from x toward y). */
typedef struct sgt_lens_field {
    double x, y, weight;
    double dx, dy, cx, cy, angle;
    unsigned long long reserved_[2]; /* leave it zero */
} sgt_lens_field;

/* A surface, beside its element. */
typedef struct sgt_lens_surface {
    const char *type;        /* as in the lens file: "sphere" */
    const char *name;        /* a comment of the file; "" where not given */
    size_t      line;        /* where it stands, from 1 */
    double      z;           /* its vertex on an unfolded axis: the sum of thicknesses.
                                With `origin`, the z of that */
    bool        mirror;
    bool        off_axis;    /* placed by `origin`, and tilted or beside the axis */
    bool        folded;      /* breaks in front of it have turned or moved the axis */
    double      size;        /* the half height in use, or 0: for drawings, and for
                                SGT_PUPIL_STOP_SIZE.  It clips nothing */
    double      focal_length; /* of the type "ideal", whose element is a plane with an
                                sgt_phase of that kind; else 0.  Of two focal lengths
                                that along y, which is infinite if there is no power.  If
                                the file gives no object_distance, that of the phase is
                                the distance of the paraxial image that the surfaces in
                                front form of the object, at the wavelength of the
                                elements */
    unsigned long long reserved_[4];
} sgt_lens_surface;

/* Where the points of a pattern are. */
typedef enum sgt_lens_aim {
    SGT_LENS_AIM_PUPIL,    /* in the paraxial entrance pupil */
    SGT_LENS_AIM_STOP,     /* on the stop, out to the height of the paraxial marginal
                              ray */
    SGT_LENS_AIM_REAL_STOP /* on the stop, out to the height of the real marginal ray */
} sgt_lens_aim;

typedef struct sgt_lens {
    const char *file;        /* where it was read from, for messages */
    size_t      line;        /* the first line of it that says anything */
    const char *name, *units; /* "" where not given */

    size_t        wavelengths; /* 1 or more */
    const double *wavelength;  /* um; NULL: the file gives none */
    const double *wavelength_weight; /* 1 where not given */
    size_t        primary;     /* the place of the reference wavelength, from 0 */

    double object_distance;  /* from the object to the first vertex, 0 or more; infinite:
                                from afar */
    sgt_vec2 object_slope;   /* of a tilted object at a distance: its point x, y lies
                                slope.x x + slope.y y nearer to the first vertex */
    bool   telecentric;      /* chief rays are parallel to the axis in object space; the
                                pupil is then a cone (object_na, object_angle) */
    bool   afocal;           /* light leaves as parallel rays: analyses answer in angles,
                                and paths go to a plane */

    sgt_pupil_kind pupil;
    double pupil_size;       /* as the kind says; NaN for none */
    double pupil_distance;   /* of the entrance pupil from the first vertex; NaN: that of
                                the paraxial image of the stop */
    sgt_lens_aim aim;
    size_t stop;             /* the place of its surface; 0 if none is marked */
    bool   stop_marked;

    sgt_field_kind field_kind;
    size_t fields;           /* 1 or more; one on the axis where none is given */
    const sgt_lens_field *field;

    size_t count;            /* of surfaces */
    const sgt_element *element;      /* [count], at the primary wavelength */
    const sgt_lens_surface *surface; /* [count] */
    double index_before;     /* in front of the first, at the primary wavelength */

    size_t remarks;
    const sgt_lens_remark *remark;
    unsigned long long reserved_[8];
} sgt_lens;

/* How to read.  Zeros are the defaults.  What they point to has to last as long as the
 * lens is edited (edit.h). */
typedef struct sgt_lens_options {
    const sgt_allocator *allocator;  /* NULL: malloc.  It must last as long as the lens.
                                        (libyaml takes from malloc while it parses) */
    const sgt_catalogue *glasses;    /* NULL: the table that ships, read if a name is met.
                                        What the lens needs of it is copied */
    const sgt_builtin *types;        /* more surfaces than the built-in ones, such as
                                        sgt_geo_builtins; NULL: none */
    /* Called for each surface with the operations file_ops (of `types`) when its
     * numbers are read.  path: the value of its key `file`, or NULL.  Returns NULL, or
     * what is wrong. */
    const sgt_surface_ops *file_ops;
    const char *(*complete)(void *context, const sgt_builtin *type, void *self,
                            const char *path);
    /* Reads a file into memory: sets *text and *length.  The library calls `forget` when
     * it no longer needs *text.  Returns NULL, or why the file cannot be read.  NULL: the
     * library reads files by fopen. */
    const char *(*read)(void *context, const char *path, char **text, size_t *length);
    void (*forget)(void *context, char *text);
    void *context;
    /* which configuration is read if the file has several, from 1; 0: the values of the
     * file itself, with all configurations beside them (edit.h).  Of a .zmx file they are
     * those of the active one, of a .seq file those of the first position of its zoom */
    int configuration;
    unsigned long long reserved_[4]; /* leave it zero, and that of the rows of `types` */
} sgt_lens_options;

/* Reads a lens from a file.  A name that ends in .yaml, .yml or .json is that of a lens
 * file.  Of any other the first lines decide whether it is .zmx, .seq or YAML, and then
 * its ending.
 * NULL: `error` (may be NULL) says what and where. */
SGT_API sgt_lens *sgt_lens_read(const char *path, const sgt_lens_options *opt,
                                sgt_error *error);

/* The same of text in memory.
 *
 *     name    a file's name, for messages; its ending gives the form.  Other files that
 *             the lens names are looked for in its folder
 *     text    need not end with a zero
 *     length  of text, bytes
 *     opt     NULL, or how to read
 */
SGT_API sgt_lens *sgt_lens_read_text(const char *name, const char *text, size_t length,
                                     const sgt_lens_options *opt, sgt_error *error);

/* One surface from text, "{type: sphere, radius: 20}": a lens of one element at the
 * origin, whose semi_diameter is the surface's own rim.  name: for messages. */
SGT_API sgt_lens *sgt_lens_read_surface(const char *name, const char *text,
                                        const sgt_lens_options *opt,
                                        sgt_error *error);

SGT_API void sgt_lens_free(sgt_lens *lens); /* NULL: nothing */

/* The elements at a wavelength, with their indices there.
 *
 *     um            the wavelength, um; NaN if the file gives no wavelengths
 *     element       room for lens->count, written; NULL: not wanted.  At the primary
 *                   wavelength they are those of the lens
 *     index_before  written: the index in front of the first
 *
 * If the file gives no object_distance for an ideal lens, the paraxial one at that
 * wavelength is taken; at a wavelength that the file does not list, that at the primary
 * one.  Phases in waves are those at that wavelength.  They last as long as the lens, or
 * until it is edited: for each wavelength that the file does not list some memory is
 * kept.  false: some medium has no index there (a list of indices for other wavelengths,
 * a pole), or there is no memory, and `error` says which. */
SGT_API bool sgt_lens_at(const sgt_lens *lens, double um, sgt_element element[],
                         double *index_before, sgt_error *error);

/* The glass behind a surface (place 1 ... count), or in front of the first (place 0), and
 * the line that names it.  false: an index by numbers, or the medium in front. */
SGT_API bool sgt_lens_glass(const sgt_lens *lens, size_t place, sgt_glass *glass,
                            size_t *line);

/* A surface that is a formula.
 *
 *     place       the surface, 1 ... count
 *     text        written: its text
 *     parameters  written: its parameters as the file gives them
 *     n           written: how many parameters there are
 *
 * They last as long as the lens.  false: the surface is of another type. */
SGT_API bool sgt_lens_formula(const sgt_lens *lens, size_t place, const char **text,
                              const sgt_named **parameters, size_t *n);

/* The lens as a lens file in YAML, whatever it was read from: it reads back as the same
 * lens, bit for bit, and is written again byte for byte.  Comments at the head of the
 * file, and the notes of a .zmx file, stand in front.  The text lasts as long as the
 * lens.  NULL: no memory. */
SGT_API const char *sgt_lens_yaml(sgt_lens *lens, size_t *length);

/* ------------------------------------------------------------- first-order data
 *
 * By paraxial rays (heights y, and n u with the slope u) in the y-z plane from vertex to
 * vertex on the unfolded axis: tilts, decentres and breaks do not count, as lens files
 * mean it.  So an off-axis parabola has the data of its parent.  The last surface is the
 * image; it has no power.  After a mirror n is negative, and distances along z keep their
 * signs (Welford 1986, Aberrations of Optical Systems, 3.2, 3.3; Seidel sums 8.2 to 8.4).
 *
 * The entrance pupil is that of the primary wavelength, at all wavelengths alike.
 *
 * NaN is "there is none": the focal length of an afocal system, a pupil at infinity. */
typedef struct sgt_first_order {
    double wavelength;          /* um, or NaN */
    double power;               /* P, 1/length.  0: afocal, that is, P is no more than
                                   some ulps of each radius, thickness, index and of the
                                   trace can make it (src/lens/optics/first_order.c).
                                   The numbers below are treated alike: one that is 0
                                   within its bound is 0, and a quotient by it is NaN */
    double efl;                 /* 1 / P: the focal length, in the medium 1 */
    double efl_image;           /* |n'| / P: in the image medium */
    double ffd;                 /* from the first vertex to the front focus */
    double bfd;                 /* rear focus, from the last vertex before the image */
    double focus;               /* the rear focus, from the image surface */
    double image;               /* the paraxial image, from the image surface */
    double front_principal;     /* from the first vertex */
    double rear_principal;      /* from the image surface */
    double front_nodal, rear_nodal; /* the same of the nodal points */
    double magnification;       /* of an object at a distance; NaN: at infinity */
    double entrance_pupil;      /* from the first vertex */
    double entrance_radius;     /* its semi-diameter */
    double exit_pupil;          /* from the image surface */
    double exit_radius;         /* its semi-diameter */
    double stop_radius;         /* the height of the paraxial marginal ray at the stop */
    double f_number;            /* |efl| / (2 entrance_radius) */
    double f_number_working;    /* 1 / (2 n' u') of the marginal ray, positive */
    double image_height;        /* paraxial, of the field farthest from the axis */
    double lagrange;            /* n (u ybar - ubar y), marginal and that chief ray */
    double petzval_radius;      /* the Petzval radius of curvature; negative: it bends
                                   toward a lens of positive power */
    size_t without_vertex;      /* the first surface, from 1, that has no vertex curvature
                                   or stands off the axis by `origin`: what depends on its
                                   power is NaN.  0: none */
    double angular_magnification; /* slope of the paraxial chief ray behind the lens, over
                                   its slope in front */
    const char *without_seidel; /* why there are no Seidel sums, if they were asked for;
                                   constant.  NULL: there are */
    unsigned long long reserved_[8];
} sgt_first_order;

/* The Seidel sums of one surface, for the marginal ray and the chief ray of the field
 * that is farthest from the axis: of the wavefront, in lengths.  chromatic: axial,
 * lateral, for the indices at the shortest and the longest wavelength of the file. */
typedef struct sgt_seidel {
    double spherical, coma, astigmatism, petzval, distortion, chromatic[2];
    unsigned long long reserved_[2];
} sgt_seidel;

/* First-order data, and Seidel sums.
 *
 *     um      the wavelength, um; NaN: the primary one
 *     out     written; lengths in the unit of the lens
 *     seidel  NULL, or room for lens->count; all are NaN if there are none, as
 *             out->without_seidel says
 *
 * false: some medium has no index at that wavelength, or memory ran out. */
SGT_API bool sgt_lens_first_order(const sgt_lens *lens, double um, sgt_first_order *out,
                                  sgt_seidel seidel[], sgt_error *error);

/* First-order data along a real ray, for lenses that are folded, tilted or freeform: of
 * the rays near it.  [0] is the section of the global x, [1] that of y, carried along
 * with the ray (src/lens/optics/parabasal.c).  Distances are along the ray, from where it
 * meets the last element.  On the axis of a centred lens they agree with sgt_first_order.
 * NaN: there is none, or the sections mix (power[0][1] or power[1][0] is not 0). */
typedef struct sgt_parabasal {
    double power[2][2];       /* -n' times the change of direction by a displacement */
    double efl[2];            /* 1 / power */
    double focus[2];          /* to where rays that come in parallel to this ray meet */
    double image[2];          /* to where rays that start where this ray does meet */
    double magnification[2];  /* at the image */
    double power_xy;          /* the larger of |power[0][1]| and |power[1][0]|; 0 if it is
                                 no more than 1e-9 of the larger of the other two */
    unsigned long long reserved_[3];
} sgt_parabasal;

/* First-order data along a ray that was traced.
 *
 *     elements, e, index_before  as they were given to sgt_trace
 *     from_point                 the ray starts at its object point; false: it comes from
 *                                afar, and out->image is out->focus
 *     chief                      the launch ray as it was given to sgt_trace
 *     passages                   as sgt_trace left them, of all elements
 *     out                        written; lengths in the unit of the lens
 *
 * false: all is NaN, and `error` (may be NULL) says why: the ray did not get through, or
 * a surface has no second derivatives.  sgt_field_parabasal (analysis.h) also finds the
 * chief ray of a field. */
SGT_API bool sgt_lens_parabasal(size_t elements, const sgt_element e[],
                                double index_before, bool from_point,
                                const sgt_ray *chief, const sgt_passage passages[],
                                sgt_parabasal *out, sgt_error *error);

/* ---------------------------------------------------------- points of a pupil */

typedef enum sgt_pattern {
    SGT_PATTERN_FAN,       /* n points along y, from edge to edge; 1: the centre */
    SGT_PATTERN_GRID,      /* the points of an n x n grid that lie inside the circle */
    SGT_PATTERN_HEXAPOLAR, /* the centre and n rings, the j-th of 6 j points */
    SGT_PATTERN_RANDOM,    /* n points, uniform over the area */
    SGT_PATTERN_SOBOL,     /* the first n of a sequence that fills the area evenly */
    SGT_PATTERN_CELLS,     /* the centres of n x n square cells that lie inside the
                              circle */
    SGT_PATTERN_CROSS      /* n points along y, then n along x; the centre once if n is
                              odd */
} sgt_pattern;

/* In the unit circle.  weight: for a mean over the area; all of a pattern add up to 1.
 * (Of a fan they are equal: it has no area.) */
typedef struct sgt_pupil_point { double x, y, weight; } sgt_pupil_point;

/* Sets the first points of a pattern, and returns how many it has.
 *
 *     n     of the pattern (sgt_pattern)
 *     seed  of a random pattern, whose i-th point depends on the seed and on i alone
 *     most  how many points to set at most; 0 asks for the number
 *     at    written: at[0 ... most - 1], with weights that add up to 1 over these
 *
 * The bits are the same on every system. */
SGT_API size_t sgt_pupil_points(sgt_pattern pattern, size_t n, uint64_t seed, size_t most,
                                sgt_pupil_point at[]);

/* A pattern of which any points can be made when they are needed, in any thread.
 *
 *     pattern, n, seed  as for sgt_pupil_points
 *     allocator         NULL: malloc
 *
 * NULL: no memory.  It takes 8 bytes for each of the n rows of a grid or of cells, and
 * for each 344 points of Sobol's sequence. */
typedef struct sgt_pupil sgt_pupil;
SGT_API sgt_pupil *sgt_pupil_new(sgt_pattern pattern, size_t n, uint64_t seed,
                                 const sgt_allocator *allocator);
SGT_API void       sgt_pupil_free(sgt_pupil *pupil); /* NULL: nothing */
SGT_API size_t     sgt_pupil_count(const sgt_pupil *pupil);

/* Sets at[0 ... count - 1] to the points from number `first` on, counted from 0: the bits
 * that sgt_pupil_points sets. */
SGT_API void sgt_pupil_part(const sgt_pupil *pupil, size_t first, size_t count,
                            sgt_pupil_point at[]);

/* Some of the points of a random pattern, so that they can be made when they are needed,
 * in any thread.
 *
 *     n             how many points the whole pattern has
 *     seed          of the pattern
 *     first, count  the points from number first, counted from 0, to first + count - 1
 *     at            written: `count` points, each with the weight 1 / n
 */
SGT_API void sgt_pupil_random(size_t n, uint64_t seed, size_t first, size_t count,
                              sgt_pupil_point at[]);

/* Philox4x32-10 (Salmon et al. 2011): 128 random bits of a counter and a key. */
SGT_API void sgt_philox(const uint32_t counter[4], const uint32_t key[2],
                        uint32_t out[4]);

#ifdef __cplusplus
}
#endif
#endif /* SAGITTA_LENS_H */
