// SPDX-License-Identifier: MIT
/* frame.h - the running frame of a lens: where the next vertex stands. */
#ifndef SGT_LENS_FRAME_H
#define SGT_LENS_FRAME_H
#include <sagitta/system.h>

/* The frame in which the next surface is placed, and z along the unfolded axis.  turned: its axes are not the
 * global ones. */
typedef struct running { sgt_pose pose; double z; bool turned; } running;

/* Goes on by a thickness along z. */
void sgt_frame_advance(running *at, double thickness);

/* A coordinate break.  tilt_first false: moved by shift, then turned about x, the new y, the new z:
 * old = shift + Rx Ry Rz new.  true: turned about z, the new y, the new x, then moved along the new axes:
 * old = Rz Ry Rx (new + shift).  Degrees, right-handed. */
void sgt_frame_break(running *at, sgt_vec3 shift, sgt_vec3 tilt, bool tilt_first);

/* The pose of a surface that is moved by `decenter` and turned by Rz Ry Rx in the running frame. */
sgt_pose sgt_frame_pose(const running *at, sgt_vec3 decenter, sgt_vec3 tilt);

#endif
