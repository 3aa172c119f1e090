// SPDX-License-Identifier: MIT
/* tree.h - the one form into which every reader of lens files turns its text: a tree of maps,
 * lists and words that know their lines.
 *
 * The keys are those of the lens file (docs/lens_file.md).  YAML is parsed into such a tree
 * (yaml.c), another format is translated into one (zmx.c), lens.c makes the lens of it, and
 * write.c writes it as YAML.  So a lens read from any format and the same lens imported and read
 * again are one.
 *
 * A map is read by taking keys out of it; what is left at the end is an error, so that nothing is
 * ignored in silence:
 *
 *     tree_map(s, n, key);                        it is a map, and no key is taken yet
 *     node *radius = tree_take(n, "radius");      NULL: absent
 *     tree_finish(s, n, "radius");                "unknown key" for any other
 *
 * ERRORS AND MEMORY.  A fault fills in the error and jumps (longjmp) to where the reading began,
 * which frees all memory of the reading: no function here returns a failure.  So a reader holds
 * nothing that is not in the arena while it calls any of them. */
#ifndef SGT_LENS_TREE_H
#define SGT_LENS_TREE_H
#include "../base/arena.h"

#include <setjmp.h>
#include <stdint.h>
#include <sagitta/lens.h>

#ifdef __GNUC__
#define SGT_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define SGT_PRINTF(text, first)
#endif

typedef enum node_kind { NODE_SCALAR, NODE_LIST, NODE_MAP } node_kind;

/* A lens of 10^5 surfaces has 10^6 scalars.  So they are small: of a scalar there are only the members up to
 * `room`, and its text stands right behind them. */
typedef struct node {
    node_kind kind : 8;
    bool quoted : 1;      /* a scalar in quotes: neither a number nor a truth value */
    bool inline_ : 1;     /* write.c: in one line, in brackets */
    bool number : 1;      /* a scalar that was read as a number */
    bool seen : 1, holds : 1; /* ../open/resolve.c: looked at; a pickup or solve is in it */
    bool over : 1;        /* ../open/configure.c: a configuration has put it there */
    uint32_t line;        /* counts from 1 */
    union {
        const char *text;   /* of a scalar; equal texts may be one */
        struct node **item; /* of a list; of a map: the values */
    };
    size_t count;         /* from here on of a list or map: a scalar ends in front of it */
    struct node **key;    /* of a map */
    bool *taken;          /* of a map */
    uint32_t room;
    uint32_t expression;  /* of a pickup or solve: its number from 1; 0: it is none */
    struct expressed *is; /* NULL: nothing is known of it */
} node;

/* What is known of a pickup or solve beside its map. */
typedef struct expressed {
    node *value;          /* what it is, once the lens is made */
    node *stored;         /* what an import has beside it; NULL: nothing */
    const char *record;   /* and where from */
    bool rules;           /* where both differ, the expression is taken */
} expressed;

/* Some texts of scalars that were met, by their hashes. */
typedef struct met_text { const char *text; size_t length; } met_text;
enum { TEXTS_MET = 64 };

/* The text of a surface that is a formula, and its parameters. */
typedef struct formula_text {
    const void *self;     /* of the surface */
    const char *text;
    const sgt_named *parameter;
    size_t count;
    struct formula_text *next;
} formula_text;

/* What is being read. */
typedef struct source {
    sgt_catalogue *own_glasses; /* the table that ships, once it is needed; to be freed */
    const char *file;     /* a file, or the option that held the text */
    const char *folder;   /* of the file, with the / behind it; "" for the current one */
    const char *text;     /* ends in a zero byte */
    size_t length;
    char *borrowed;       /* the file that it is of, until the reading ends; NULL: none */
    arena *arena;
    const sgt_lens_options *options;
    sgt_error *error;
    jmp_buf *refused;     /* where the reading began */
    size_t only_line;     /* of all nodes of the text, where it is a piece of a file; 0: their own */
    node *root;
    met_text met[TEXTS_MET];
    bool in_lens;         /* not one surface alone */
    bool varies;          /* vary.c reads one of several configurations */
    const node *chosen;   /* ../open/configure.c: the configuration that the tree is of; NULL: none */
    size_t chosen_number; /* from 1 */
    sgt_lens_remark *remark;
    size_t remarks, remark_room;
    formula_text *formula; /* those that have been read, the last one first */
    const char **comment; /* lines at the head of the file, for people */
    size_t comments, comment_room;
} source;

