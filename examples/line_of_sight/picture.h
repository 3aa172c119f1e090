// SPDX-License-Identifier: MIT
/* picture.h - the swath on a map, and what each ray cost. */
#ifndef LINE_OF_SIGHT_PICTURE_H
#define LINE_OF_SIGHT_PICTURE_H
#include "fail.h"
#include "scan.h"

#include <stdbool.h>
#include <stdio.h>

bool picture_can(void); /* was this built with cairo? */

/* A picture is written to FILE.part, which is renamed when it is whole. */
enum { PICTURE_NAME = 4096 };
static inline void picture_part(char part[PICTURE_NAME], const char *file)
{
    if (snprintf(part, PICTURE_NAME, "%s.part", file) >= PICTURE_NAME)
        fail_usage("--picture: a name too long");
}

/* A PNG; title: a line above it; by_height: colours tell the height and not the incidence. */
void picture_write(const char *file, const scan *s, const char *title, bool by_height);

#endif
