/* lens.h - reads a lens file: its elements in order, at one of its wavelengths. */
#ifndef TOOL_LENS_H
#define TOOL_LENS_H
#include "document.h"
#include "glass.h"

#include <sagitta/surfaces.h>
#include <sagitta/system.h>

typedef struct lens_surface {
    const char *type;     /* its name in the file */
    double index;         /* behind it, positive, after a mirror too */
    double z;             /* its vertex on the axis, before any decenter */
    bool mirror;
    bool off_axis;        /* given by `origin`, and tilted or beside the axis */
} lens_surface;

typedef struct lens {
    document source;                  /* for errors that are found later */
    const char *name, *units;         /* "" where not given */
    size_t wavelengths;               /* how many there are; 1 if the file gives none */
    size_t chosen;                    /* which of them, from 1; 0: none, `wavelength` is another */
    double wavelength;                /* the chosen one, in micrometres; NaN: the file gives none */
    glass_makers makers;
    double object_distance;           /* from the object to the first vertex; default infinite */
    double object_index;
    double pupil_semi_diameter;       /* NaN: not given */
    double pupil_distance;            /* from the first vertex to the entrance pupil; NaN: not given */
    size_t fields;
    double *field;                    /* degrees; {0} by default */
    size_t count;
    sgt_element *element;             /* [count], at the chosen wavelength */
    lens_surface *surface;            /* [count] */
    size_t stop;                      /* the index of its surface; 0 if none is marked */
    bool stop_marked;
} lens;

/* wavelength: counted from 1.  Any error ends the command, with file, line and key in the message. */
lens lens_read(const char *path, size_t wavelength);

/* The same at a wavelength in micrometres, which need not be one of the file. */
lens lens_read_at(const char *path, double um);

#endif
