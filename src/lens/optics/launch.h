/* launch.h - a launcher from inside. */
#ifndef SGT_OPTICS_LAUNCH_H
#define SGT_OPTICS_LAUNCH_H
#include "../base/vec3.h"

#include <sagitta/analysis.h>

struct sgt_launcher {
    sgt_allocator   allocator;
    const sgt_lens *lens;
    sgt_element    *element;   /* [lens->count], at the wavelength where pupil and fields are defined */
    double          before;    /* and the index in front, there */
    sgt_first_order data;      /* there */
    sgt_lens_aim    aim;
    double          stop_radius; /* unless SGT_LENS_AIM_PUPIL */
    /* the sign of a turn in the pupil as seen at the stop, on the axis; 0: not known */
    double          sense;
};

#ifdef __GNUC__
#define SGT_LAUNCH_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define SGT_LAUNCH_PRINTF(text, first)
#endif

/* Fills in *error, if there is one, with the file and its first line; false. */
bool sgt_launch_fail(const sgt_launcher *from, sgt_error *error, const char *key, const char *words,
                     ...) SGT_LAUNCH_PRINTF(4, 5);

/* The same, where there is no memory. */
bool sgt_launch_memory(const sgt_launcher *from, sgt_error *error);

/* Is what is reserved in `type` for later versions zero?  false: told. */
bool sgt_launch_plain(const sgt_launcher *from, const unsigned long long reserved[], size_t count,
                      const char *type, sgt_error *error);

#define PLAIN(from, of, type, error) \
    sgt_launch_plain(from, (of)->reserved_, sizeof(of)->reserved_ / sizeof *(of)->reserved_, type, error)

/* Room for `count` things; NULL: no memory.  Freed by sgt_launch_forget. */
void *sgt_launch_take(const sgt_launcher *from, size_t count, size_t size);
void  sgt_launch_forget(const sgt_launcher *from, void *room);

/* Sets the object point, or from afar the direction by its angles in degrees. */
void sgt_beam_point(const sgt_launcher *from, sgt_field_beam *b, double x, double y);

/* (ends.c) The elements for rays that end at the last of them: without its phase. */
void sgt_launch_ending(size_t count, const sgt_element e[], sgt_element out[]);

/* (ends.c) Which numbers of an end are wanted: those of the others are left as they are where no ray was
 * traced, and are not worked out.  Its fate, element, status, proven and folded always are. */
enum {
    END_POINT = 1,              /* p, d */
    END_PATH = 2,               /* opl */
    END_POINT_ERROR = 4,        /* p_err, and d_err of an afocal lens; with END_POINT */
    END_PATH_ERROR = 8,         /* opl_err; with END_PATH */
    END_EVALS = 16,
    END_SLANT = 32,             /* t_err, condition */
    END_ALL = 63
};

/* (ends.c) sgt_trace_pupil for the numbers that are wanted. */
bool sgt_trace_ends(const sgt_launcher *from, const sgt_field_beam *b, const sgt_element e[],
                    double index_before, size_t count, const sgt_pupil_point at[], const sgt_options *opt,
                    unsigned wanted, sgt_ray_end out[], sgt_error *error);

/* (ends.c) A bound, in radians, on what is off in end->d; end->p and p_err are read, too.  Infinite: not
 * known. */
double sgt_direction_error(const sgt_launcher *from, const sgt_element e[], double before,
                           const sgt_ray *launch, const sgt_ray_end *end);

/* (ends.c) As sgt_trace, through n elements, whatever clips the ray: the roots are those that sgt_trace means
 * with the apertures there.  open: room for n; at return the elements without what clipped it. */
size_t sgt_trace_through(size_t n, const sgt_element e[], double before, const sgt_ray *launch,
                         sgt_element open[], sgt_passage passages[], sgt_fate *fate);

/* (aim.c) Sets stop_radius and sense; false: told. */
bool sgt_aim_at_stop(sgt_launcher *from, sgt_error *error);

/* (aim.c) Sets the point or direction of the beam so that its chief ray meets the image at `at`; false:
 * told. */
bool sgt_aim_field(const sgt_launcher *from, sgt_field_beam *b, sgt_vec2 at, sgt_error *error);

/* (aim.c) Aims rays at q[i] times the radius of the stop of e; false: no memory. */
bool sgt_aim_rays(const sgt_launcher *from, const sgt_field_beam *b, const sgt_element e[], double before,
                  size_t count, const sgt_pupil_point at[], sgt_launched out[]);

/* A point of the unit circle after vignetting. */
sgt_vec2 sgt_vignetted(const sgt_field_beam *b, double x, double y);

/* The rays through points of the paraxial pupil, as sgt_launch_rays has them if it does not aim. */
void sgt_launch_unaimed(const sgt_field_beam *b, size_t count, const sgt_pupil_point at[], double *const o[3],
                        double *const d[3]);

#endif
