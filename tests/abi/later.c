// SPDX-License-Identifier: MIT
/* later.c - a program that asks for a little of everything and prints the answers to the last bit.  later.py
 * runs it with this library and with one that has grown, compiled against the headers of either.
 *
 *     later         the answers
 *     later asks    compiled against the later headers (LATER): sets members that this library does not know,
 *                   and prints what it is told */
#include <sagitta/aim.h>
#include <sagitta/diagnose.h>
#include <sagitta/sensitivity.h>
#include <sagitta/surfaces.h>
#ifdef WITH_LENS
#include <sagitta/study.h>
#endif
#include <stdio.h>
#include <string.h>

static void put(const char *what, size_t n, const double x[])
{
    printf("%s", what);
    for (size_t i = 0; i < n; i++) printf(" %a", x[i]);
    puts("");
}

static void put_hit(const char *what, const sgt_hit *h)
{
    const double x[] = {h->t, h->t_err, h->t_lo, h->lo, h->hi, h->f, h->p.x, h->p.y, h->p.z, h->n.x, h->n.y,
                        h->n.z, h->p_err};
    printf("%s %s %d:", what, sgt_status_text(h->status), h->evals);
    put("", sizeof x / sizeof *x, x);
#ifdef LATER
    if (h->status > 0) fprintf(stderr, "planted %llu\n", h->planted_);
#endif
}

enum { N = 9 };
static double in[6][N], out[12][N];
static sgt_status status[N];
static sgt_fate fate[N];
static int count[N];

static sgt_rays rays_of(void)
{
    for (int i = 0; i < N; i++) {
        const double of[6] = {0.3 * i - 1, 0.2 * i - 0.7, -9, 0.02 * i, -0.01 * i, 1};
        for (int k = 0; k < 6; k++) in[k][i] = of[k];
    }
    return (sgt_rays){.o = {in[0], in[1], in[2]}, .d = {in[3], in[4], in[5]}};
}

static void types(void)
{
    const sgt_hits hits = {.status = status, .evals = count, .t = out[0], .t_err = out[1], .t_lo = out[2],
                           .p = {out[3], out[4], out[5]}, .n = {out[6], out[7], out[8]}, .p_err = out[9]};
    sgt_jacobian by = {.t_by_o = {out[10], out[11]}};
    for (const sgt_builtin *b = sgt_builtins(); b->type; b++) {
        const sgt_surface s = {b->ops, b->specimen};
        size_t met = sgt_intersect_batch(s, N, rays_of(), hits, NULL), params = 0;
        sgt_hit all[4];
        for (const sgt_param *p = b->params; p->name; p++) params++;
        printf("%s: %zu parameters, %zu met, lacks %d\n", b->type, params, met,
               sgt_differentiate_batch(s, N, rays_of(), hits, by));
        for (int k = 0; k < 12; k++) put(b->type, N, out[k]);
        for (int i = 0; i < N; i += 4) {
            const sgt_ray ray = {.o = {in[0][i], in[1][i], in[2][i]}, .d = {in[3][i], in[4][i], in[5][i]}};
            sgt_step step[50];
            sgt_log log = {step, 50, 0};
            sgt_options opt = {.watch = sgt_log_step, .watch_data = &log, .proof = SGT_PROVE_FIRST};
            sgt_hit hit = sgt_intersect(s, ray, &opt);
            put_hit(b->type, &hit);
            const sgt_diagnosis d = sgt_diagnose(&log);
            printf("%s: %d steps, %s, %a\n", b->type, log.n, sgt_verdict_text(d.verdict), d.condition);
            int n = sgt_intersect_all(s, ray, 4, all, NULL);
            for (int k = 0; k < n && k < 4; k++) put_hit(b->type, &all[k]);
        }
    }
}

