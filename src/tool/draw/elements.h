// SPDX-License-Identifier: MIT
/* elements.h - draws the elements of a scene. */
#ifndef TOOL_ELEMENTS_H
#define TOOL_ELEMENTS_H
#include "page.h"

/* What lies behind the rays: glass, and in the view in space the faces of mirrors. */
void elements_fill(const page *p);

/* What lies before them: surfaces, stops, what apertures block. */
void elements_stroke(const page *p);

#endif
