// SPDX-License-Identifier: MIT
/* make.c - from a tree to a lens: of a file, of an edit, of a configuration. */
#include "open.h"

#include "conjugate.h"
#include "list.h"
#include "resolve.h"

#include <string.h>

/* Those that change the lens come first: what was left out, then what was turned into something else. */
static void sort_remarks(source *s)
{
    for (size_t i = 1; i < s->remarks; i++) { /* some dozens at most, and mostly in order */
        const sgt_lens_remark one = s->remark[i];
        size_t at = i;
        for (; at > 0 && s->remark[at - 1].kind < one.kind; at--) s->remark[at] = s->remark[at - 1];
        s->remark[at] = one;
    }
}

void sgt_take_over(whole_lens *w, source *s, const whole_lens *old)
{
    s->file = tree_text(s, s->file, strlen(s->file));
    s->folder = tree_text(s, old->folder, strlen(old->folder));
    s->root = tree_copy(s, old->root);
    for (size_t i = 0; i < old->comments; i++)
        tree_comment(s, tree_text(s, old->comment[i], strlen(old->comment[i])));
    for (size_t i = 0; i < old->imports; i++)
        tree_remark_again(s, &old->imported[i], old->imported[i].line, old->imported[i].key);
    w->make = old->make;
    w->media.before = &old->media;
}

void sgt_make_lens(whole_lens *w, source *s)
{
    w->media.source = s;
    w->lens.file = s->file;
    node **configurations = w->make == sgt_read_lens ? sgt_configurations_place(s->root) : NULL, *list = NULL;
    if (configurations) list = sgt_set_aside(s, configurations);
    const resolution *resolved = w->make == sgt_read_lens ? sgt_resolve(w, s) : NULL;
    sgt_lens_remark *imported = tree_room(s, s->remarks, sizeof *imported);
    if (s->remarks) memcpy(imported, s->remark, s->remarks * sizeof *imported);
    w->imported = imported, w->imports = s->remarks;
    w->make(w, s);
    if (w->make == sgt_read_lens) sgt_find_conjugates(w, s);
    sgt_end_resolution(resolved);
    if (list) *configurations = list, sgt_tell_configurations(s, list);
    sort_remarks(s);
    w->lens.remarks = s->remarks, w->lens.remark = s->remark;
    w->root = s->root, w->formula = s->formula, w->comment = s->comment, w->comments = s->comments;
    w->folder = s->folder, w->options = *s->options, w->options.allocator = NULL;
    w->options.configuration = 0; /* its tree is that of the one that was asked for */
}

void sgt_end_making(whole_lens *w, source *s)
{
    sgt_catalogue_free(s->own_glasses);
    w->media.source = NULL, w->media.before = NULL;
}
