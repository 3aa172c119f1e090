// SPDX-License-Identifier: MIT
/* seq.c - lenses as sequence files of CODE V, .seq.
 *
 * THE TEXT.  Commands end with their line or a semicolon; & at the end of a line goes on in the next; !
 * begins a comment, but not in quotes.  The case of letters does not matter.  Of a command's word the first
 * three letters count; words of one and two letters are whole.  Behind it come qualifiers (S3, S2..5, SO, SI,
 * SS, Z2, F2, W1, C1, L'name', EDG ...), and then values.  A command of a surface without a qualifier is of
 * the surface that was opened last: SO is the object, S the next one, SI the image.  Later commands overwrite
 * earlier ones, so all of the file is read before anything is made of it.
 *
 * The format is not published in whole.  What its commands mean is known from files that CODE V wrote, from
 * readers of other programs, and from traces of both that agree.  Where those are silent or differ, a remark
 * says what was taken, or the file is refused with the name of the command: a wrong lens is worse than none.
 *
 * NOTHING IN SILENCE.  The tables of seq_system.c and seq_surface.c say of each command what becomes of it. A
 * command in none of them is an error among the surfaces, where it may be a shape, and elsewhere a remark.
 *
 * ZOOM.  The plain commands hold position 1.  ZOO COMMAND v1 ... vn is read as COMMAND with the value of the
 * position that is wanted, and a command with the qualifier Zk only where k is that.  A plain one of the same
 * name behind it is refused.
 *
 * FILES THAT ARE CUT OFF.  A number that is cut off is a number, too: so a command that is read needs an end
 * of line, or a semicolon.  A file without SI is refused, and one without GO behind it gets a note.
 *
 * Each character is looked at once, and what is kept is of the size of the text. */
#include "seq.h"
#include "vary.h"

#include <stdint.h>
#include <string.h>

/* ------------------------------------------------------------------- words */

static bool ends_line(char c) { return c == '\n' || c == '\r'; }
static bool is_space(char c) { return (unsigned char)c <= ' ' && !ends_line(c); }
static bool is_digit(char c) { return c >= '0' && c <= '9'; }
static bool is_letter(char c) { return sgt_lower(c) >= 'a' && sgt_lower(c) <= 'z'; }

/* Is there nothing but blanks, or a comment, from here to the end of the line? */
static bool nothing_more(const seq *q, const char *c)
{
    while (c < q->end && is_space(*c)) c++;
    return c == q->end || ends_line(*c) || *c == '!';
}

static void skip_line(seq *q)
{
    while (q->at < q->end && !ends_line(*q->at)) q->at++;
}

/* Past an end of line; false: the text ends. */
static bool end_line(seq *q)
{
    if (q->at == q->end) return false;
    const bool both = *q->at == '\r' && q->at + 1 < q->end && q->at[1] == '\n';
    q->at += both ? 2 : 1;
    q->line++;
    return true;
}

static piece quoted_word(seq *q)
{
    const char quote = *q->at++;
    piece word = {q->at, q->at};
    while (word.end < q->end && *word.end != quote && !ends_line(*word.end)) word.end++;
    q->at = word.end < q->end && *word.end == quote ? word.end + 1 : word.end;
    return word;
}

/* Where an & ends the line, a line of nothing but & is looked at once: what is behind it decides. */
static piece plain_word(seq *q)
{
    piece word = {q->at, q->at};
    /* L'front side', a label with blanks */
    if (q->end - q->at > 2 && sgt_lower(*q->at) == 'l' && (q->at[1] == '\'' || q->at[1] == '"')) {
        const char *c = q->at + 2;
        while (c < q->end && *c != q->at[1] && !ends_line(*c)) c++;
        if (c < q->end && *c == q->at[1]) {
            word.end = q->at = c + 1;
            return word;
        }
    }
    for (const char *c = q->at; c < q->end && !is_space(*c) && !ends_line(*c) && *c != ';' && *c != '!';
         c++) {
        if (*c == '&' && nothing_more(q, c + 1)) break;
        word.end = c + 1;
    }
    q->at = word.end;
    return word;
}

