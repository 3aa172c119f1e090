// SPDX-License-Identifier: MIT
/* passed.h - a ray that passed a lens, in short: a row for each element. */
#ifndef TOOL_PASSED_H
#define TOOL_PASSED_H
#include "../job/job.h"
#include "watched.h"

/* The table for it, as text. */
table *passed_begin(const table_target *target, const lens *l);
void passed_write(table *t, const job *j, const watched *w);

#endif
