// SPDX-License-Identifier: MIT
/* main.c - render: pictures of surfaces, by the library's rays.
 *
 * An example of a client: everything about where a ray meets a surface is asked of <sagitta/...>,
 * and what comes back undecided is counted and told. */
#include "fail.h"
#include "read.h"
#include "tiles.h"

#include <errno.h>
#include <getopt.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char HELP[] =
    "render [options] SCENE.yaml\n"
    "\n"
    "Draws a scene (docs/render.md says what can be in one) as a PNG.\n"
    "\n"
    "  --output FILE      the picture; without it the scene's name with .png, here\n"
    "  --size WxH         pixels, not the scene's\n"
    "  --samples N        rays of the camera for each pixel, not the scene's\n"
    "  --threads N        not as many as there are processors; the picture is the same\n"
    "  --frames N         N pictures along the camera's path: FILE with -0001 ... before .png\n"
    "  --normal KIND      of every object: gradient, difference, or potential (where there is one)\n"
    "  --paint WHAT       not light but one ray for each pixel: evaluations (of F), or status\n"
    "  --help\n"
    "\n"
    "Exit status: 0 drawn, 2 usage, 3 bad input.  Rays that came back undecided are counted and\n"
    "told on standard error; light passes where they went.\n";

typedef struct request {
    const char *scene, *output;
    int width, height, samples, threads, frames, normal;
    paint_kind paint;
} request;

static int whole(const char *option, const char *text, const char **end, int most)
{
    char *stop;
    errno = 0;
    long n = *text >= '0' && *text <= '9' ? strtol(text, &stop, 10) : 0;
    if (n < 1 || n > most || errno || (!end && *stop))
        fail_usage("--%s wants a whole number from 1 to %d, not \"%s\"", option, most, text);
    if (end) *end = stop;
    return (int)n;
}

static int choice(const char *option, const char *text, const char *const words[])
{
    for (int i = 0; words[i]; i++)
        if (strcmp(words[i], text) == 0) return i;
    char known[100] = "";
    for (int i = 0; words[i]; i++)
        snprintf(known + strlen(known), sizeof known - strlen(known), "%s%s", i ? ", " : "", words[i]);
    fail_usage("--%s is one of %s, not \"%s\"", option, known, text);
}

static request parse(int count, char *words[])
{
    enum { OUTPUT, SIZE, SAMPLES, THREADS, FRAMES, NORMAL, PAINT, HELP_WANTED };
    static const struct option options[] = {
        {"output", required_argument, NULL, OUTPUT}, {"size", required_argument, NULL, SIZE},
        {"samples", required_argument, NULL, SAMPLES}, {"threads", required_argument, NULL, THREADS},
        {"frames", required_argument, NULL, FRAMES}, {"normal", required_argument, NULL, NORMAL},
        {"paint", required_argument, NULL, PAINT}, {"help", no_argument, NULL, HELP_WANTED}, {0}};
    static const char *const normals[] = {"gradient", "difference", "potential", NULL}, *const paints[] = {
                                                                                            "evaluations",
                                                                                            "status", NULL};
    request r = {.threads = tiles_threads(), .normal = -1};
    const char *end;
    for (int code; (code = getopt_long(count, words, "h", options, NULL)) != -1;) switch (code) {
        case OUTPUT: r.output = optarg; break;
        case SIZE:
            r.width = whole("size", optarg, &end, 20000);
            if (*end != 'x') fail_usage("--size wants WxH, as 640x400, not \"%s\"", optarg);
            r.height = whole("size", end + 1, NULL, 20000);
            break;
        case SAMPLES: r.samples = whole("samples", optarg, NULL, 1 << 14); break;
        case THREADS: r.threads = whole("threads", optarg, NULL, 1024); break;
        case FRAMES: r.frames = whole("frames", optarg, NULL, 9999); break;
        case NORMAL: r.normal = choice("normal", optarg, normals); break;
        case PAINT: r.paint = (paint_kind)(choice("paint", optarg, paints) + 1); break;
        case 'h':
        case HELP_WANTED:
            if (fputs(HELP, stdout) < 0 || fflush(stdout)) fail_input("standard output: %s", strerror(errno));
            exit(0);
        default: fail_hint();
        }
    if (optind + 1 != count) fail_usage(optind == count ? "which scene?" : "one scene at a time");
    r.scene = words[optind];
    return r;
}

/* "a.png", or "a-0007.png" of several. */
static void name_frame(char name[], size_t size, const request *r, int frame)
{
    const char *base = strrchr(r->scene, '/'), *from = r->output ? r->output : base ? base + 1 : r->scene;
    const char *dot = strrchr(from, '.');
    int stem = dot && !strchr(dot, '/') ? (int)(dot - from) : (int)strlen(from);
    int written = r->frames ? snprintf(name, size, "%.*s-%04d.png", stem, from, frame + 1)
                            : snprintf(name, size, "%.*s.png", stem, from);
    if (written < 0 || (size_t)written >= size) fail_usage("--output: a name too long");
    if (r->output && (!dot || strcmp(dot, ".png") != 0))
        fail_usage("--output wants a name that ends with .png, not \"%s\"", r->output);
}

static void tell(const tally *t)
{
    uint64_t undecided = 0;
    for (int i = 0; i < UNDECIDED_KINDS; i++) undecided += t->undecided[i];
    fprintf(stderr, "render: %" PRIu64 " rays, %.1f evaluations each, %" PRIu64 " undecided", t->rays,
            (double)t->evals / (double)t->rays, undecided);
    for (int i = 0; i < UNDECIDED_KINDS; i++)
        if (t->undecided[i])
            fprintf(stderr, ", %" PRIu64 " %s", t->undecided[i], sgt_status_text((sgt_status)(-1 - i)));
    fputc('\n', stderr);
}

static void draw(scene *s, const request *r)
{
    char file[1024], bar[40];
    tally total = {0};
    picture p = picture_new(s->width, s->height);
    int frames = r->frames ? r->frames : 1;
    for (int i = 0; i < frames; i++) {
        name_frame(file, sizeof file, r, i);
        FILE *writable = fopen(file, "ab"); /* before the work, and not after */
        if (!writable) fail_input("%s: %s", file, strerror(errno));
        fclose(writable);
        snprintf(bar, sizeof bar, "frame %d of %d", i + 1, frames);
        order o = {r->samples ? r->samples : s->samples, r->threads, TILE, i, r->paint, bar};
        tiles_render(s, frames > 1 ? (double)i / (frames - 1) : 0, &o, &p, &total);
        if (r->paint == PAINT_LIGHT) picture_write(&p, s->exposure, file);
        else paint_write(&p, r->paint, file);
    }
    free(p.pixel);
    tell(&total);
}

int main(int count, char *words[])
{
    static scene s;
    request r = parse(count, words);
    read_scene(&s, r.scene);
    if (r.width) s.width = r.width, s.height = r.height;
    for (int i = 0; i < s.objects && r.normal >= 0; i++) s.object[i].normal = (normal_kind)r.normal;
    draw(&s, &r);
    scene_free(&s);
    return 0;
}
