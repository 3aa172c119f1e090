// SPDX-License-Identifier: MIT
/* kind.h - the kinds of files that pictures are written as. */
#ifndef TOOL_KIND_H
#define TOOL_KIND_H

typedef enum picture_kind { PICTURE_SVG, PICTURE_PNG, PICTURE_PDF } picture_kind;

/* The kind that the ending of a file tells.  Ends with a usage error if it is none of .svg, .png and .pdf.
 * option: without its dashes. */
picture_kind picture_kind_of(const char *option, const char *path);

#endif
