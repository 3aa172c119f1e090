/* document.h - a YAML document as a tree that knows its lines, read so that nothing
 * is ignored in silence.
 *
 * A map is read by taking keys out of it; what is left at the end is an error:
 *
 *     document_map(d, node, key);              it is a map, and no key is taken yet
 *     node *radius = document_take(node, "radius");          NULL: absent
 *     document_finish(d, node, "radius");      "unknown key" for any other
 *
 * Every function ends the command with "source:line: key: what is wrong" (fail.h). */
#ifndef TOOL_DOCUMENT_H
#define TOOL_DOCUMENT_H
#include "../base/fail.h"

#include <stdbool.h>
#include <stddef.h>

typedef enum node_kind { NODE_SCALAR, NODE_LIST, NODE_MAP } node_kind;

typedef struct node {
    node_kind kind;
    size_t line;          /* counts from 1 */
    const char *text;     /* of a scalar */
    bool quoted;          /* a scalar in quotes: neither a number nor a truth value */
    size_t count;         /* of a list or map */
    struct node **item;   /* of a list; of a map: the values */
    struct node **key;    /* of a map */
    bool *taken;          /* of a map */
} node;

typedef struct document {
    const char *source;   /* a file, or the option that held the text */
    const char *folder;   /* of the file, with the / behind it; "" for the current one */
    node *root;
} document;

document document_parse(const char *source, const char *text, size_t length);

_Noreturn void document_fail(const document *d, const node *at, const char *key, const char *format, ...)
    LIKE_PRINTF(4, 5);

void document_map(const document *d, const node *n, const char *key);
node *document_take(const node *map, const char *key);
void document_finish(const document *d, const node *map, const char *known);

/* Values.  `key` is for the message.  The range says which of NaN and the infinities are allowed;
 * NUMBER_ANY is for callers that check the range themselves. */
typedef enum number_range { NUMBER_FINITE, NUMBER_MAYBE_INFINITE, NUMBER_ANY } number_range;
double document_number(const document *d, const node *n, const char *key, number_range range);
bool document_truth(const document *d, const node *n, const char *key);
const char *document_text(const document *d, const node *n, const char *key);

/* The path of a file; a relative name is looked for in the folder of the document. */
const char *document_path(const document *d, const node *n, const char *key);

/* A list of at least one number and at most `most`; returns how many. */
size_t document_numbers(const document *d, const node *n, const char *key, size_t most, double value[]);

#endif
