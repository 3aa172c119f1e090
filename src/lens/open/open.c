// SPDX-License-Identifier: MIT
/* open.c - from a file or text to a lens: which form it has, and one place where a reading ends.
 *
 * A fault anywhere jumps back to `read_by`, which frees what was read so far.  What a reading
 * takes is in the arena of the lens, but for a catalogue of glasses. */
#include "open.h"

#include "configure.h"

#include "../base/reader.h"
#include "../read/seq.h"

#include <stdio.h>
#include <string.h>

/* Other programs' files of lenses, which would be told what YAML they are not. */
static void refuse_other_formats(source *s, const char *name)
{
    reader r = {.at = s->text, .end = s->text + s->length};
    piece line;
    if (sgt_reader_line(&r, &line) && sgt_reader_is(sgt_reader_word(&line), "//") &&
        sgt_reader_is(sgt_reader_word(&line), "OSLO"))
        tree_fail(s, 1, NULL, "an OSLO file is not read; a lens file in YAML, .zmx and .seq are");
    static const char *const others[][2] = {
        {".len", "an OSLO or CODE V"}, {".zar", "an OpticStudio archive"},
        {".zos", "an OpticStudio session"}, {".zprj", "an OpticStudio project"}};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (sgt_reader_ends_in(name, others[i][0]))
            tree_fail(s, 0, NULL, "%s file (%s) is not read; a lens file in YAML, .zmx and .seq are",
                      others[i][1], others[i][0]);
}

/* Words become texts that end in a zero. */
static void refuse_zeros(source *s)
{
    const char *zero = s->length ? memchr(s->text, 0, s->length) : NULL;
    reader before = {.at = s->text, .end = zero};
    if (!zero) return;
    for (piece line; sgt_reader_line(&before, &line);) continue;
    tree_fail(s, before.line + (before.line == 0 || before.whole), NULL, "a zero byte; this is no text");
}

static void read_other(source *s, void (*read)(source *s))
{
    s->text = sgt_reader_decoded(s->arena, s->text, &s->length);
    if (!s->text) tree_fail(s, 0, NULL, "no memory");
    refuse_zeros(s);
    read(s);
}

/* VERS or MODE, or SURF and a number, begin one of the first lines. */
static bool looks_as_zmx(const char *text, size_t length)
{
    enum { LINES = 100 };
    reader r = {.at = text, .end = text + length};
    piece line;
    for (size_t lines = 0; lines < LINES && sgt_reader_line(&r, &line); lines++) {
        const piece word = sgt_reader_word(&line), value = sgt_reader_word(&line);
        double x;
        if (sgt_reader_is(word, "MODE") && sgt_reader_is(value, "SEQ")) return true;
        if ((sgt_reader_is(word, "SURF") || sgt_reader_is(word, "VERS")) && sgt_reader_number(value, &x))
            return true;
    }
    return false;
}

static bool is_of_key(char c) { return (sgt_lower(c) >= 'a' && sgt_lower(c) <= 'z') || c == '_'; }

/* A lens file begins with a key and its colon, or with {, % or ---: no line of the others does.  In its texts
 * there may be lines such as theirs. */
static bool begins_as_yaml(const char *text, size_t length)
{
    const size_t mark = length >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
    reader r = {.at = text + mark, .end = text + length};
    piece line, first = {NULL, NULL};
    while (sgt_reader_line(&r, &line)) {
        piece rest = line;
        first = sgt_reader_word(&rest);
        if (first.begin < first.end && *first.begin != '#') break;
    }
    if (first.begin == first.end || *first.begin == '#') return false;
    if (*first.begin == '{' || *first.begin == '%' || sgt_reader_is(first, "---")) return true;
    const char *c = first.begin;
    const char quote = *c == '"' || *c == '\'' ? *c++ : 0;
    const char *const key = c;
    while (c < line.end && is_of_key(*c)) c++;
    if (c == key || (quote && (c == line.end || *c++ != quote))) return false;
    while (c < line.end && (*c == ' ' || *c == '\t')) c++;
    return c < line.end && *c == ':' && (c + 1 == line.end || c[1] == ' ' || c[1] == '\t');
}

/* A name that ends as a lens file does is one; of any other the first lines decide, before its ending. */
static void (*reader_of(const source *s, const char *name))(source *s)
{
    static const char *const endings[] = {".yaml", ".yml", ".json"};
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
        if (sgt_reader_ends_in(name, endings[i])) return sgt_read_yaml;
    const bool other = !begins_as_yaml(s->text, s->length);
    if (other && looks_as_zmx(s->text, s->length)) return sgt_read_zmx;
    if (other && sgt_seq_looks(s->text, s->length)) return sgt_read_seq;
    if (sgt_reader_ends_in(name, ".zmx")) return sgt_read_zmx;
    return sgt_reader_ends_in(name, ".seq") ? sgt_read_seq : sgt_read_yaml;
}

