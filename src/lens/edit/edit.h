/* edit.h - what the files of this room share. */
#ifndef SGT_LENS_EDIT_EDIT_H
#define SGT_LENS_EDIT_EDIT_H
#include "../open/open.h"
#include "../read/path.h"

#endif