/* The words of the next command, perhaps none; false: the text ends. */
static bool next_command(seq *q)
{
    q->words = 0, q->next = 1, q->whole = true;
    for (;;) {
        while (q->at < q->end && is_space(*q->at)) q->at++;
        if (q->at < q->end && *q->at == '!') skip_line(q);
        if (q->at == q->end) {
            q->whole = false;
            return q->words > 0;
        }
        if (*q->at == '&' && nothing_more(q, q->at + 1)) {
            skip_line(q);
            end_line(q);
            continue;
        }
        if (ends_line(*q->at)) return end_line(q);
        if (*q->at == ';') return q->at++, true;
        seq_word w = {.line = q->line, .quoted = *q->at == '"' || *q->at == '\''};
        w.text = w.quoted ? quoted_word(q) : plain_word(q);
        q->word = tree_grow(q->s, q->word, q->words, &q->word_room, sizeof *q->word);
        q->word[q->words++] = w;
    }
}

/* -------------------------------------------------------------- qualifiers */

/* Digits to the end, or to `..`; *number 0: none. */
static const char *digits_to(piece text, const char *at, size_t *number)
{
    *number = 0;
    const char *begin = at;
    while (at < text.end && is_digit(*at) && at - begin < 7) *number = 10 * *number + (size_t)(*at++ - '0');
    return at > begin ? at : NULL;
}

static size_t surface_there(seq *q, size_t number, size_t line)
{
    if (number >= q->count) tree_fail(q->s, line, q->row->name, "there is no surface %zu here", number);
    return number;
}

/* S3, S2..5, S2..S5, SO, SI, SS; false: it is none of these. */
static bool surface_qualifier(seq *q, const seq_word *w)
{
    const piece t = w->text;
    const bool image = sgt_seq_is(t, "si"), stop = sgt_seq_is(t, "ss");
    size_t from = 0, to = 0;
    if (image && !q->image_line) tree_fail(q->s, w->line, q->row->name, "SI stands before the image surface");
    if (stop && !q->stop) tree_fail(q->s, w->line, q->row->name, "SS stands before the stop is said");
    if (image || stop || sgt_seq_is(t, "so")) {
        from = to = image ? q->count - 1 : stop ? q->stop : 0;
    } else {
        if (t.end - t.begin < 2 || sgt_lower(*t.begin) != 's') return false;
        const char *at = digits_to(t, t.begin + 1, &from);
        if (!at) return false;
        to = from;
        if (t.end - at > 2 && at[0] == '.' && at[1] == '.') {
            at += 2;
            if (sgt_lower(*at) == 's') at++;
            at = digits_to(t, at, &to);
        }
        if (at != t.end) return false;
    }
    q->from = surface_there(q, from, w->line), q->to = surface_there(q, to, w->line), q->placed = true;
    if (q->to < q->from) tree_fail(q->s, w->line, q->row->name, "a range that runs backwards");
    return true;
}

static bool numbered_qualifier(seq *q, piece t)
{
    static const char letters[] = "zfwc";
    size_t *const to[] = {&q->zoom, &q->field, &q->term, &q->term};
    const char *which = t.begin < t.end ? memchr(letters, sgt_lower(*t.begin), sizeof letters - 1) : NULL;
    size_t number;
    if (!which || digits_to(t, t.begin + 1, &number) != t.end || number == 0) return false;
    *to[which - letters] = number;
    return true;
}

static bool class_qualifier(seq *q, piece t)
{
    static const char *const names[] = {"clr", "obs", "edg", "hol"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (!sgt_seq_is(t, names[i])) continue;
        q->class = (seq_class)i, q->classed = true;
        return true;
    }
    return false;
}

/* L'name' is one word with its quotes. */
static bool label_qualifier(seq *q, piece t)
{
    if (t.end - t.begin < 3 || sgt_lower(*t.begin) != 'l' || (t.begin[1] != '\'' && t.begin[1] != '"'))
        return false;
    q->label = (piece){t.begin + 2, t.end - (t.end[-1] == t.begin[1])};
    return true;
}

static void forget_qualifiers(seq *q)
{
    q->placed = q->classed = false, q->class = SEQ_CLEAR, q->label = (piece){NULL, NULL};
    q->zoom = q->field = q->term = 0;
    q->from = q->to = q->current;
}

static void read_qualifiers(seq *q)
{
    for (; q->next < q->words; q->next++) {
        const seq_word *w = &q->word[q->next];
        if (w->quoted || !(surface_qualifier(q, w) || numbered_qualifier(q, w->text) ||
                           class_qualifier(q, w->text) || label_qualifier(q, w->text)))
            return;
    }
}

/* ---------------------------------------------------------------- commands */

static const seq_table *const command_tables[] = {&sgt_seq_surface_commands, &sgt_seq_system_commands};
enum { TABLES = 2 };

/* S, or S with a number. */
static bool opens_surface(piece word)
{
    size_t number;
    return sgt_seq_is(word, "s") || (word.end - word.begin > 1 && sgt_lower(*word.begin) == 's' &&
                                     digits_to(word, word.begin + 1, &number) == word.end);
}