enum { ELEMENTS = 3 };
static const sgt_conic front = {.c = 1 / 51.68}, back = {.c = -1 / 700.0}, image = {.c = 0};
static const sgt_element lens[ELEMENTS] = {
    {.surface = {&sgt_conic_ops, &front}, .index = 1.5168, .semi_diameter = 8},
    {.surface = {&sgt_conic_ops, &back}, .pose = {.origin = {0, 0, 4}}, .index = 1},
    {.surface = {&sgt_conic_ops, &image}, .pose = {.origin = {0, 0, 97.5}}}};

static void traces(void)
{
    sgt_passages passages[ELEMENTS] = {{.opl = NULL}};
    passages[1].hits.status = status, passages[1].opl = out[7];
    const sgt_traced to = {.fate = fate, .passed = count, .o = {out[0], out[1], out[2]},
                           .d = {out[3], out[4], out[5]}, .opl = out[6]};
    printf("%zu passed\n", sgt_trace_batch(ELEMENTS, lens, 1, N, rays_of(), to, passages, NULL));
    for (int k = 0; k < 8; k++) put("traced", N, out[k]);
    for (int i = 0; i < N; i++) printf("%s %s\n", sgt_fate_text(fate[i]), sgt_status_text(status[i]));
    sgt_ray launch = {.o = {1, 2, -10}, .d = {0, 0, 1}}, ray = launch;
    sgt_passage passage[ELEMENTS];
    sgt_fate last;
    sgt_trace(ELEMENTS, lens, 1, &ray, passage, &last, NULL);
    for (int k = 0; k < ELEMENTS; k++) put_hit("passage", &passage[k].hit);
    sgt_end_error off;
    if (sgt_trace_error(ELEMENTS, lens, 1, &launch, passage, &off)) put("error", 2, &off.point);
    const sgt_beam beam = {
        .o = {0, 0, -10}, .ou = {1, 0, 0}, .ov = {0, 1, 0}, .d = {0, 0.01, 1}, .u = {-9, 9}, .v = {-9, 9}};
    sgt_aiming a;
    printf("%s\n", sgt_aimed_text(sgt_aim(1, lens, 1, &beam, (sgt_vec2){1, 2}, passage, NULL, &a)));
    put("aimed", 2, &a.u);
    const sgt_clipping by = sgt_clipped_by(&lens[0], (sgt_vec3){9, 0, 0});
    printf("clipped by %d %a\n", by.by, by.size);
}

#ifdef WITH_LENS
static const char text[] =
    "surfaces:\n"
    "  - {type: sphere, radius: 51.68, thickness: 4, index: 1.5168, semi_diameter: 8}\n"
    "  - {type: sphere, radius: -700, thickness: 97.5, index: 1}\n"
    "  - {type: plane}\n"
    "pupil: {semi_diameter: 5}\nfields: [1]\nwavelengths: [0.55]\n";

static void analyses(void)
{
    sgt_error error = {.line = 0};
    sgt_lens *l = sgt_lens_read_text("later.yaml", text, sizeof text - 1, NULL, &error);
    sgt_launcher *from = l ? sgt_launcher_new(l, NULL, &error) : NULL;
    sgt_field_beam beam;
    sgt_pupil_point at[60];
    sgt_ray_end end[60], chief;
    size_t n = sgt_pupil_points(SGT_PATTERN_HEXAPOLAR, 3, 0, 60, at);
    if (from && sgt_launch_field(from, l->field_kind, &l->field[0], &beam, &error) &&
        sgt_trace_pupil(from, &beam, l->element, l->index_before, &(sgt_pupil_rays){n, at, end}, NULL,
                        &error) &&
        sgt_trace_chief(from, &beam, l->element, l->index_before, &chief, &error)) {
        sgt_spot spot = sgt_spot_of(1, &(sgt_ends){n, end, 1}, NULL);
        put("spot", 4, &spot.rms);
        double opd[60], off[60];
        sgt_reference about;
        if (sgt_reference_of(l, sgt_launcher_data(from), l->element, l->index_before, &chief, false, &about,
                             &error)) {
            for (size_t i = 0; i < n; i++) opd[i] = sgt_opd(&about, &end[i], &off[i]);
            sgt_wavefront w = sgt_wavefront_of(n, end, opd, off);
            put("wavefront", 5, &w.mean);
        }
        sgt_field_point p;
        sgt_first_order o;
        sgt_seidel sums[3];
        if (sgt_field_curve(from, &beam, l->element, l->index_before, sgt_launcher_data(from),
                            SGT_DISTORTION_TAN, &p, &error))
            put("field", 4, &p.tangential);
        if (sgt_lens_first_order(l, 0.55, &o, sums, &error)) put("first order", 20, &o.power);
        for (int k = 0; k < 3; k++) put("seidel", 7, &sums[k].spherical);
    } else {
        printf("%s: %s\n", error.key, error.words);
    }
    sgt_launcher_free(from);
    sgt_lens_free(l);
}
#endif

