// SPDX-License-Identifier: MIT
/* list.h - the list `configurations` of a tree. */
#ifndef SGT_LENS_LIST_H
#define SGT_LENS_LIST_H
#include "../read/tree.h"

enum { CONFIGURATIONS_MOST = 1000 };

/* The place of its value in the tree; NULL: there is none. */
node **sgt_configurations_place(const node *root);

/* Takes the list off the tree while the lens is made, and returns it: no reader looks into it. */
node *sgt_set_aside(source *s, node **place);

/* The name of an entry, "" where not given; and is this key that of the name? */
const char *sgt_name_of_configuration(const node *map);
bool sgt_is_configuration_name(const node *key);

/* Checks the list, but for what its paths and values are, and remarks its names. */
void sgt_tell_configurations(source *s, const node *list);

#endif
