// SPDX-License-Identifier: MIT
/* dispersion.h - the index of a glass over a range of wavelengths. */
#ifndef SGT_PROVE_DISPERSION_H
#define SGT_PROVE_DISPERSION_H
#include <sagitta/beam.h>
#include <sagitta/lens.h>

/* The index at each wavelength that `um` (micrometres, above 0) goes through.  It holds what sgt_glass_index
 * answers there, too.  false: it is not known, as of a table of indices, or near a pole. */
bool sgt_dispersion(const sgt_glass *glass, const sgt_model *um, sgt_model *out);

#endif
