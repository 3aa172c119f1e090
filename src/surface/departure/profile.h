// SPDX-License-Identifier: MIT
/* profile.h - a departure that depends on r alone. */
#ifndef SGT_SURFACE_DEPARTURE_PROFILE_H
#define SGT_SURFACE_DEPARTURE_PROFILE_H

#include <stddef.h>

/* P as a function of r alone: a polynomial p, and P = p(r), or P = p(r^2 / norm2) / sqrt(1 - bent r^2).
 *
 *     c, size      the coefficients; c[j] is off by at most 2^-45 size[j], and size[j] >= |c[j]|
 *     norm2        of a polynomial of r^2; 0: of one of r
 *     core, from   radii (length): the terms are gentle within the first, and far from it at the second */
enum { PROFILE_TERMS = 24 };
typedef struct sgt_profile {
    size_t terms;
    double norm2, bent, core, from, c[PROFILE_TERMS], size[PROFILE_TERMS];
} sgt_profile;

#endif
