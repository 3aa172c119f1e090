// SPDX-License-Identifier: MIT
/* lens.h - a lens and what it is made of, beyond what users see. */
#ifndef SGT_LENS_LENS_H
#define SGT_LENS_LENS_H
#include "medium.h"

#include <sagitta/tolerance.h>

typedef struct whole_lens {
    sgt_lens lens;           /* first: users have a pointer to it */
    arena memory;            /* in which everything lies that the lens points to */
    node *root;              /* the tree it was made of */
    const char **comment;    /* at the head of the file */
    size_t comments;
    sgt_element *element;
    sgt_lens_surface *about;
    medium *medium;          /* [count + 1]: in front of the first surface, behind each */
    double *order;           /* [count]: of phases in waves; NULL: there is none */
    sgt_phase *phase_at;     /* [wavelengths * count]: at each wavelength phases in waves, and the ideal
                                lenses whose file gives no object_distance; kind 0: of no such one.  NULL:
                                there is none */
    struct other_phases *other_phases; /* those at wavelengths that the file has not */
    formula_text *formula;   /* of the surfaces that are formulas, in any order */
    sgt_tolerance *tolerance; /* [tolerances] */
    size_t tolerances;
    media media;             /* while it is read; then the glasses that were found */
    /* for an edit, which reads the tree anew */
    void (*make)(struct whole_lens *w, source *s);
    sgt_lens_options options; /* but for the allocator, which is that of the memory */
    const char *folder;
    const sgt_lens_remark *imported; /* remarks that are older than the tree */
    size_t imports;
} whole_lens;

/* Fill in w->lens from s->root. */
void sgt_read_lens(whole_lens *w, source *s);
void sgt_read_one_surface(whole_lens *w, source *s);

/* (lens.c) What a surface or a phase that is a formula was read from; NULL: it is none. */
const formula_text *sgt_formula_of(const sgt_lens *lens, sgt_surface s);

/* (phase.c) Puts the phases of a wavelength into elements of the lens.  false: no memory. */
bool sgt_put_phases(const whole_lens *w, double um, sgt_element element[]);
void sgt_free_phases(whole_lens *w);

#endif
