// SPDX-License-Identifier: MIT
/* film.h - what changes from frame to frame. */
#ifndef RENDER_FILM_H
#define RENDER_FILM_H
#include "scene.h"

/* Sets the scene to a frame, 0 ... frames - 1.  false: something is out of range there; `why` says what. */
enum { FILM_WHY = 200 };
bool film_set(scene *s, int frame, char why[FILM_WHY]);

/* How far along the camera's own paths that frame is, 0 ... 1. */
double film_along(const film *f, int frame);

#endif
