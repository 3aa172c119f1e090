/* picture.h - writes a scene as a picture. */
#ifndef TOOL_PICTURE_H
#define TOOL_PICTURE_H
#include "scene.h"

typedef enum picture_kind { PICTURE_SVG, PICTURE_PNG, PICTURE_PDF } picture_kind;

/* The kind that the ending of a file tells.  Ends with a usage error if it is none of .svg, .png and .pdf.
 */
picture_kind picture_kind_of(const char *option, const char *path);

/* Ends with a usage error if the command was built without cairo. */
void picture_check(const char *option);

/* Writes the picture.  If it cannot be written the command ends. */
void picture_write(const char *file, picture_kind kind, const scene *s);

#endif
