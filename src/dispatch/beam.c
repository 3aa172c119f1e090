// SPDX-License-Identifier: MIT
/* beam.c - boxes of rays: beam.h. */
#include "dispatch.h"

#include <sagitta/beam.h>

SGT_DISPATCH(sgt_box_verdict, sgt_box_trace,
             (const sgt_box_lens *lens, const sgt_box_launch *launch, sgt_box_room room[], sgt_box_at at[],
              sgt_box_end *out),
             (lens, launch, room, at, out))
SGT_EXPORT(const char *, sgt_box_verdict_text, (sgt_box_verdict verdict), (verdict))
SGT_EXPORT(const char *, sgt_box_why_text, (sgt_box_why why), (why))
SGT_EXPORT(sgt_model, sgt_model_of, (double x), (x))
SGT_EXPORT(sgt_model, sgt_model_parameter, (int i, sgt_interval range), (i, range))
SGT_EXPORT(sgt_model, sgt_model_between, (sgt_interval range), (range))
SGT_DISPATCH_VOID(sgt_model_polar,
                  (int i, sgt_interval radius, int j, sgt_interval angle, sgt_model *x, sgt_model *y),
                  (i, radius, j, angle, x, y))
SGT_DISPATCH_VOID(sgt_model_sum, (const sgt_model *x, const sgt_model *y, sgt_model *out), (x, y, out))
SGT_DISPATCH_VOID(sgt_model_difference, (const sgt_model *x, const sgt_model *y, sgt_model *out), (x, y, out))
SGT_DISPATCH_VOID(sgt_model_product, (const sgt_model *x, const sgt_model *y, sgt_model *out), (x, y, out))
SGT_DISPATCH_VOID(sgt_model_scaled, (const sgt_model *x, double k, sgt_model *out), (x, k, out))
SGT_DISPATCH_VOID(sgt_model_plus, (const sgt_model *x, double k, sgt_model *out), (x, k, out))
SGT_DISPATCH_VOID(sgt_model_inverse, (const sgt_model *x, sgt_model *out), (x, out))
SGT_DISPATCH_VOID(sgt_model_root, (const sgt_model *x, sgt_model *out), (x, out))
SGT_DISPATCH(sgt_interval, sgt_model_range, (const sgt_model *x), (x))
SGT_DISPATCH(sgt_interval, sgt_model_mean, (const sgt_model *x), (x))
SGT_DISPATCH(sgt_interval, sgt_model_at, (const sgt_model *x, const double s[SGT_MODEL_PARAMETERS]), (x, s))
