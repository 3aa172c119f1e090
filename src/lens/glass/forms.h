// SPDX-License-Identifier: MIT
/* forms.h - what the readers of catalogues share, and the forms that they read. */
#ifndef SGT_LENS_FORMS_H
#define SGT_LENS_FORMS_H
#include "../base/reader.h"

/* Copies texts and coefficients and appends the glass, if sgt_glass_fault has nothing to say;
 * false: told. */
bool sgt_reader_append(const reader *r, sgt_glass glass, const char *key);

/* (glass.c) What is wrong with a glass, in words; NULL: nothing. */
const char *sgt_glass_fault(const sgt_glass *glass);

bool sgt_read_agf(reader *r, piece maker);
bool sgt_read_csv(reader *r);
bool sgt_read_rii(reader *r, piece name, piece maker);

#endif
