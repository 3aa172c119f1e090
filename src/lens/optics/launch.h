/* launch.h - a launcher from inside. */
#ifndef SGT_OPTICS_LAUNCH_H
#define SGT_OPTICS_LAUNCH_H
#include "../base/vec3.h"

#include <sagitta/analysis.h>

struct sgt_launcher {
    sgt_allocator   allocator;
    const sgt_lens *lens;
    const sgt_element *element; /* [lens->count], at the wavelength where pupil and fields are defined */
    sgt_element    *own;       /* that is this, if it is not that of the lens; else NULL */
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

/* (beam.c) sgt_launch_field; of a real image height the point or direction is not set. */
bool sgt_beam_of_field(const sgt_launcher *from, sgt_field_kind kind, const sgt_lens_field *at,
                       sgt_field_beam *b, sgt_error *error);

/* Sets the object point, or from afar the direction by its angles in degrees. */
void sgt_beam_point(const sgt_launcher *from, sgt_field_beam *b, double x, double y);

/* (through.c) The elements for rays that end at the last of them: without its phase. */
void sgt_launch_ending(size_t count, const sgt_element e[], sgt_element out[]);

/* (ends.c) A bound, in radians, on what is off in end->d; end->p and p_err are read, too.  Infinite: not
 * known. */
double sgt_direction_error(const sgt_launcher *from, const sgt_element e[], double before,
                           const sgt_ray *launch, const sgt_ray_end *end);

/* (through.c) As sgt_trace, through n elements, whatever clips the ray: the roots are those that sgt_trace
 * means with the apertures there.  open: room for n; at return the elements without what clipped it. */
size_t sgt_trace_through(size_t elements, const sgt_element e[], double before, const sgt_ray *launch,
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

#endif
