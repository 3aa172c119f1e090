// SPDX-License-Identifier: MIT
/* pictures.h - the picture that sagitta trace is asked for: --picture and --plane. */
#ifndef TOOL_PICTURES_H
#define TOOL_PICTURES_H
#include "picture.h"

typedef struct pictures {
    const char *file; /* of --picture; NULL: not given */
    int plane;        /* a view_plane + 1; 0: not given, then it is yz */
} pictures;

/* Ends with a usage error if one of them is wrong. */
void pictures_check(const pictures *p);

view_plane pictures_plane(const pictures *p);

/* Opens the file for writing, and notes what it will not show.  output: the path of --output, or NULL. */
void pictures_reserve(const pictures *p, const char *output, const job *j);

/* Draws it.  The scene is complete then. */
void pictures_write(const pictures *p, scene *s);

#endif