/* The words are a sentence without a full stop.  key NULL: none. */
_Noreturn void tree_fail(source *s, size_t line, const char *key, const char *words, ...) SGT_PRINTF(4, 5);
/* Words of a thing that was turned are put behind "taken as ", of one left out behind "left out: ". */
void tree_remark(source *s, sgt_remark_kind kind, size_t line, const char *key, const char *words, ...)
    SGT_PRINTF(5, 6);

/* The same remark of another reading, at another line. */
void tree_remark_again(source *s, const sgt_lens_remark *r, size_t line, const char *key);

void tree_comment(source *s, const char *text); /* kept as it is */

/* Memory of the reading, zeroed; without memory the reading fails. */
void *tree_room(source *s, size_t count, size_t size);
/* A block of `count` things with room for one more: if count has reached *room, room doubles. */
void *tree_grow(source *s, void *old, size_t count, size_t *room, size_t size);
char *tree_text(source *s, const char *text, size_t length);
char *tree_print(source *s, const char *words, ...) SGT_PRINTF(2, 3);

/* ---------------------------------------------------------------- building */

node *tree_node(source *s, node_kind kind, size_t line);             /* a list or map */
node *tree_scalar(source *s, size_t line, const char *text, size_t length);
void tree_expect(source *s, node *n, size_t more);   /* so many come, and room is made for no more */
void tree_append(source *s, node *list, node *item);
void tree_put(source *s, node *map, node *key, node *value);         /* at the end of the map */
void tree_remove(node *from, size_t place);                           /* of a list or map */
void tree_set(source *s, node *map, const char *key, node *value);
node *tree_word(source *s, size_t line, const char *text);           /* as it stands */
node *tree_number(source *s, size_t line, double x);                 /* reads back to the same bits */
node *tree_numbers(source *s, size_t line, size_t count, const double x[]);  /* an inline list */
node *tree_copy(source *s, const node *n); /* of all below it; nothing is shared */
void tree_forget_numbers(node *n);         /* that they were read */

/* ----------------------------------------------------------------- reading */

void tree_map(source *s, const node *n, const char *key);
node *tree_take(const node *map, const char *key);
void tree_finish(source *s, const node *map, const char *known);

/* Values.  `key` is for the message.  The range says which of NaN and the infinities are allowed;
 * NUMBER_ANY is for callers that check the range themselves. */
void tree_mark_number(const node *n); /* it was read as a number */
typedef enum number_range { NUMBER_FINITE, NUMBER_MAYBE_INFINITE, NUMBER_ANY } number_range;
double tree_read_number(source *s, const node *n, const char *key, number_range range);
bool tree_read_truth(source *s, const node *n, const char *key);
const char *tree_read_text(source *s, const node *n, const char *key);

/* The path of a file; a relative name is looked for in the folder of the source. */
const char *tree_read_path(source *s, const node *n, const char *key);

/* A list of at least one number and at most `most`; returns how many. */
size_t tree_read_numbers(source *s, const node *n, const char *key, size_t most, double value[]);

/* The file at `path`, whole, as the options say files are read; ends in a zero byte.  Returns NULL, or
 * why it cannot be read. */
const char *tree_file(source *s, const char *path, char **text, size_t *length);

/* The same, not in memory of the reading: to be returned, also after a fault (NULL may be). */
const char *tree_borrow(source *s, const char *path, char **text, size_t *length);
void tree_return(source *s, char *text);

/* --------------------------------------------------------------- the formats */

/* Each sets s->root from s->text. */
void sgt_read_yaml(source *s);
void sgt_read_zmx(source *s);  /* s->text is UTF-8, without a zero byte; so also */
void sgt_read_seq(source *s);

/* The tree as YAML, in memory of the reading. */
char *sgt_write_yaml(source *s, size_t *length);

/* A part of it in one line. */
char *sgt_write_line(source *s, const node *n, size_t *length);

#endif
