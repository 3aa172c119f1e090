// SPDX-License-Identifier: MIT
/* phase.h - phases of surfaces. */
#ifndef SGT_LENS_PHASE_H
#define SGT_LENS_PHASE_H
#include "lens.h"

/* A surface of `type: ideal`, which has been taken.  others: keys that the caller has taken. */
void sgt_read_ideal(source *s, const node *map, const char *others, sgt_element *e);

/* `phase` of element i. */
void sgt_read_phase(whole_lens *w, source *s, const node *n, size_t i);

/* `facets` of element i. */
void sgt_read_facets(whole_lens *w, source *s, const node *n, size_t i);

/* Once all surfaces are read: phases in waves at the wavelengths of the file. */
void sgt_make_phases(whole_lens *w, source *s);

/* (unit.c) A unit of length in micrometres; NaN: it is not known. */
double sgt_unit_named(const char *label);

#endif
