/* launch.h - the rays of a field through the entrance pupil of a lens. */
#ifndef TOOL_LAUNCH_H
#define TOOL_LAUNCH_H
#include "../read/lens.h"
#include "../read/rays.h"

/* Points in the unit circle of the pupil; they last until the command ends. */
typedef struct launch_pattern { size_t count; const sgt_pupil_point *at; } launch_pattern;
launch_pattern launch_points(sgt_pattern pattern, size_t n, uint64_t seed);

/* Adds the rays of a field, the field-th, to the list.  If the lens gives no pupil the command ends, and the
 * message names the key. */
void launch_field(ray_list *list, const lens *l, const sgt_first_order *data, size_t field,
                  sgt_field_kind kind, sgt_lens_field at, const launch_pattern *points);

/* What launch_field needs of the lens. */
sgt_first_order launch_data(const lens *l);

#endif
