// SPDX-License-Identifier: MIT
/* paint.h - pictures of convergence: what each ray of the camera cost, or came to. */
#ifndef RENDER_PAINT_H
#define RENDER_PAINT_H
#include "picture.h"

typedef enum paint_kind { PAINT_LIGHT, PAINT_EVALUATIONS, PAINT_STATUS } paint_kind;

/* The picture, unscaled, with its legend below. */
void paint_write(const picture *p, paint_kind kind, const char *file, uint64_t digest);

#endif
