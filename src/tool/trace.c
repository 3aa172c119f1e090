/* trace.c - sagitta trace: rays through a lens. */
#include "commands.h"
#include "frame.h"
#include "input.h"
#include "job.h"
#include "memory.h"
#include "picture.h"
#include "profile.h"
#include "scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char help[] =
    "sagitta trace LENS [options]\n"
    "\n"
    "Traces rays through a lens file.  One row for each ray and each element it reached: the\n"
    "ray (from 0, field after field), the element (from 1), its fate there (passed, missed,\n"
    "clipped, tir, lost), the solver's status, the point and the direction behind the\n"
    "surface, t from the element before and a bound on its error, the optical path length\n"
    "from the launch, and the evaluations spent.  Object at infinity: the rays of a field\n"
    "start on a common wavefront.\n"
    "\n"
    "A lens file is YAML; docs/lens_file.md has every key, examples/lenses complete files.\n"
    "  file:     name, units, wavelengths: [um], object: {distance, index},\n"
    "            pupil: {semi_diameter, distance}, fields: [degrees], surfaces: [...]\n"
    "  surface:  type, radius or curvature, conic, coefficients, semi_diameter,\n"
    "            thickness (to the next), index (behind it), mirror, stop,\n"
    "            decenter and tilt: [x, y, z]; or origin and tilt in all of them\n"
    "\n";
static const char more_help[] =
    "  --frame F          local (the default): points and directions in each surface's own\n"
    "                     frame; global: in that of the first vertex\n"
    "  --svg FILE         draws the y-z section with the rays\n"
    "  --pick P           near-seed (the default): the root near the surface's vertex; first\n";

static const column head[] = {
    {"ray", COLUMN_COUNT}, {"element", COLUMN_COUNT}, {"fate", COLUMN_WORD}, {"status", COLUMN_WORD},
    {"x", COLUMN_NUMBER}, {"y", COLUMN_NUMBER}, {"z", COLUMN_NUMBER},
    {"l", COLUMN_NUMBER}, {"m", COLUMN_NUMBER}, {"n", COLUMN_NUMBER},
    {"t", COLUMN_NUMBER}, {"t_err", COLUMN_ERROR}, {"opl", COLUMN_NUMBER}, {"evals", COLUMN_COUNT},
    {"id", COLUMN_WORD},
};
enum { HEAD_COUNT = sizeof head / sizeof head[0] };

typedef struct arguments {
    shared_options shared;
    job_options job;
    bool global;
    const char *svg;
} arguments;

static arguments arguments_of(int argc, char *argv[])
{
    enum { FRAME = OPTION_AFTER_JOB, SVG };
    static const struct option known[] = {
        {"frame", required_argument, NULL, FRAME}, {"svg", required_argument, NULL, SVG},
        JOB_OPTIONS, SHARED_OPTIONS, {0},
    };
    char all_help[6000];
    snprintf(all_help, sizeof all_help, "%s%s%s", help, job_help, more_help);
    arguments a = {.svg = NULL};
    for (int code; (code = getopt_long(argc, argv, "h", known, NULL)) != -1;) {
        if (code == SVG) {
            a.svg = optarg;
        } else if (code == FRAME) {
            a.global = strcmp(optarg, "global") == 0;
            if (!a.global && strcmp(optarg, "local") != 0) fail_usage("--frame wants local or global, not \"%s\"", optarg);
        } else if (!job_take(&a.job, code)) {
            options_take(&a.shared, code, all_help);
        }
    }
    if (optind == argc) fail_usage("which lens?");
    if (optind + 1 < argc) fail_usage("one lens at a time; what is \"%s\"?", argv[optind + 1]);
    a.job.lens = argv[optind];
    if (a.svg) picture_check();
    return a;
}

/* ------------------------------------------------------------------- rows */

/* What is not: the point of a miss, the direction of a ray that went no farther. */
static const sgt_vec3 nowhere = {(double)NAN, (double)NAN, (double)NAN};

static void write_vector(table *t, sgt_vec3 v)
{
    table_number(t, v.x);
    table_number(t, v.y);
    table_number(t, v.z);
}

static void write_row(table *t, const launch *l, size_t element, sgt_fate fate, const sgt_passage *p,
                      const sgt_pose *pose, bool named)
{
    sgt_vec3 point = p->hit.status > 0 ? p->hit.p : nowhere, direction = fate == SGT_PASSED ? p->direction : nowhere;
    table_count(t, (long long)l->number);
    table_count(t, (long long)element + 1);
    table_word(t, sgt_fate_text(fate));
    table_word(t, sgt_status_text(p->hit.status));
    write_vector(t, pose ? frame_point_out(pose, point) : point);
    write_vector(t, pose ? frame_direction_out(pose, direction) : direction);
    table_number_within(t, p->hit.t, p->hit.t_err);
    table_number(t, p->opl);
    table_count(t, p->hit.evals);
    if (named) table_word(t, l->id);
}

