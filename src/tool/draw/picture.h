/* picture.h - a scene on a page. */
#ifndef TOOL_PICTURE_H
#define TOOL_PICTURE_H
#include "scene.h"

/* A usage error in a command that was built without cairo. */
void picture_check(void);

/* Writes an SVG file; one that cannot be written ends the command. */
void picture_write(const char *file, const scene *s);

#endif
