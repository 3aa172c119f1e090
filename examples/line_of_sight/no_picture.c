// SPDX-License-Identifier: MIT
/* no_picture.c - where there is no cairo. */
#include "fail.h"
#include "picture.h"

bool picture_can(void) { return false; }

void picture_write(const char *file, const scan *s, const char *title, bool by_height)
{
    (void)s, (void)title, (void)by_height;
    fail_input("%s: built without cairo, which draws the pictures", file);
}
