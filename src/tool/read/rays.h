/* rays.h - the rays a command is to answer for: from a file, an option, or a pupil. */
#ifndef TOOL_RAYS_H
#define TOOL_RAYS_H
#include <sagitta/sagitta.h>

typedef struct launch {
    sgt_ray ray;
    size_t number;      /* counts from 0; in a file, the data rows, bad ones included */
    size_t field;       /* its index in the list of fields; 0 for rays from a file */
    const char *id;     /* as the file gives it; NULL: it gives none */
} launch;

typedef struct ray_list {
    size_t count, capacity;
    launch *ray;
    bool ended;         /* the file has a column tmin or tmax */
    bool named;         /* the file has a column `id` */
    int threads;        /* that are to read the file; 0: one */
} ray_list;

void rays_add(ray_list *list, launch ray);

/* CSV with a header row from a file, or "-", into an empty list.  A bad row ends the command,
 * naming its line; with skip_bad it is left out, and their number said on standard error. */
void rays_read(ray_list *list, const char *path, bool skip_bad);

/* "ox oy oz dx dy dz", and optionally "tmin tmax": as --ray gives it. */
void rays_parse(ray_list *list, const char *text);

#endif
