/* launch.h - the rays of a field through the entrance pupil of a lens. */
#ifndef TOOL_LAUNCH_H
#define TOOL_LAUNCH_H
#include "../read/lens.h"
#include "../read/rays.h"

typedef enum pupil_pattern {
    PUPIL_FAN,   /* n rays across the pupil in y, edge to edge; one: its centre */
    PUPIL_GRID   /* n x n over the pupil's square, those in its circle */
} pupil_pattern;

/* Adds the rays of one field (degrees) to the list.  Without a pupil in the lens the
 * command ends, naming the key. */
void launch_field(ray_list *list, const lens *l, size_t field, double degrees, pupil_pattern pattern, long n);

#endif
