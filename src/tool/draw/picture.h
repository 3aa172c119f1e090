// SPDX-License-Identifier: MIT
/* picture.h - writes a scene as a picture. */
#ifndef TOOL_PICTURE_H
#define TOOL_PICTURE_H
#include "kind.h"
#include "scene.h"

/* Writes the picture.  If it cannot be written the command ends. */
void picture_write(const char *file, picture_kind kind, const scene *s);

#endif
