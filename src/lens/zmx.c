/* zmx.c - .zmx files, as OpticStudio writes them. */
#include "tree.h"

void sgt_read_zmx(source *s) { tree_fail(s, 1, NULL, ".zmx files cannot be read yet"); }
