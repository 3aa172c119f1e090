// SPDX-License-Identifier: MIT
/* camera.h - a pushbroom camera on a circular orbit: where each pixel is, and where it looks. */
#ifndef LINE_OF_SIGHT_CAMERA_H
#define LINE_OF_SIGHT_CAMERA_H
#include <sagitta/sagitta.h>
#ifdef __cplusplus
extern "C" {
#endif

/* Metres, radians, seconds. */
typedef struct camera {
    double altitude;             /* the orbit's radius less the equatorial radius of WGS84 */
    double inclination, node;    /* node: the longitude of the ascending node as the scan begins */
    double start;                /* the angle along the orbit from the node, as the scan begins */
    /* by how much the middle of the line is turned to the right of the track, and ahead */
    double roll, pitch;
    double field;                /* the whole angle across a line, shared evenly by the pixels */
    double line_time;            /* from one line to the next */
    int pixels, lines;
} camera;

/* The camera at a time after the scan began, in the Earth-centred Earth-fixed frame: its place, and unit
 * vectors ahead, to the right and down, square to each other; down is toward the centre of the Earth. */
typedef struct station { sgt_vec3 place, ahead, right, down; } station;

station  camera_station(const camera *c, double seconds);
/* across the track, positive to the right; no roll in it */
double   camera_angle(const camera *c, int pixel);
/* of unit length, roll and pitch applied */
sgt_vec3 camera_look(const camera *c, const station *s, double angle);

#ifdef __cplusplus
}
#endif
#endif
