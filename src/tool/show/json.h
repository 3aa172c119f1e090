// SPDX-License-Identifier: MIT
/* json.h - values within objects and lists, as json; for what is no table.
 *
 * Each value has a key, or NULL in a list.  All is kept, and written at the end. */
#ifndef TOOL_JSON_H
#define TOOL_JSON_H
#include "table.h"

typedef struct json json;

json *json_begin(const table_target *target);

/* '{' or '['; lines: each value on a line of its own. */
void json_open(json *j, const char *key, char bracket, bool lines);
void json_close(json *j);

void json_number(json *j, const char *key, double value); /* NaN: null; infinities: "inf", "-inf" */
void json_count(json *j, const char *key, size_t value);
void json_truth(json *j, const char *key, bool value);
void json_word(json *j, const char *key, const char *text); /* NULL: null */

/* Writes it.  If the file cannot be written the command ends. */
void json_end(json *j);

#endif
