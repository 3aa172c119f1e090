// SPDX-License-Identifier: MIT
/* vary.h - the configurations of a file of another program as those of a lens file. */
#ifndef SGT_LENS_VARY_H
#define SGT_LENS_VARY_H
#include "tree.h"

/* Reads the text of s once for each of `count` configurations by `read`, which takes options.configuration,
 * and puts `configurations` into s->root: what each tree has that s->root, the base, has not.
 *
 *     line   of the record that says how many there are
 *     key    that record
 *     what   "position of the zoom", for the message of a fault
 *
 * false: nothing is put, and a remark says why. */
bool sgt_vary(source *s, size_t count, size_t line, const char *key, const char *what,
              void (*read)(source *s));

#endif
