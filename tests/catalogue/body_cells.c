// SPDX-License-Identifier: MIT
/* body_cells.c - what quadric, ellipsoid and torus say and no header shows: `encloses` of sgt_builtin_ops, as
 * each set of instructions has it, and `first`. */
#include "../../src/surface/builtin.h"
#include "body_cells.h"

extern const sgt_surface_ops sgt_quadric_ops_base, sgt_ellipsoid_ops_base, sgt_torus_ops_base;
#if LANE_SETS > 1
extern const sgt_surface_ops sgt_quadric_ops_v3, sgt_ellipsoid_ops_v3, sgt_torus_ops_v3, sgt_quadric_ops_v4,
    sgt_ellipsoid_ops_v4, sgt_torus_ops_v4;
#endif

static const sgt_surface_ops *const quadrics[] = {
    &sgt_quadric_ops_base,
#if LANE_SETS > 1
    &sgt_quadric_ops_v3, &sgt_quadric_ops_v4,
#endif
};
static const sgt_surface_ops *const ellipsoids[] = {
    &sgt_ellipsoid_ops_base,
#if LANE_SETS > 1
    &sgt_ellipsoid_ops_v3, &sgt_ellipsoid_ops_v4,
#endif
};
static const sgt_surface_ops *const tori[] = {
    &sgt_torus_ops_base,
#if LANE_SETS > 1
    &sgt_torus_ops_v3, &sgt_torus_ops_v4,
#endif
};

int body_sets(void)
{
    int sets = 1;
#if LANE_SETS > 1
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) sets = 2;
    if (sets == 2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512cd"))
        sets = 3;
#endif
    return sets;
}

static const sgt_surface_ops *const *sets_of(sgt_surface s)
{
    return s.ops == &sgt_quadric_ops     ? quadrics
           : s.ops == &sgt_ellipsoid_ops ? ellipsoids
           : s.ops == &sgt_torus_ops     ? tori
                                         : NULL;
}

int body_first(sgt_surface s, const sgt_ray *ray, sgt_span *span, double *steep)
{
    const sgt_surface_ops *const *sets = sets_of(s);
    if (sets) *span = sets[0]->own_->first(s.self, ray, steep);
    return sets != NULL;
}

int body_cells(sgt_surface s, int set, size_t n, sgt_rays rays, const double *t_lo, const double *t_hi,
               sgt_enclosures out)
{
    const sgt_surface_ops *const *sets = sets_of(s);
    if (sets) sets[set]->own_->encloses(s.self, n, rays, t_lo, t_hi, out);
    return sets != NULL;
}
