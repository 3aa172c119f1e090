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

SGT_DISPATCH(sgt_box_verdict, sgt_series_trace,
             (const sgt_box_lens *lens, const sgt_series_ray *launch, sgt_box_room room[], sgt_box_at at[],
              sgt_series_ray *arriving, sgt_series_ray *ends, sgt_box_end *out),
             (lens, launch, room, at, arriving, ends, out))
SGT_EXPORT(sgt_series, sgt_series_of, (double x), (x))
SGT_EXPORT(sgt_series, sgt_series_parameter, (int i, sgt_interval range), (i, range))
SGT_EXPORT(sgt_series, sgt_series_between, (sgt_interval range), (range))
SGT_DISPATCH_VOID(sgt_series_polar, (sgt_interval radius, sgt_interval angle, sgt_series *x, sgt_series *y),
                  (radius, angle, x, y))
SGT_DISPATCH_VOID(sgt_series_sum, (const sgt_series *x, const sgt_series *y, sgt_series *out), (x, y, out))
SGT_DISPATCH_VOID(sgt_series_difference, (const sgt_series *x, const sgt_series *y, sgt_series *out),
                  (x, y, out))
SGT_DISPATCH_VOID(sgt_series_product, (const sgt_series *x, const sgt_series *y, sgt_series *out),
                  (x, y, out))
SGT_DISPATCH_VOID(sgt_series_scaled, (const sgt_series *x, double k, sgt_series *out), (x, k, out))
SGT_DISPATCH_VOID(sgt_series_plus, (const sgt_series *x, double k, sgt_series *out), (x, k, out))
SGT_DISPATCH_VOID(sgt_series_inverse, (const sgt_series *x, sgt_series *out), (x, out))
SGT_DISPATCH_VOID(sgt_series_root, (const sgt_series *x, sgt_series *out), (x, out))
SGT_DISPATCH(sgt_interval, sgt_series_range, (const sgt_series *x), (x))
SGT_DISPATCH(sgt_interval, sgt_series_mean, (const sgt_series *x, double w), (x, w))
SGT_DISPATCH(sgt_interval, sgt_series_at, (const sgt_series *x, double s, double t), (x, s, t))
