// SPDX-License-Identifier: MIT
/* table.h - a scan as rows, one for each pixel. */
#ifndef LINE_OF_SIGHT_TABLE_H
#define LINE_OF_SIGHT_TABLE_H
#include "scan.h"

#include <stdio.h>
#ifdef __cplusplus
extern "C" {
#endif

void table_csv(FILE *to, const scan *s);  /* every number reads back to the same double */
void table_text(FILE *to, const scan *s); /* for people: degrees to 1 cm on the ground, metres to 1 mm */

#ifdef __cplusplus
}
#endif
#endif
