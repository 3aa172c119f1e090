// SPDX-License-Identifier: MIT
/* info.h - what info.c finds out, and info_json.c writes. */
#ifndef TOOL_INFO_H
#define TOOL_INFO_H
#include "../job/job.h"
#include "../show/table.h"

/* Along the real chief ray of a field. */
typedef struct info_chief {
    sgt_parabasal of;
    const char *why_not;   /* NULL, or why there is no such data: all of it is NaN */
} info_chief;

/* The paraxial data at the wavelength of the lens; seidel: as for sgt_lens_first_order. */
sgt_first_order info_first_order(const lens *l, sgt_seidel seidel[]);
sgt_seidel info_seidel_sum(const lens *l, const sgt_seidel seidel[]);
info_chief *info_chiefs(const lens *l);        /* one for each field */

/* [l->of->fields]: the distance of each field's paraxial image from the axis. */
double *info_image_heights(const lens *l, const sgt_first_order *o);

/* An object for each wavelength; as_list: in a list, else there is one. */
void info_json(const table_target *target, const lens_list *at, bool as_list);

#endif
