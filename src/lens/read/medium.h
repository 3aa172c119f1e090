// SPDX-License-Identifier: MIT
/* medium.h - a medium as a lens file names it, and its index at a wavelength. */
#ifndef SGT_LENS_MEDIUM_H
#define SGT_LENS_MEDIUM_H
#include "tree.h"

typedef enum medium_kind {
    MEDIUM_BEFORE,  /* as in front */
    MEDIUM_NUMBER,  /* one index for all wavelengths */
    MEDIUM_LIST,    /* one for each wavelength of the file */
    MEDIUM_GLASS
} medium_kind;

typedef struct medium {
    medium_kind kind;
    size_t line;
    const char *key;        /* "index", "glass", "object.index" ... */
    double number;
    const double *list;
    const sgt_glass *glass;
} medium;

/* What the media of one lens share. */
enum { KNOWN_MOST = 64 };
typedef struct known_glass {
    const char *name;       /* as the lens has it */
    const sgt_glass *glass;
    const sgt_lens_remark *remark; /* what was told of it when it was looked up */
    size_t remarks;
} known_glass;
typedef struct media {
    source *source;
    size_t makers;          /* in the order in which one is taken where several have a name */
    const char *const *maker;
    const struct media *before; /* of the lens of which this one is an edit; NULL: none */
    known_glass known_glass[KNOWN_MOST];
    size_t known;
    bool model_told;        /* that a model glass is approximate */
} media;

/* `glass` says: a name, air, same (MEDIUM_BEFORE), {nd, vd, dPgF}, {sellmeier: [...]}, or a list of
 * [wavelength, index].  Remarks what a user should know. */
medium sgt_medium_of_glass(media *m, node *n, const char *key);

/* The glasses that the caller gave, or the table that ships. */
const sgt_catalogue *sgt_source_glasses(source *s, size_t line, const char *key);

/* `index` says: a number, or a list with one for each of the wavelengths. */
medium sgt_medium_of_index(media *m, const node *n, const char *key, size_t wavelengths);

/* The index at a wavelength (um; NaN: none is known).  NaN: `why` says why there is none. */
enum { WHY_SIZE = 300 };
double sgt_medium_index(const medium *m, const sgt_lens *lens, double um, double before, char why[WHY_SIZE]);

#endif
