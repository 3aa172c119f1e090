// SPDX-License-Identifier: MIT
/* aim.c - derivatives of a trace, and rays through a wanted point: aim.h. */
#include "dispatch.h"

#include <sagitta/aim.h>

SGT_DISPATCH(int, sgt_trace_sensitivity,
             (size_t elements, const sgt_element e[], double index_before, const sgt_ray *launch,
              const sgt_passage passages[], size_t columns, const sgt_ray_change change[],
              sgt_ray_change out[]),
             (elements, e, index_before, launch, passages, columns, change, out))
SGT_DISPATCH(size_t, sgt_trace_parameters, (size_t elements, const sgt_element e[]), (elements, e))
SGT_DISPATCH(int, sgt_trace_gradient,
             (size_t elements, const sgt_element e[], double index_before, const sgt_ray *launch,
              const sgt_passage passages[], size_t rows, const sgt_ray_change weight[], double gradient[]),
             (elements, e, index_before, launch, passages, rows, weight, gradient))
SGT_DISPATCH(size_t, sgt_phase_parameters, (size_t elements, const sgt_element e[]), (elements, e))
SGT_DISPATCH(int, sgt_phase_gradient,
             (size_t elements, const sgt_element e[], double index_before, const sgt_ray *launch,
              const sgt_passage passages[], size_t rows, const sgt_ray_change weight[], double gradient[]),
             (elements, e, index_before, launch, passages, rows, weight, gradient))
SGT_DISPATCH(bool, sgt_trace_error,
             (size_t elements, const sgt_element e[], double index_before, const sgt_ray *launch,
              const sgt_passage passages[], sgt_end_error *out),
             (elements, e, index_before, launch, passages, out))
SGT_DISPATCH(int, sgt_trace_sensitivity_batch,
             (size_t elements, const sgt_element e[], double index_before, const sgt_traces *traces,
              size_t columns, const sgt_ray_changes change[], const sgt_ray_changes out[]),
             (elements, e, index_before, traces, columns, change, out))
SGT_DISPATCH(int, sgt_trace_gradient_batch,
             (size_t elements, const sgt_element e[], double index_before, const sgt_traces *traces,
              size_t rows, const sgt_ray_changes weight[], double *const gradient[]),
             (elements, e, index_before, traces, rows, weight, gradient))
SGT_DISPATCH(size_t, sgt_trace_error_batch,
             (size_t elements, const sgt_element e[], double index_before, const sgt_traces *traces,
              sgt_end_errors out),
             (elements, e, index_before, traces, out))
SGT_EXPORT(sgt_ray, sgt_beam_ray, (const sgt_beam *beam, double u, double v), (beam, u, v))
SGT_EXPORT(bool, sgt_beam_bounds,
           (size_t stop, const sgt_element e[], double index_before, const sgt_beam *beam, sgt_vec2 wanted,
            sgt_interval *u, sgt_interval *v),
           (stop, e, index_before, beam, wanted, u, v))
SGT_EXPORT(const char *, sgt_aimed_text, (sgt_aimed aimed), (aimed))
SGT_DISPATCH(sgt_aimed, sgt_aim,
             (size_t stop, const sgt_element e[], double index_before, const sgt_beam *beam, sgt_vec2 wanted,
              sgt_passage passages[], const sgt_aim_options *opt, sgt_aiming *out),
             (stop, e, index_before, beam, wanted, passages, opt, out))
SGT_DISPATCH(size_t, sgt_aim_batch,
             (size_t stop, const sgt_element e[], double index_before, const sgt_beam *beam,
              const sgt_aims *aims, sgt_passage room[], const sgt_aim_options *opt),
             (stop, e, index_before, beam, aims, room, opt))
