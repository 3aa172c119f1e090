// SPDX-License-Identifier: MIT
/* analyses.c - which analyses there are, and their columns as a study fills them. */
#include "analyses.h"
#include "study.h"

#include <stdio.h>
#include <string.h>

/* To add one: a file that defines it, its row here and its line in analyses.h. */
static const sgt_analysis *const all[] = {
    &sgt_spot_analysis,      &sgt_fan_analysis,     &sgt_opd_analysis,
    &sgt_wavefront_analysis, &sgt_zernike_analysis, &sgt_field_analysis,
    &sgt_map_analysis,       &sgt_sweep_analysis,   &sgt_ends_analysis,
    &sgt_energy_analysis,    &sgt_illumination_analysis,
    &sgt_prove_analysis,     &sgt_prove_elements_analysis,
    &sgt_prove_regions_analysis, &sgt_prove_limits_analysis,
    &sgt_prove_between_analysis, &sgt_prove_between_limits_analysis, &sgt_prove_samples_analysis,
};

const sgt_analysis *sgt_analysis_at(size_t place)
{
    return place < sizeof all / sizeof *all ? all[place] : NULL;
}

const sgt_analysis *sgt_analysis_named(const char *name)
{
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (strcmp(all[i]->name, name) == 0) return all[i];
    return NULL;
}

const sgt_column *sgt_analysis_column(const sgt_analysis *a, size_t place)
{
    return place < a->columns ? &a->column[place] : NULL;
}

const sgt_setting *sgt_analysis_setting(const sgt_analysis *a, size_t place)
{
    return place < a->settings ? &a->setting[place] : NULL;
}

static bool is_given(const sgt_analysis *a, const void *options, const char *name)
{
    const unsigned char *at = options;
    for (size_t i = 0; i < a->settings && at; i++) {
        const sgt_setting *s = &a->setting[i];
        sgt_list list;
        if (strcmp(s->name, name) != 0) continue;
        if (s->kind == SGT_SETTING_FLAG) return at[s->offset];
        memcpy(&list, at + s->offset, sizeof list);
        return list.count;
    }
    return false;
}

bool sgt_study_column(const sgt_study *study, const sgt_analysis *a, const void *options, size_t column,
                      char name[32], char unit[32])
{
    const sgt_lens *l = study->lens;
    const sgt_study_options *o = &study->opt;
    if (column >= a->columns) return false;
    const sgt_column *c = &a->column[column];
    if (c->flags & SGT_COLUMN_PROVEN && !(o->solver && o->solver->proof)) return false;
    if (c->flags & SGT_COLUMN_GIVEN && !is_given(a, options, c->name)) return false;
    const sgt_field_kind kind = o->fields && !o->field && o->field_kind ? *o->field_kind : l->field_kind;
    const char *end = "", *in = "";
    switch (c->dimension) {
    case SGT_UNIT_NONE: break;
    case SGT_UNIT_MICROMETRE: in = l->wavelength || o->wavelengths ? "um" : ""; break;
    case SGT_UNIT_LENGTH: in = l->units; break;
    case SGT_UNIT_IMAGE: in = l->afocal ? "mrad" : l->units, end = l->afocal ? "_mrad" : ""; break;
    case SGT_UNIT_FOCUS: in = l->afocal ? "1/m" : l->units, end = l->afocal ? "_dioptre" : ""; break;
    case SGT_UNIT_FIELD: in = kind == SGT_FIELD_ANGLE ? "deg" : l->units; break;
    case SGT_UNIT_SWEEP: in = isfinite(l->object_distance) ? l->units : "deg"; break;
    case SGT_UNIT_WAVE: in = "waves"; break;
    case SGT_UNIT_PERCENT: in = "%"; break;
    case SGT_UNIT_PUPIL: in = "radii"; break;
    case SGT_UNIT_DEGREE: in = "deg"; break;
    }
    snprintf(name, 32, "%s%s", c->name, end);
    snprintf(unit, 32, "%s", in);
    return true;
}