#ifdef LATER
static void say(const char *what, const char *answer, bool sound, const sgt_error *e)
{
    printf("%s: %s; %s\n", what, answer, sound ? "sound" : e->key);
}

static void asks(void)
{
    const sgt_surface s = {&sgt_conic_ops, &front};
    const sgt_ray ray = {.o = {0, 0, -9}, .d = {0, 0, 1}};
    sgt_ray traced = ray;
    sgt_error e;
    const sgt_options opt = {.planted_ = 1};
    sgt_hit hit = sgt_intersect(s, ray, &opt);
    say("sgt_options", sgt_status_text(hit.status), sgt_explain_intersect(s, &ray, &opt, NULL, &e), &e);

    const sgt_hits hits = {.status = status, .planted_ = 1};
    sgt_intersect_batch(s, N, rays_of(), hits, NULL);
    say("sgt_hits", sgt_status_text(status[N - 1]), sgt_explain_intersect(s, &ray, NULL, &hits, &e), &e);

    const sgt_traced to = {.fate = fate, .planted_ = 1};
    sgt_trace_batch(1, lens, 1, N, rays_of(), to, NULL, NULL);
    say("sgt_traced", sgt_fate_text(fate[0]), sgt_explain_trace(1, lens, 1, &ray, NULL, &to, NULL, &e), &e);

    const sgt_passages met = {.planted_ = 1};
    sgt_trace_batch(1, lens, 1, N, rays_of(), (sgt_traced){.fate = fate}, &met, NULL);
    say("sgt_passages", sgt_fate_text(fate[0]), sgt_explain_trace(1, lens, 1, &ray, NULL, NULL, &met, &e),
        &e);

    sgt_element element = lens[0];
    element.planted_ = 1;
    sgt_trace(1, &element, 1, &traced, NULL, fate, NULL);
    say("sgt_element", sgt_fate_text(fate[0]), sgt_explain_trace(1, &element, 1, &ray, NULL, NULL, NULL, &e),
        &e);

    sgt_beam beam = {
        .o = {0, 0, -10}, .ou = {1, 0, 0}, .ov = {0, 1, 0}, .d = {0, 0, 1}, .u = {-9, 9}, .v = {-9, 9}};
    sgt_passage passage[2];
    const sgt_aim_options aim = {.planted_ = 1};
    say("sgt_aim_options", sgt_aimed_text(sgt_aim(0, lens, 1, &beam, (sgt_vec2){1, 1}, passage, &aim, NULL)),
        sgt_explain_aim(0, lens, 1, &beam, (sgt_vec2){1, 1}, &aim, &e), &e);
    beam.planted_ = 1;
    say("sgt_beam", sgt_aimed_text(sgt_aim(0, lens, 1, &beam, (sgt_vec2){1, 1}, passage, NULL, NULL)),
        sgt_explain_aim(0, lens, 1, &beam, (sgt_vec2){1, 1}, NULL, &e), &e);

    int lacks = sgt_differentiate_batch(
        s, N, rays_of(), (sgt_hits){.p = {out[3], out[4], out[5]}, .n = {out[6], out[7], out[8]}},
        (sgt_jacobian){.t_by_o = {out[0]}, .planted_ = 1});
    printf("sgt_jacobian: lacks %d\n", lacks);

    const sgt_passages all = {
        .hits = {.status = status, .t = out[0], .p = {out[1], out[2], out[3]}, .n = {out[4], out[5], out[6]},
                 .p_err = out[7]}, .direction = {out[8], out[9], out[10]}};
    const sgt_ray_changes change = {.planted_ = 1}, end = {.opl = out[11]};
    sgt_trace_batch(1, lens, 1, N, rays_of(), (sgt_traced){.fate = fate}, &all, NULL);
    const sgt_traces traces = {N, rays_of(), &all};
    lacks = sgt_trace_sensitivity_batch(1, lens, 1, &traces, 1, &change, &end);
    printf("sgt_ray_changes: lacks %d\n", lacks);
    const sgt_end_errors off = {.point = out[11], .planted_ = 1};
    const size_t known = sgt_trace_error_batch(1, lens, 1, &traces, off);
    printf("sgt_end_errors: %s\n", known && out[11][0] >= 0 ? "known" : "none");
#ifdef WITH_LENS
    const sgt_lens_options how = {.planted_ = 1};
    sgt_lens *l = sgt_lens_read_text("later.yaml", text, sizeof text - 1, &how, &e);
    say("sgt_lens_options", l ? "read" : "refused", l, &e);
    sgt_lens_free(l);
    l = sgt_lens_read_text("later.yaml", text, sizeof text - 1, NULL, &e);
    const sgt_launcher_options launch = {.planted_ = 1};
    sgt_launcher *from = l ? sgt_launcher_new(l, &launch, &e) : NULL;
    say("sgt_launcher_options", from ? "made" : "refused", from, &e);
    sgt_launcher_free(from);
    from = l ? sgt_launcher_new(l, NULL, &e) : NULL;
    const sgt_lens_field field = {.y = 1, .planted_ = 1};
    sgt_field_beam of;
    bool fine = from && sgt_launch_field(from, SGT_FIELD_ANGLE, &field, &of, &e);
    say("sgt_lens_field", fine ? "launched" : "refused", fine, &e);
    sgt_launcher_free(from);
    const sgt_study_options later = {.planted_ = 1};
    sgt_study *study = l ? sgt_study_new(l, &later, &e) : NULL;
    say("sgt_study_options", study ? "made" : "refused", study, &e);
    sgt_study_free(study);
    study = l ? sgt_study_new(l, NULL, &e) : NULL;
    const sgt_analysis *spot = sgt_analysis_named("spot");
    const sgt_sink sink = {.planted_ = 1};
    fine = study && sgt_study_run(study, spot, NULL, &sink, NULL, &e);
    say("sgt_sink", fine ? "run" : "refused", fine, &e);
    const sgt_spot_options how_spot = {.planted_ = 1};
    fine = study && sgt_study_run(study, spot, &how_spot, NULL, NULL, &e);
    say("sgt_spot_options", fine ? "run" : "refused", fine, &e);
    sgt_study_free(study);
    sgt_lens_free(l);
    const double index[] = {1.5, 0};
    const sgt_glass glass = {
        .formula = SGT_DISPERSION_MODEL, .count = 2, .coefficient = index, .planted_ = 1};
    fine = sgt_glass_sound(&glass, &e);
    say("sgt_glass", sgt_glass_index(&glass, 0.55) > 1 ? "an index" : "none", fine, &e);
#endif
}
#endif

int main(int argc, char *argv[])
{
#ifdef LATER
    if (argc > 1 && !strcmp(argv[1], "asks")) return asks(), 0;
#endif
    (void)argc, (void)argv;
    types();
    traces();
#ifdef WITH_LENS
    analyses();
#endif
    return 0;
}
