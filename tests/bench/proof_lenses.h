// SPDX-License-Identifier: MIT
/* proof_lenses.h - a lens file as the command reads it, with the rays of each of its fields. */
#ifndef BENCH_PROOF_LENSES_H
#define BENCH_PROOF_LENSES_H
#include <sagitta/system.h>
#ifdef __cplusplus
extern "C" {
#endif

typedef struct proof_field { double degrees; size_t n; const sgt_ray *rays; } proof_field;
typedef struct proof_lens {
    size_t count, fields;
    const sgt_element *element;
    double index;
    const proof_field *field;
} proof_lens;

/* Each field's rays: about `rays` of them, on a grid over the pupil.  A file that cannot be read ends the
 * program. */
proof_lens proof_lens_read(const char *path, size_t rays);

#ifdef __cplusplus
}
#endif
#endif
