// SPDX-License-Identifier: MIT
/* document.h - a YAML file, read so that nothing in it is ignored in silence.
 *
 * A map is opened with the keys it may have; any other, or one given twice, is an error.
 * What is wrong ends the program with "file:line: key: what is wrong". */
#ifndef RENDER_DOCUMENT_H
#define RENDER_DOCUMENT_H
#include "fail.h"

#include <stdbool.h>
#include <stddef.h>
#include <yaml.h>

typedef yaml_node_t node;

typedef struct document {
    const char *file;
    yaml_document_t yaml;
} document;

void document_read(document *d, const char *file); /* d is kept until document_close */
void document_close(document *d);
node *document_root(document *d);

_Noreturn void document_fail(const document *d, const node *at, const char *key, const char *format, ...)
    LIKE_PRINTF(4, 5);

/* `map` is a map, called `name` where it is not, and has no keys but those in `known`,
 * which are parted by blanks. */
void document_map(document *d, const node *map, const char *name, const char *known);

/* The same of any keys: a map, of words, none of them twice. */
void document_keys(document *d, const node *map, const char *name);

/* Is the word one of those in the list, which are parted by blanks? */
bool document_is_among(const char *word, const char *list);

/* The i-th key of a map, and its value; NULL: there are no more. */
const node *document_key(document *d, const node *map, int i, const node **value);

node *document_find(document *d, const node *map, const char *key); /* NULL: absent */

/* Values; `key` is for the message.  All numbers are finite, from lo to hi. */
double document_number(const document *d, const node *n, const char *key, double lo, double hi);
int document_whole(const document *d, const node *n, const char *key, int lo, int hi);
const char *document_word(const document *d, const node *n, const char *key);
/* ends with NULL */
int document_choice(const document *d, const node *n, const char *key, const char *const words[]);

/* A list: how many items, from `least` to `most`; the i-th. */
int document_list(const document *d, const node *n, const char *key, int least, int most);
node *document_item(document *d, const node *n, int i);

/* A list of numbers; returns how many. */
int document_numbers(document *d, const node *n, const char *key, int least, int most, double lo, double hi,
                     double value[]);

#endif
