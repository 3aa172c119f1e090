/* launch.h - the rays of a field through the entrance pupil of a lens. */
#ifndef TOOL_LAUNCH_H
#define TOOL_LAUNCH_H
#include "../read/lens.h"
#include "../read/rays.h"

typedef enum pupil_pattern {
    PUPIL_FAN,   /* n rays across the pupil in y, from edge to edge; n = 1: its centre */
    PUPIL_GRID   /* of n x n rays over the square around the pupil, those inside its circle */
} pupil_pattern;

/* Adds the rays of a field, the field-th, to the list.  If the lens gives no pupil the command ends, and the
 * message names the key. */
void launch_field(ray_list *list, const lens *l, const sgt_first_order *data, size_t field,
                  sgt_field_kind kind, sgt_lens_field at, pupil_pattern pattern, long n);

/* What launch_field needs of the lens. */
sgt_first_order launch_data(const lens *l);

#endif
