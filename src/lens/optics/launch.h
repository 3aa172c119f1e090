// SPDX-License-Identifier: MIT
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
    bool            any_front;  /* where wavefronts begin does not matter: they begin at the pupil */
};

/* What the search for all rays of a beam shares (aim_map.c): the chief ray, the linear map about it, and the
 * map that was fitted to some of them, polynomials of the point of the pupil. */
enum { AIM_DEGREE = 10, AIM_TERMS = (AIM_DEGREE + 1) * (AIM_DEGREE + 2) / 2 };
typedef struct sgt_linear { double xu, xv, yu, yv, determinant; } sgt_linear;
typedef struct sgt_aim_map {
    sgt_aiming chief;
    int home;
    sgt_linear map;
    bool mapped, fitted, mirrored; /* mirrored: u is odd in x, and v is even */
    int steps;                  /* how many a ray needs that begins at the fitted map */
    double fit[2][AIM_TERMS];   /* for u, v: of x^i y^j, from the highest j, and in each from the highest i */
} sgt_aim_map;

/* The points of the pupil that it is fitted to, and the fit of their values by least squares: coefficient k
 * is the sum of by[k][i] value[i].  And others, to see how good it is. */
enum { AIM_RINGS = 5, AIM_NODES = 1 + 3 * AIM_RINGS * (AIM_RINGS + 1) };
enum { AIM_TEST_RINGS = 4, AIM_TESTS = 1 + 3 * AIM_TEST_RINGS * (AIM_TEST_RINGS + 1) };
typedef struct sgt_aim_nodes {
    sgt_pupil_point at[AIM_NODES], test[AIM_TESTS];
    double by[AIM_TERMS][AIM_NODES];
} sgt_aim_nodes;

/* A beam at one wavelength: what its rays are launched through. */
typedef struct sgt_colour_beam {
    const sgt_launcher *from;
    const sgt_field_beam *beam;
    const sgt_element *e;       /* of the lens, at that wavelength */
    double before;              /* and the index in front of them */
    const sgt_aim_map *map;     /* of this beam (sgt_aim_map_of); NULL: rays are searched for */
} sgt_colour_beam;

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

/* (ends.c) Room for sgt_trace_ends, and for `ends` ends that nobody takes.  NULL: no memory. */
typedef struct sgt_ends_room sgt_ends_room;
sgt_ends_room *sgt_ends_room_new(const sgt_launcher *from, size_t count, unsigned wanted, size_t ends);
void sgt_ends_room_free(const sgt_launcher *from, sgt_ends_room *room);

/* (ends.c) sgt_trace_pupil for the numbers that are wanted.  out: NULL, the ends of the room.  Returns the
 * ends. */
sgt_ray_end *sgt_trace_ends(const sgt_colour_beam *of, sgt_ends_room *room, size_t count,
                            const sgt_pupil_point at[], const sgt_options *opt, sgt_ray_end out[]);

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

/* (aim_field.c) Sets the point or direction of the beam so that its chief ray meets the image at `at`; false:
 * told. */
bool sgt_aim_field(const sgt_launcher *from, sgt_field_beam *b, sgt_vec2 at, sgt_error *error);

/* (aim.c) Room for sgt_aim_rays, of `count` rays at a time or fewer.  NULL: no memory. */
typedef struct sgt_aim_room sgt_aim_room;
sgt_aim_room *sgt_aim_room_new(const sgt_launcher *from, size_t count);
void sgt_aim_room_free(const sgt_launcher *from, sgt_aim_room *room);

/* (aim_map.c) Aims rays at the points of the stop. */
void sgt_aim_rays(const sgt_colour_beam *of, sgt_aim_room *room, size_t count, const sgt_pupil_point at[],
                  sgt_launched out[]);

/* (aim_map.c) By the fitted map: launch rays, [count] each, that nearly all meet their points.  Those that do
 * not are known when they have been traced, SGT_NEAR_SEED and to rounding: sgt_aim_missed lists them in
 * `left`, and returns how many there are.
 *
 *     count     at most that of the room
 *     traced    fate and passed
 *     hits      at the stop: p and p_err */
void   sgt_aim_guess(const sgt_colour_beam *of, sgt_aim_room *room, size_t count, const sgt_pupil_point at[],
                     double *const o[3], double *const d[3]);
size_t sgt_aim_missed(const sgt_aim_room *room, size_t count, const sgt_pupil_point at[], double *const o[3],
                      double *const d[3], sgt_traced traced, const sgt_hits *hits, size_t left[]);

/* (aim_map.c) Sets the nodes; and the map of a beam, fitted to them where that can be.  of->map is not read.
 * false: no memory. */
void sgt_aim_nodes_set(sgt_aim_nodes *out);
bool sgt_aim_map_of(const sgt_colour_beam *of, const sgt_aim_nodes *nodes, sgt_aim_map *out);

/* A point of the unit circle after vignetting. */
sgt_vec2 sgt_vignetted(const sgt_field_beam *b, double x, double y);

/* (beam.c) The rays through points of the paraxial pupil, as sgt_launch_rays has them if it does not aim. */
void sgt_launch_unaimed(const sgt_field_beam *b, size_t count, const sgt_pupil_point at[], double *const o[3],
                        double *const d[3]);

#endif
