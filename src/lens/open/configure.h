// SPDX-License-Identifier: MIT
/* configure.h - the configurations of a lens: a tree with other values here and there. */
#ifndef SGT_LENS_CONFIGURE_H
#define SGT_LENS_CONFIGURE_H
#include "../read/lens.h"

enum { CONFIGURATIONS_MOST = 1000 };

/* The place of the value of `configurations` in the tree; NULL: it has none. */
node **sgt_configurations_place(const node *root);

/* Takes the list off the tree while the lens is made, and returns it: no reader looks into it. */
node *sgt_set_aside(source *s, node **place);

/* The remark that names them. */
void sgt_tell_configurations(source *s, const node *list);

/* Makes the lens of each, to see whether it is one; a fault ends the reading. */
void sgt_check_configurations(const whole_lens *w, source *s);

/* Turns the tree of s into that of a configuration, counted from 1; it then has no others. */
void sgt_configure(source *s, size_t number);

/* The same of the one that the options ask for; 0: nothing. */
void sgt_choose_configuration(source *s);

/* Behind a fault in the lens of a configuration: says of which, and by which of its paths. */
void sgt_blame_configuration(const source *s);

#endif
