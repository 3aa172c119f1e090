// SPDX-License-Identifier: MIT
/* aperture.h - the apertures of a surface from its list of maps. */
#ifndef SGT_LENS_APERTURE_H
#define SGT_LENS_APERTURE_H
#include "tree.h"

const sgt_aperture *sgt_read_apertures(source *s, const node *list);

#endif
