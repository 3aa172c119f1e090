/* pictures.h - the pictures that a command is asked for: --picture, --svg, --plane. */
#ifndef TOOL_PICTURES_H
#define TOOL_PICTURES_H
#include "picture.h"

typedef struct pictures {
    const char *file, *svg;  /* of --picture and --svg; NULL: not given */
    const char *plane_given; /* NULL: none, then it is yz */
    view_plane plane;
    picture_kind kind; /* of `file` */
} pictures;

/* The help of the options. */
extern const char pictures_help[];

/* To be called when all options are taken.  Ends with a usage error if one of them is wrong. */
void pictures_check(pictures *p);

/* Is there any? */
bool pictures_wanted(const pictures *p);

/* Opens the files for writing, and notes what they will not show.  output: the path of --output, or NULL. */
void pictures_reserve(const pictures *p, const char *output, const job *j);

/* Draws them.  The scene is complete then. */
void pictures_write(const pictures *p, scene *s);

#endif
