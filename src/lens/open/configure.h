// SPDX-License-Identifier: MIT
/* configure.h - the lenses of configurations: of a tree with other values here and there. */
#ifndef SGT_LENS_CONFIGURE_H
#define SGT_LENS_CONFIGURE_H
#include "list.h"
#include "open.h"

/* Makes the lens of each configuration of a lens that was made, to see whether it is one; a fault ends the
 * reading. */
void sgt_check_configurations(const whole_lens *w, source *s);

/* A lens that was read becomes that of the configuration which the options ask for; 0: nothing.  (A reader
 * may have made the tree of that one itself.)  false: there is none, and the error of s says so. */
bool sgt_choose_configuration(whole_lens *w, const source *s);

#endif
