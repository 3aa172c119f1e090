// SPDX-License-Identifier: MIT
/* edit.h - what the files of this room share: changes of a tree that is to become another lens. */
#ifndef SGT_LENS_EDIT_EDIT_H
#define SGT_LENS_EDIT_EDIT_H
#include "../open/open.h"
#include "../read/path.h"

/* What a change works on. */
typedef struct editing { source *s; const sgt_edit *edit; way at; } editing;

/* A path of the edit, taken apart. */
way sgt_edit_way(const editing *e, const char *path);

/* Says what is wrong with the edit. */
_Noreturn void sgt_edit_refuse(const editing *e, const char *words, ...) SGT_PRINTF(2, 3);

/* Says that the value of a key is the name of a file, whose numbers no edit changes. */
_Noreturn void sgt_edit_refuse_file(const editing *e, const node *n, const char *key);

/* The list `surfaces`; a fault if there is none. */
node *sgt_edit_surfaces(const editing *e);

/* references.c: pickups and tolerances name surfaces by their numbers.  Note what they mean before the list
 * of surfaces changes; say it again by the new numbers behind it. */
typedef struct reference {
    node *map;           /* of the pickup */
    size_t pickup;       /* the place of its key */
    node *entry, *in;    /* what it names, and the entry that it stands in (NULL: none) */
    const char *rest;    /* of its path, behind the entry */
    const char *own;     /* its own path, behind `in` */
    const char *path;    /* its own, whole */
    const node *word;    /* not NULL: it is no pickup but a surface of a tolerance, this number or name
                            in place `pickup` of `map`, a map or list */
    bool key;            /* or the key in place `pickup` of `map`, a configuration; it is `word` */
} reference;
typedef struct references { reference *at; size_t count, room; } references;
references sgt_edit_references(const editing *e);
void sgt_edit_refer(const editing *e, const references *all);

/* Refuses the edit if a configuration names a place in this list by its number.  Not of `surfaces`, whose
 * numbers are written anew. */
void sgt_edit_keep_places(const editing *e, const node *list);

/* insert.c, reverse.c, scale.c */
void sgt_edit_insert(const editing *e, node *value);
void sgt_edit_remove(const editing *e);
void sgt_edit_reverse(const editing *e);
void sgt_edit_scale(const editing *e);

/* The row of a surface's type; NULL: a break, a formula, an ideal lens, or none. */
const sgt_builtin *sgt_edit_type(const editing *e, const node *map);

#endif