/* The folder of a path, with what ends it; "" for the current one. */
static const char *folder_of_path(source *s, const char *path)
{
    size_t end = strlen(path);
#ifdef _WIN32
    while (end > 0 && path[end - 1] != '/' && path[end - 1] != '\\') end--;
#else
    while (end > 0 && path[end - 1] != '/') end--;
#endif
    return tree_text(s, path, end);
}

/* text NULL: that of the file `name`. */
static void read_into(lens_maker make, whole_lens *w, source *s, const char *name, const char *text,
                      size_t length)
{
    s->file = tree_text(s, name, strlen(name));
    s->folder = folder_of_path(s, name);
    if (!text) {
        const char *fault = tree_borrow(s, name, &s->borrowed, &length);
        if (fault) tree_fail(s, 0, NULL, "%s", fault);
        text = s->borrowed;
    }
    s->text = text, s->length = length;
    void (*read)(source *s) = make == sgt_read_lens ? reader_of(s, name) : sgt_read_yaml;
    if (make == sgt_read_lens && read != sgt_read_zmx)
        refuse_other_formats(s, read == sgt_read_yaml ? name : "");
    if (read == sgt_read_yaml) read(s);
    else read_other(s, read);
    w->make = make;
    sgt_make_lens(w, s);
    sgt_check_configurations(w, s);
}

static void refuse_later(source *s, const char *type, size_t place)
{
    tree_fail(s, 0, type, "the program asks for a member that sagitta %s has not: reserved_[%zu]",
              sgt_version(), place);
}

/* What is reserved for later versions has to be zero. */
static void check_options(source *s)
{
    const sgt_lens_options *o = s->options;
    for (size_t i = 0; i < sizeof o->reserved_ / sizeof *o->reserved_; i++)
        if (o->reserved_[i]) refuse_later(s, "sgt_lens_options", i);
    for (const sgt_builtin *b = o->types; b && b->type; b++) {
        for (size_t i = 0; i < sizeof b->reserved_ / sizeof *b->reserved_; i++)
            if (b->reserved_[i]) refuse_later(s, "sgt_builtin", i);
        for (const sgt_param *p = b->params; p->name; p++)
            for (size_t i = 0; i < sizeof p->reserved_ / sizeof *p->reserved_; i++)
                if (p->reserved_[i]) refuse_later(s, "sgt_param", i);
    }
}

static bool read_by(lens_maker make, whole_lens *w, source *s, const char *name, const char *text,
                    size_t length)
{
    jmp_buf here;
    s->refused = &here;
    if (setjmp(here) != 0) return false;
    check_options(s);
    read_into(make, w, s, name, text, length);
    return true;
}

static sgt_lens *lens_by(lens_maker make, const char *name, const char *text, size_t length,
                         const sgt_lens_options *opt, sgt_error *error)
{
    static const sgt_lens_options defaults = {0};
    sgt_error unread;
    if (!error) error = &unread;
    sgt_allocator a = sgt_allocator_or(opt ? opt->allocator : NULL);
    whole_lens *w = a.resize(a.context, NULL, sizeof *w);
    reader r = {.file = name, .error = error};
    if (!w) {
        sgt_reader_fail(&r, 0, "", "no memory");
        return NULL;
    }
    *w = (whole_lens){.memory = {.allocator = a}};
    source s = {.arena = &w->memory, .options = opt ? opt : &defaults, .error = error, .file = name};
    bool fine = read_by(make, w, &s, name, text, length);
    tree_return(&s, s.borrowed);
    sgt_end_making(w, &s);
    if (fine && make == sgt_read_lens) fine = sgt_choose_configuration(w, &s);
    if (fine) return &w->lens;
    sgt_lens_free(&w->lens);
    return NULL;
}

sgt_lens *sgt_lens_read(const char *path, const sgt_lens_options *opt, sgt_error *error)
{
    return lens_by(sgt_read_lens, path, NULL, 0, opt, error);
}

sgt_lens *sgt_lens_read_text(const char *name, const char *text, size_t length, const sgt_lens_options *opt,
                             sgt_error *error)
{
    return lens_by(sgt_read_lens, name, text, length, opt, error);
}

sgt_lens *sgt_lens_read_surface(const char *name, const char *text, const sgt_lens_options *opt,
                                sgt_error *error)
{
    return lens_by(sgt_read_one_surface, name, text, strlen(text), opt, error);
}

void sgt_lens_free(sgt_lens *lens)
{
    if (!lens) return;
    whole_lens *w = (whole_lens *)(void *)lens;
    sgt_allocator a = w->memory.allocator;
    sgt_free_phases(w);
    sgt_arena_free(&w->memory);
    a.resize(a.context, w, 0);
}

const char *sgt_lens_yaml(sgt_lens *lens, size_t *length)
{
    whole_lens *w = (whole_lens *)(void *)lens;
    static const sgt_lens_options defaults = {0};
    sgt_error unread;
    source s = {
        .arena = &w->memory, .options = &defaults, .error = &unread, .file = lens->file, .root = w->root,
        .comment = w->comment, .comments = w->comments};
    jmp_buf here;
    s.refused = &here;
    return setjmp(here) == 0 ? sgt_write_yaml(&s, length) : NULL;
}
