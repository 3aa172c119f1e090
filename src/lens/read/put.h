// SPDX-License-Identifier: MIT
/* put.h - a place for a value in the tree of a lens, by its path: what edits and configurations share. */
#ifndef SGT_LENS_PUT_H
#define SGT_LENS_PUT_H
#include "path.h"

/* Where a path leads.  Maps on the way that are missing are made; a key that the map has not is added, or
 * takes the place of one that says the same in another way (sgt_path_rival).
 *
 *     path  the text of p, for the message of a fault
 *     line  of a key that is new, and of a fault; 0: that of what stands there
 *     old   written: what stands there or stood there under another key; NULL: nothing
 *
 * The place has NULL in it if the key is new, or was another. */
node **sgt_put_place(source *s, const way *p, const char *path, size_t *line, node **old);

#endif