/* ----------------------------------------------------------------- losses */

/* What each element did to rays that ended there. */
typedef struct losses {
    size_t clipped, tir, missed, lost[SGT_HIT - SGT_INVALID + 1]; /* lost: by status */
} losses;

static void count_loss(losses *l, sgt_fate fate, sgt_status status)
{
    if (fate == SGT_CLIPPED) l->clipped++;
    else if (fate == SGT_TIR) l->tir++;
    else if (fate == SGT_MISSED) l->missed++;
    else l->lost[(status < 0 ? (int)status : 0) - SGT_INVALID]++;
}

static void append(char text[400], size_t n, const char *what, const char *reason)
{
    size_t length = strlen(text);
    if (n) snprintf(text + length, 400 - length, "%s %zu %s%s", length ? "," : "", n, what, reason);
}

static void write_losses(table *t, const job *j, size_t passed, const losses loss[])
{
    table_line(t, "%zu of %zu ray%s passed all %zu elements.", passed, j->rays.count, j->rays.count == 1 ? "" : "s",
               j->lens.count);
    for (size_t i = 0; i < j->lens.count; i++) {
        char text[400] = "";
        append(text, loss[i].missed, "missed it", "");
        append(text, loss[i].clipped, "clipped at its rim", "");
        append(text, loss[i].tir, "totally reflected", "");
        for (int s = 0; s >= SGT_INVALID; s--) {
            char reason[40];
            snprintf(reason, sizeof reason, " (%s)", s ? sgt_status_text((sgt_status)s) : "where to?");
            append(text, loss[i].lost[s - SGT_INVALID], "lost", reason);
        }
        if (*text) table_line(t, "element %zu (%s):%s", i + 1, j->lens.surface[i].type, text);
    }
}

/* ------------------------------------------------------------------ trace */

exit_status command_trace(int argc, char *argv[])
{
    arguments a = arguments_of(argc, argv);
    job j = job_read(&a.job);
    options_note_unread(&a.shared, j.lens.count, j.element);
    const size_t count = j.lens.count;
    sgt_passage *passage = memory_take(count, sizeof *passage);
    sgt_vec3 *point = memory_take(count + 1, sizeof *point);
    losses *loss = memory_take(count, sizeof *loss);
    if (a.svg) {
        if (a.shared.target.path) output_check("output", a.shared.target.path); /* before a picture is begun */
        output_reserve("svg", a.svg);
        for (size_t i = 0; i < count; i++)
            if (!profile_is_sag(j.element[i].surface))
                note("--svg: element %zu (%s) is not a sag, and is not drawn", i + 1, j.lens.surface[i].type);
    }
    scene picture = scene_begin(&j);
    table *t = table_begin(&a.shared.target, j.rays.named ? HEAD_COUNT : HEAD_COUNT - 1, head);
    size_t all = 0, undecided = 0;
    for (size_t r = 0; r < j.rays.count; r++) {
        const launch *l = &j.rays.ray[r];
        sgt_ray ray = l->ray;
        sgt_fate fate;
        size_t passed = sgt_trace(count, j.element, j.lens.object_index, &ray, passage, &fate, &a.shared.solver);
        size_t reached = passed + (fate != SGT_PASSED);
        size_t met = passed + (fate == SGT_CLIPPED || fate == SGT_TIR);
        if (r > 0) table_gap(t);
        for (size_t i = 0; i < reached; i++) {
            sgt_fate here = i < passed ? SGT_PASSED : fate;
            write_row(t, l, i, here, &passage[i], a.global ? &j.element[i].pose : NULL, j.rays.named);
        }
        if (fate == SGT_PASSED) all++;
        else count_loss(&loss[passed], fate, passage[passed].hit.status);
        if (fate < 0) undecided++;
        point[0] = l->ray.o;
        for (size_t i = 0; i < met; i++) point[i + 1] = frame_point_out(&j.element[i].pose, passage[i].hit.p);
        if (a.svg) scene_add(&picture, l->field, met + 1, point, fate, ray.d);
    }
    write_losses(t, &j, all, loss);
    table_end(t);
    if (a.svg) {
        scene_finish(&picture);
        picture_write(a.svg, &picture);
    }
    return undecided ? EXIT_UNDECIDED : EXIT_DECIDED;
}