static const seq_command *command_of(const seq_word *w, size_t *table)
{
    enum { WHOLE = 2, SHORT = 3 };
    const size_t length = (size_t)(w->text.end - w->text.begin);
    const bool opens = !w->quoted && opens_surface(w->text);
    for (const char *c = w->text.begin; c < w->text.end && !opens; c++) {
        const bool third = length == SHORT && c == w->text.begin + 2;
        const bool beam = third && sgt_lower(*w->text.begin) == 'h'; /* HX1 */
        if (!is_letter(*c) && !(beam && (*c == '1' || *c == '2'))) return NULL;
    }
    if (w->quoted) return NULL;
    const size_t letters = opens ? 1 : length > SHORT ? SHORT : length;
    for (*table = 0; *table < TABLES; ++*table)
        for (size_t i = 0; i < command_tables[*table]->count; i++) {
            const char *name = command_tables[*table]->command[i].name;
            size_t k = 0;
            while (k < letters && name[k] && sgt_lower(name[k]) == sgt_lower(w->text.begin[k])) k++;
            if (k == letters && !name[k]) return &command_tables[*table]->command[i];
        }
    return NULL;
}

static void count_once(seq_count *c, const char *key, size_t line)
{
    if (c->count++ == 0) c->line = line, c->key = key;
}

/* In front of the surfaces and behind them it does not say a shape. */
static void count_stranger(seq *q)
{
    const seq_word *w = &q->word[0];
    const piece key = {w->text.begin, w->text.begin + sgt_reader_width(w->text)};
    bool of_surface = q->count && !q->image_line;
    if (q->words > 1 && q->count) {
        const piece t = q->word[1].text;
        of_surface = of_surface || sgt_seq_is(t, "si") || sgt_seq_is(t, "so") || sgt_seq_is(t, "ss") ||
                     (t.end - t.begin > 1 && sgt_lower(*t.begin) == 's' && is_digit(t.begin[1]));
    }
    if (of_surface)
        tree_fail(q->s, w->line, sgt_seq_copy(q, key),
                  "this command of a surface is not known; it may say a shape, so the lens is not read");
    for (size_t i = 0; i < q->unknowns; i++)
        if (sgt_reader_is(key, q->unknown[i].key)) {
            q->unknown[i].count++;
            return;
        }
    if (q->unknowns < SEQ_UNKNOWN)
        q->unknown[q->unknowns++] = (seq_count){sgt_seq_copy(q, key), w->line, 1};
    else if (q->others++ == 0)
        q->others_line = w->line;
}

/* A qualifier says of what a value is.  One that a command does not have would be dropped in silence. */
static void require_qualifiers(seq *q, size_t table)
{
    const unsigned with = q->row->which;
    const char *wrong = NULL;
    if (q->placed && (table > 0 || (with & SEQ_NO_SURFACE))) wrong = "a surface";
    if (q->field && !(with & SEQ_F)) wrong = "a field, F";
    if (q->term && !(with & SEQ_W)) wrong = "a wavelength or term, W or C";
    if ((q->classed || q->label.begin) && !(with & SEQ_L)) wrong = "an aperture, CLR, OBS, EDG, HOL or L";
    if (wrong)
        tree_fail(q->s, sgt_seq_line(q), q->row->name, "what it means with the qualifier of %s, is not known",
                  wrong);
}

static void read_zoom(seq *q);

static void carry_out(seq *q, size_t table)
{
    const seq_command *c = q->row;
    const size_t place = (size_t)(c - command_tables[table]->command), line = sgt_seq_line(q);
    if (!q->whole && c->fate != SEQ_TEXT && c->fate != SEQ_IDLE)
        tree_fail(q->s, line, c->name, "the file ends in the middle of this line; is it cut off?");
    if (c->fate == SEQ_REFUSED) tree_fail(q->s, line, c->name, "is not read: %s", c->why);
    if (c->fate == SEQ_OPTION) q->option_line = line;
    if (c->fate < SEQ_READ) {
        count_once(&q->met[table][place], c->name, line);
        return;
    }
    forget_qualifiers(q);
    if (table == 0 || c->fate != SEQ_TEXT) read_qualifiers(q);
    require_qualifiers(q, table);
    if (table == 0 && !opens_surface(q->word[0].text) && !sgt_seq_is(q->word[0].text, "so") && q->count == 0)
        tree_fail(q->s, line, c->name, "this command of a surface stands before the first surface");
    size_t *const own = &q->zoomed_row[table][place];
    if (q->zooms || q->zoom)
        *own = line;
    else if (*own)
        tree_fail(q->s, line, c->name,
                  "stands behind line %zu, which zooms it: of which position it is, is not known", *own);
    if (q->zoom && q->zoom != q->position) {
        if (q->zoomed++ == 0) q->zoomed_line = line;
        return;
    }
    if (c->fate == SEQ_ZOOM)
        read_zoom(q);
    else
        c->read(q);
    if (q->next < q->words) count_once(&q->extra[table][place], c->name, q->word[q->next].line);
}

