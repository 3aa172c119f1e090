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

/* A lens that was read becomes that of the configuration which the options ask for; 0: nothing.  (A reader may
 * have made the tree of that one itself.)  false: there is none, and the error of s says so. */
bool sgt_choose_configuration(whole_lens *w, const source *s);

#endif
