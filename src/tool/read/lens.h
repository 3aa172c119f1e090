/* lens.h - a lens file as a row of elements, at one of its wavelengths. */
#ifndef TOOL_LENS_H
#define TOOL_LENS_H
#include "document.h"

#include <sagitta/surfaces.h>
#include <sagitta/system.h>

typedef struct lens_surface {
    const char *type;     /* as the file names it */
    double index;         /* behind it, positive, after a mirror too */
    double z;             /* its vertex on the axis, before any decenter */
    bool mirror;
    bool off_axis;        /* given by its place, and that is tilted or beside the axis */
} lens_surface;

typedef struct lens {
    document source;                  /* for errors that turn up later */
    const char *name, *units;         /* "" where not given */
    size_t wavelengths;               /* how many; at least one */
    double wavelength;                /* the chosen one, micrometres; NaN: the file gives none */
    double object_distance;           /* from the object to the first vertex; infinite by default */
    double object_index;
    double pupil_semi_diameter;       /* NaN: not given */
    double pupil_distance;            /* of the entrance pupil behind the first vertex; NaN: not given */
    size_t fields;
    double *field;                    /* degrees; {0} by default */
    size_t count;
    sgt_element *element;             /* [count], at the chosen wavelength */
    lens_surface *surface;            /* [count] */
    size_t stop;                      /* its index; the first surface where none is marked */
    bool stop_marked;
} lens;

/* wavelength counts from 1.  Whatever is wrong ends the command, naming file, line, key. */
lens lens_read(const char *path, size_t wavelength);

#endif
