// SPDX-License-Identifier: MIT
/* path.h - paths: places in the tree of a lens as people say them (sagitta/edit.h). */
#ifndef SGT_LENS_PATH_H
#define SGT_LENS_PATH_H
#include "tree.h"

#include <sagitta/edit.h>

/* One step down: a key of a map, or of a list a place from 1 or a name. */
typedef struct path_step {
    const char *text;     /* the key or name; NULL: a place */
    size_t length, place; /* of the text; from 1 */
    bool name;
} path_step;

/* Where the surfaces and the breaks are in the list `surfaces`, for those who follow many paths. */
typedef struct places { const node *list; size_t surfaces, breaks, *surface, *lies; } places;
places sgt_path_places(source *s, const node *root);

enum { PATH_STEPS = 16, PATH_WHY = 240 };
typedef struct way {
    path_step step[PATH_STEPS];
    size_t count;
    const places *known; /* NULL: they are counted at each path */
} way;

/* A place in the tree. */
typedef struct spot {
    node *in;     /* the list or map */
    size_t at;    /* the place there, from 0 */
    node *is;     /* what stands there; NULL: a map that has not the key */
    bool surface; /* an entry of `surfaces` */
} spot;

/* Takes a path apart.  false: `why` says what is wrong; the path borrows from the text. */
bool sgt_path_read(way *p, const char *text, char why[PATH_WHY]);

/* Finds it.  Of the last step the key may be missing.  false: `why`.  count: of the steps, those to go. */
bool sgt_path_find(node *root, const way *p, size_t count, spot *out, char why[PATH_WHY]);

/* What stands at a path; NULL: `why`.  *inverse: it is the curvature of a radius, or the other way round. */
node *sgt_path_value(node *root, const way *p, bool *inverse, char why[PATH_WHY]);

bool sgt_step_is(const path_step *step, const char *key);

/* A key that says the same as `key` in another way, number i from 0; NULL: none is left.  in_pupil: of the
 * map `pupil`.  room: for the words. */
enum { PATH_KEY = 80 };
const char *sgt_path_rival(const char *key, bool in_pupil, int i, char room[PATH_KEY]);

/* Calls `each` for every number that the reader has read (node.number), in the order of the tree. */
void sgt_path_numbers(const node *root, void (*each)(void *context, const char *path, const node *n),
                      void *context);

/* The number of a node that has one: as it stands, that of a spectral line, of a pickup or solve. */
bool sgt_path_number(const node *n, double *x);

#endif
