// SPDX-License-Identifier: MIT
/* read.h - a scene from its file. */
#ifndef RENDER_READ_H
#define RENDER_READ_H
#include "scene.h"

/* Whatever is wrong with the file ends the program, with file, line and key. */
void read_scene(scene *s, const char *file);

/* Gives back what it holds. */
void scene_free(scene *s);

#endif
