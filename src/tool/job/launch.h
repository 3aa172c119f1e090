/* launch.h - the rays of a field through the entrance pupil of a lens. */
#ifndef TOOL_LAUNCH_H
#define TOOL_LAUNCH_H
#include "../read/lens.h"
#include "../read/rays.h"

/* Points in the unit circle of the pupil; they last until the command ends. */
typedef struct launch_pattern { size_t count; const sgt_pupil_point *at; } launch_pattern;
launch_pattern launch_points(sgt_pattern pattern, size_t n, uint64_t seed);

/* Where a point of the unit circle is: in the paraxial entrance pupil; or on the stop, whose radius is that
 * of the paraxial marginal ray, or of the real one. */
typedef enum launch_aim { LAUNCH_AT_PUPIL, LAUNCH_AT_STOP, LAUNCH_AT_REAL_STOP } launch_aim;

/* What the launching of all fields shares. */
typedef struct launch_how {
    lens lens;                 /* at the primary wavelength, where pupil and fields are defined */
    sgt_first_order data;
    launch_aim aim;
    double stop_radius;        /* unless LAUNCH_AT_PUPIL */
    size_t count;              /* of rays that were asked for */
    size_t none, undecided;    /* for which aiming has proven that there is none, or found none */
} launch_how;

/* If the lens gives no pupil the command ends, and the message names the key. */
launch_how launch_by(const lens *l, launch_aim aim);

/* Adds the rays of a field, the field-th, to the list.  Aimed ones are those of `traced`, the lens at the
 * wavelength they are for; a ray that is not there is left out, counted, and noted. */
void launch_field(ray_list *list, launch_how *how, const lens *traced, size_t field, sgt_field_kind kind,
                  sgt_lens_field at, const launch_pattern *points);

/* The rays of one field.  z is global. */
typedef struct beam {
    double pupil, radius;      /* z and semi-diameter of the entrance pupil */
    double cone;               /* of a telecentric object: the slope of its marginal rays; else 0 */
    bool finite;
    sgt_vec3 object;           /* if finite: the point the rays come from */
    sgt_vec3 direction;        /* if not: of all rays */
    double front, wave;        /* a z in front of all; the wavefront is the plane direction . p = wave */
} beam;

/* Sets the object point, or from afar the direction by its angles in degrees. */
void beam_point(beam *b, const lens *l, double x, double y);

/* The ray through x, y of the unit circle of the entrance pupil. */
sgt_ray beam_ray(const beam *b, double x, double y);

/* The beam of the field on the axis. */
beam launch_axial_beam(const launch_how *how);

#endif
