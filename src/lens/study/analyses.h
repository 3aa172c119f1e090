// SPDX-License-Identifier: MIT
/* analyses.h - the analyses, each defined in a file of its own. */
#ifndef SGT_STUDY_ANALYSES_H
#define SGT_STUDY_ANALYSES_H
#include <sagitta/study.h>

extern const sgt_analysis sgt_spot_analysis, sgt_fan_analysis, sgt_opd_analysis, sgt_wavefront_analysis,
    sgt_zernike_analysis, sgt_field_analysis, sgt_map_analysis, sgt_sweep_analysis, sgt_ends_analysis,
    sgt_energy_analysis, sgt_illumination_analysis, sgt_prove_analysis, sgt_prove_elements_analysis,
    sgt_prove_regions_analysis, sgt_prove_limits_analysis, sgt_prove_between_analysis,
    sgt_prove_between_limits_analysis, sgt_prove_samples_analysis;

#endif
