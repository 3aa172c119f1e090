// SPDX-License-Identifier: MIT
/* ordinary.h - ordinary rays for a surface of any type, always the same; most of them meet it. */
#ifndef TRUTH_ORDINARY_H
#define TRUTH_ORDINARY_H
#include <sagitta/sagitta.h>

void ordinary_rays(sgt_surface s, size_t count, sgt_ray ray[]);

#endif