static void read_command(seq *q)
{
    size_t table;
    if (!q->first) q->first = sgt_seq_line(q);
    if (q->ended) {
        if (q->behind++ == 0) q->behind_line = sgt_seq_line(q);
        return;
    }
    q->row = command_of(&q->word[0], &table);
    if (q->option_line) {
        if (q->row && strcmp(q->row->name, "GO") == 0) q->option_line = 0;
    } else if (q->in_private) {
        sgt_seq_read_private(q);
    } else if (q->row) {
        carry_out(q, table);
    } else {
        count_stranger(q);
    }
}

/* -------------------------------------------------------------------- zoom */

/* ZOO n, or ZOO COMMAND qualifiers v1 ... vn. */
static void read_zoom(seq *q)
{
    double x;
    size_t table;
    const size_t line = sgt_seq_line(q);
    if (q->words == 2 && sgt_seq_number_of(q->word[1].text, &x)) {
        q->positions = sgt_seq_whole(q, 1), q->positions_line = line;
        return;
    }
    if (!q->positions) tree_fail(q->s, line, "ZOO", "stands before the number of positions, ZOO n");
    if (q->position > q->positions)
        tree_fail(q->s, q->positions_line, "ZOO", "there are %zu positions; there is no number %zu",
                  q->positions, q->position);
    const seq_command *c = q->words > 1 ? command_of(&q->word[1], &table) : NULL;
    if (c && c->fate == SEQ_TEXT && (strcmp(c->name, "TIT") == 0 || strcmp(c->name, "SLB") == 0)) {
        tree_remark(q->s, SGT_REMARK_LEFT_OUT, line, "ZOO", "a %s of each position: no ray depends on it",
                    c->name);
        q->next = q->words;
        return;
    }
    if (!c || c->fate == SEQ_OPTION || c->fate > SEQ_READ || (c->fate == SEQ_READ && !(c->which & SEQ_Z)))
        tree_fail(q->s, line, "ZOO", "how \"%.*s\" is zoomed is not known",
                  q->words > 1 ? sgt_reader_width(q->word[1].text) : 0,
                  q->words > 1 ? q->word[1].text.begin : "");
    q->row = c, q->next = 2;
    forget_qualifiers(q);
    read_qualifiers(q);
    const size_t first = q->next;
    if (q->words - first != q->positions)
        tree_fail(q->s, line, "ZOO", "%s has %zu values behind it, and not %zu, one for each position",
                  c->name, q->words - first, q->positions);
    const seq_word value = q->word[first + q->position - 1];
    for (size_t i = 1; i < first; i++) q->word[i - 1] = q->word[i];
    q->word[first - 1] = value, q->words = first, q->next = 1;
    if (table == 0 && c->fate == SEQ_READ && !q->placed)
        tree_fail(q->s, line, "ZOO", "%s needs the number of its surface, such as S2", c->name);
    q->zooms = true;
    carry_out(q, table);
    q->zooms = false, q->next = q->words;
    if (q->zoomed++ == 0) q->zoomed_line = line;
}

static void require_position(seq *q)
{
    const size_t positions = q->positions ? q->positions : 1;
    if (q->position > positions)
        tree_fail(q->s, q->positions_line ? q->positions_line : q->first, "ZOO",
                  "there %s %zu position%s of a zoom; there is no number %zu", positions == 1 ? "is" : "are",
                  positions, positions == 1 ? "" : "s", q->position);
    if (positions > 1 && q->s->options->configuration)
        tree_remark(q->s, SGT_REMARK_NOTE, q->positions_line, "ZOO", "position %zu of %zu of the zoom",
                    q->position, positions);
    else if (positions == 1 && q->zoomed)
        tree_remark(q->s, SGT_REMARK_LEFT_OUT, q->zoomed_line, "ZOO",
                    "what is said of other positions of a zoom");
}

/* ----------------------------------------------------------------- remarks */

