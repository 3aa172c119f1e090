// SPDX-License-Identifier: MIT
/* picture.h - the swath on a map, and what each ray cost. */
#ifndef LINE_OF_SIGHT_PICTURE_H
#define LINE_OF_SIGHT_PICTURE_H
#include "scan.h"

#include <stdbool.h>

bool picture_can(void); /* was this built with cairo? */

/* A PNG; title: a line above it; by_height: colours tell the height and not the incidence. */
void picture_write(const char *file, const scan *s, const char *title, bool by_height);

#endif
