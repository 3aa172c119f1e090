/* job.h - a lens and the rays to send through it, as the arguments ask for them. */
#ifndef TOOL_JOB_H
#define TOOL_JOB_H
#include "../read/lens.h"
#include "options.h"
#include "../read/rays.h"

typedef struct job_options {
    const char *lens, *rays;          /* files */
    sgt_lens_field *field;            /* --field, one after another */
    size_t fields, capacity;
    long fan, grid, wavelength;       /* 0: not given; wavelength -1: um */
    double um;                        /* --wavelength in micrometres */
    bool skip_bad, no_apertures, glass;
    int threads;                      /* to read rays with; 0: one */
} job_options;

enum {
    JOB_FIELD = OPTION_OWN, JOB_FAN, JOB_GRID, JOB_RAYS, JOB_SKIP_BAD, JOB_WAVELENGTH, JOB_NO_APERTURES,
    JOB_GLASS,
    OPTION_AFTER_JOB
};

#define JOB_OPTIONS                                             \
    {"field", required_argument, NULL, JOB_FIELD},              \
    {"fan", required_argument, NULL, JOB_FAN},                  \
    {"grid", required_argument, NULL, JOB_GRID},                \
    {"rays", required_argument, NULL, JOB_RAYS},                \
    {"skip-bad", no_argument, NULL, JOB_SKIP_BAD},              \
    {"wavelength", required_argument, NULL, JOB_WAVELENGTH},    \
    {"glass", required_argument, NULL, JOB_GLASS},              \
    {"no-apertures", no_argument, NULL, JOB_NO_APERTURES}

extern const char job_help[];

/* Takes an option if its code is one of the above; else returns false. */
bool job_take(job_options *o, int code);

typedef struct job {
    lens lens;
    sgt_element *element;     /* [lens.count], those of the lens; without apertures for --no-apertures */
    ray_list rays;
    size_t fields;            /* 0: the rays came from a file */
    const sgt_lens_field *field;
    sgt_field_kind field_kind;
} job;

/* The whole line of a ray, from -infinity to infinity, in an element's own frame. */
sgt_ray job_own_ray(const sgt_pose *pose, const sgt_ray *ray);

/* Reads the lens and the rays.  Any error ends the command. */
job job_read(const job_options *o);

#endif