static void tell_count(seq *q, sgt_remark_kind kind, const seq_count *c, const char *words)
{
    if (c->count == 1) tree_remark(q->s, kind, c->line, c->key, "%s", words);
    if (c->count > 1) tree_remark(q->s, kind, c->line, c->key, "%s (%zu times)", words, c->count);
}

static void tell_commands(seq *q)
{
    for (size_t table = 0; table < TABLES; table++)
        for (size_t i = 0; i < command_tables[table]->count; i++) {
            const seq_command *c = &command_tables[table]->command[i];
            const seq_count *met = &q->met[table][i];
            if (c->fate == SEQ_SOLVE)
                tell_count(q, SGT_REMARK_TURNED, met, "the number that is stored: it is a solve or pickup");
            if (c->fate == SEQ_LEFT)
                tell_count(q, SGT_REMARK_LEFT_OUT, met, c->why ? c->why : "this command");
            if (c->fate == SEQ_OPTION)
                tell_count(q, SGT_REMARK_LEFT_OUT, met, "this option, with what stands up to its GO");
            tell_count(q, SGT_REMARK_LEFT_OUT, &q->extra[table][i], "what stands behind its values");
        }
    for (size_t i = 0; i < q->unknowns; i++)
        tell_count(q, SGT_REMARK_LEFT_OUT, &q->unknown[i], "an unknown command");
    if (q->others)
        tree_remark(q->s, SGT_REMARK_LEFT_OUT, q->others_line, "commands", "%zu more unknown ones",
                    q->others);
    if (q->behind)
        tree_remark(q->s, SGT_REMARK_LEFT_OUT, q->behind_line, "GO",
                    "%zu command%s behind the GO that ends the lens", q->behind, q->behind == 1 ? "" : "s");
    if (!q->ended)
        tree_remark(q->s, SGT_REMARK_NOTE, q->image_line, "GO",
                    "none behind the lens, where CODE V writes one: the file may be cut off");
}

/* ---------------------------------------------------------------- the file */

static void require_image(seq *q, size_t last)
{
    if (q->in_private)
        tree_fail(q->s, q->private_line, "PRV", "there is no END of these glasses; is it cut off?");
    if (q->count == 0)
        tree_fail(q->s, q->first ? q->first : 1, NULL,
                  "no surface is in this file (no SO): it is no sequence file of CODE V");
    if (!q->image_line) tree_fail(q->s, last, "SI", "there is no image surface; is the file cut off?");
    if (q->count == 2)
        tree_fail(q->s, q->image_line, "SI", "there is no surface between the object and the image");
}

void sgt_read_seq(source *s)
{
    seq *q = tree_room(s, 1, sizeof *q);
    const int wanted = s->options ? s->options->configuration : 0;
    size_t last = 1;
    q->s = s, q->at = s->text, q->end = s->text + s->length, q->line = 1, q->fields = -1;
    q->position = wanted > 0 ? (size_t)wanted : 1;
    while (next_command(q)) {
        if (!q->words) continue;
        last = q->word[q->words - 1].line;
        read_command(q);
    }
    require_image(q, last);
    if (wanted < 0) tree_fail(s, q->first, "ZOO", "there is no position %d of a zoom", wanted);
    require_position(q);
    s->root = tree_node(s, NODE_MAP, q->first);
    sgt_seq_write_system(q, s->root);
    sgt_seq_write_surfaces(q, s->root);
    tell_commands(q);
    s->chosen_number = (size_t)wanted; /* the tree is that of this one */
    if (!wanted && q->positions > 1)
        sgt_vary(s, q->positions, q->positions_line, "ZOO", "position of the zoom", sgt_read_seq);
}

/* ---------------------------------------------------------------- the look */

/* SO and a number, RDM, or LEN without a colon begin one of the first commands. */
bool sgt_seq_looks(const char *text, size_t length)
{
    enum { LINES = 200 };
    reader r = {.at = text, .end = text + length};
    piece line;
    for (size_t lines = 0; lines < LINES && sgt_reader_line(&r, &line); lines++) {
        piece rest = line;
        const piece word = sgt_reader_word(&rest), value = sgt_reader_word(&rest);
        double x;
        if (sgt_seq_is(word, "so") && sgt_seq_number_of(value, &x)) return true;
        if (sgt_seq_is(word, "rdm;len") || sgt_seq_is(word, "rdm") || sgt_seq_is(word, "rdm;")) return true;
        if (sgt_seq_is(word, "len") && (value.begin == value.end || sgt_seq_is(value, "new"))) return true;
    }
    return false;
}
