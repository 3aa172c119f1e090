// SPDX-License-Identifier: MIT
/* main.c - render: pictures of surfaces, by the library's rays.
 *
 * An example of a client: everything about where a ray meets a surface is asked of <sagitta/...>,
 * and what comes back undecided is counted and told. */
#include "fail.h"
#include "film.h"
#include "levels.h"
#include "output.h"
#include "read.h"
#include "tiles.h"

#include <errno.h>
#include <getopt.h>
#include <inttypes.h>
#include <limits.h>
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
    "  --film             the scene's film: its frames, each FILE with -0001 ... before .png\n"
    "  --frames A:B       of a film only frames A to B\n"
    "  --resume           keep frames that are there and whole\n"
    "  --arrays           and FILE-depth.npy, -t_err, -normal, -status: the rays of pixels' middles\n"
    "  --normal KIND      of every object: gradient, difference, or potential (where there is one)\n"
    "  --paint WHAT       not light but one ray for each pixel: evaluations (of F), or status\n"
    "  --help\n"
    "\n"
    "Exit status: 0 drawn, 2 usage, 3 bad input.  Rays that came back undecided are counted and\n"
    "told on standard error; light passes where they went.\n";

enum { NAME_SIZE = 1024 };

typedef struct request {
    const char *scene, *output;
    int width, height, samples, threads, frames, normal;
    int first, last; /* of --frames A:B, from 1; 0: not given */
    bool film, resume, arrays;
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
    enum { OUTPUT, SIZE, SAMPLES, THREADS, FRAMES, NORMAL, PAINT, FILM, RESUME, ARRAYS, HELP_WANTED };
    static const struct option options[] = {
        {"output", required_argument, NULL, OUTPUT},   {"size", required_argument, NULL, SIZE},
        {"samples", required_argument, NULL, SAMPLES}, {"threads", required_argument, NULL, THREADS},
        {"frames", required_argument, NULL, FRAMES},   {"normal", required_argument, NULL, NORMAL},
        {"paint", required_argument, NULL, PAINT},     {"film", no_argument, NULL, FILM},
        {"resume", no_argument, NULL, RESUME},         {"arrays", no_argument, NULL, ARRAYS},
        {"help", no_argument, NULL, HELP_WANTED},      {0}};
    static const char *const normals[] = {"gradient", "difference", "potential", NULL}, *const paints[] = {
                                                                                            "evaluations",
                                                                                            "status", NULL};
    request r = {.threads = tiles_threads(), .normal = -1};
    const char *end;
    for (int code; (code = getopt_long(count, words, "h", options, NULL)) != -1;) switch (code) {
        case OUTPUT:
            r.output = optarg;
            break;
        case SIZE:
            r.width = whole("size", optarg, &end, 20000);
            if (*end != 'x') fail_usage("--size wants WxH, as 640x400, not \"%s\"", optarg);
            r.height = whole("size", end + 1, NULL, 20000);
            break;
        case SAMPLES:
            r.samples = whole("samples", optarg, NULL, 1 << 14);
            break;
        case THREADS:
            r.threads = whole("threads", optarg, NULL, 1024);
            break;
        case FRAMES:
            r.frames = r.first = whole("frames", optarg, &end, 9999);
            r.last = *end == ':' ? whole("frames", end + 1, NULL, 9999) : 0;
            if (*end && *end != ':') fail_usage("--frames wants N, or A:B of a film, not \"%s\"", optarg);
            if (r.last && r.last < r.first) fail_usage("--frames %s: A must not be above B", optarg);
            break;
        case FILM:
            r.film = true;
            break;
        case RESUME:
            r.resume = true;
            break;
        case ARRAYS:
            r.arrays = true;
            break;
        case NORMAL:
            r.normal = choice("normal", optarg, normals);
            break;
        case PAINT:
            r.paint = (paint_kind)(choice("paint", optarg, paints) + 1);
            break;
        case 'h':
        case HELP_WANTED:
            if (fputs(HELP, stdout) < 0 || fflush(stdout)) fail_input("standard output: %s", strerror(errno));
            exit(0);
        default:
            fail_hint();
        }
    if (optind + 1 != count) fail_usage(optind == count ? "which scene?" : "one scene at a time");
    r.scene = words[optind];
    if (r.frames && r.film && !r.last) fail_usage("--frames of a --film wants A:B, as 1:24");
    if (r.last && !r.film) fail_usage("--frames A:B is of a --film");
    if (r.resume && !r.film && !r.frames) fail_usage("--resume is of --film or --frames");
    if (r.film) r.frames = 0;
    return r;
}

/* The name without .png; its length. */
static int stem_of(const request *r, const char **from)
{
    const char *base = strrchr(r->scene, '/');
    *from = r->output ? r->output : base ? base + 1 : r->scene;
    const char *dot = strrchr(*from, '.');
    if (r->output && (!dot || strcmp(dot, ".png") != 0))
        fail_usage("--output wants a name that ends with .png, not \"%s\"", r->output);
    return dot && !strchr(dot, '/') ? (int)(dot - *from) : (int)strlen(*from);
}

/* "a.png", or "a-0007.png" of several; with what: "a-depth.npy". */
static void name_file(char name[NAME_SIZE], const request *r, int frame, const char *what)
{
    const char *from;
    char number[20] = "";
    const int stem = stem_of(r, &from);
    if (r->frames || r->film) snprintf(number, sizeof number, "-%04d", frame + 1);
    const int written = what ? snprintf(name, NAME_SIZE, "%.*s%s-%s.npy", stem, from, number, what)
                             : snprintf(name, NAME_SIZE, "%.*s%s.png", stem, from, number);
    if (written < 0 || written >= NAME_SIZE) fail_usage("--output: a name too long");
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

/* ------------------------------------------------------------------ frames */

/* Of what a frame depends on: the version, the scene's text, what was asked for.  FNV-1a, 64 bits.  Files
 * that the scene names are not looked at.  With arrays it is another digest. */
static uint64_t digest_of(const scene *s, const request *r, int frames, int samples)
{
    bytes text = {0};
    char asked[200];
    snprintf(asked, sizeof asked,
             "render 1, sagitta %s, %d x %d, %d samples, normal %d, paint %d, %d frames%s%s", sgt_version(),
             s->width, s->height, samples, r->normal, (int)r->paint, frames, r->film ? " of a film" : "",
             r->arrays ? ", arrays" : "");
    bytes_add(&text, asked, strlen(asked) + 1);
    if (!output_read(r->scene, &text)) fail_input("%s: %s", r->scene, strerror(errno));
    uint64_t digest = 0xcbf29ce484222325;
    for (size_t i = 0; i < text.n; i++) digest = (digest ^ text.at[i]) * 0x100000001b3;
    free(text.at);
    return digest;
}

static uint64_t digest_of_frame(uint64_t whole_film, int frame)
{
    uint64_t digest = (whole_film ^ (uint64_t)(frame + 1)) * 0x9e3779b97f4a7c15;
    digest ^= digest >> 32;
    return digest ? digest : 1;
}

static const char *const ARRAY_NAMES[] = {"depth", "t_err", "normal", "status", NULL};

/* An array in NumPy's format, version 1.0: a head that is padded to 64 bytes, then the numbers. */
static void write_array(const char *file, const char *type, const picture *p, int width, const void *data,
                        size_t size)
{
    char head[200], deep[20] = "";
    bytes b = {0};
    if (width > 1) snprintf(deep, sizeof deep, ", %d", width);
    int n = snprintf(head, sizeof head, "{'descr': '%s', 'fortran_order': False, 'shape': (%d, %d%s), }",
                     type, p->height, p->width, deep);
    while ((10 + n + 1) % 64) head[n++] = ' ';
    head[n++] = '\n';
    const unsigned char before[10] = {0x93, 'N', 'U', 'M', 'P', 'Y', 1, 0, (unsigned char)n, 0};
    bytes_add(&b, before, sizeof before), bytes_add(&b, head, (size_t)n);
    bytes_add(&b, data, (size_t)p->height * (size_t)p->width * (size_t)width * size);
    output_write(file, &b);
    free(b.at);
}

static void write_arrays(const request *r, int frame, const picture *p, const arrays *a)
{
    static const uint16_t one = 1;
    const char *real = *(const char *)&one ? "<f8" : ">f8";
    char file[NAME_SIZE];
    const void *const data[] = {a->depth, a->t_err, a->normal, a->status};
    for (int i = 0; ARRAY_NAMES[i]; i++) {
        name_file(file, r, frame, ARRAY_NAMES[i]);
        write_array(file, i < 3 ? real : "|i1", p, i == 2 ? 3 : 1, data[i], i < 3 ? 8 : 1);
    }
}

static arrays arrays_new(const picture *p)
{
    const size_t n = (size_t)p->width * (size_t)p->height;
    return (arrays){room(NULL, n, sizeof(double)), room(NULL, n, sizeof(double)),
                    room(NULL, 3 * n, sizeof(double)), room(NULL, n, 1)};
}

static void arrays_free(arrays *a) { free(a->depth), free(a->t_err), free(a->normal), free(a->status); }

/* With arrays the picture's digest has all their bytes in it, so that those of another run, or cut short, are
 * not taken for its own.  false: one is not there. */
static bool add_arrays(const request *r, int frame, uint64_t *digest)
{
    char file[NAME_SIZE];
    for (int i = 0; r->arrays && ARRAY_NAMES[i]; i++) {
        bytes b = {0};
        name_file(file, r, frame, ARRAY_NAMES[i]);
        const bool there = output_read(file, &b);
        for (size_t k = 0; k < b.n; k++) *digest = (*digest ^ b.at[k]) * 0x100000001b3;
        free(b.at);
        if (!there) return false;
    }
    if (*digest == 0) *digest = 1;
    return true;
}

/* Is the frame there, and its arrays, if they are wanted?  The picture is written last. */
static bool is_there(const request *r, int frame, uint64_t digest)
{
    char file[NAME_SIZE];
    name_file(file, r, frame, NULL);
    return add_arrays(r, frame, &digest) && picture_is_whole(file, digest);
}

/* Text between single quotes of a shell; twice: each % stands twice, for ffmpeg. */
static void print_quoted(const char *text, int length, bool twice)
{
    for (int i = 0; i < length; i++)
        printf("%s%c", text[i] == '\'' ? "'\\'" : text[i] == '%' && twice ? "%" : "", text[i]);
}

/* The call that makes a film of the frames. */
static void tell_ffmpeg(const scene *s, const request *r, int first, int frames)
{
    const char *from;
    const int stem = stem_of(r, &from);
    printf("ffmpeg -framerate %g -start_number %d -i '", s->film.rate, first + 1);
    print_quoted(from, stem, true);
    printf("-%%04d.png' -frames:v %d%s -c:v libx264 -pix_fmt yuv420p '", frames,
           s->width % 2 || s->height % 2 ? " -vf 'pad=ceil(iw/2)*2:ceil(ih/2)*2'" : "");
    print_quoted(from, stem, false);
    printf(".mp4'\n");
    if (fflush(stdout)) fail_input("standard output: %s", strerror(errno));
}

/* What is out of range is told before the first frame is drawn. */
static void check_film(scene *s, const request *r, int first, int last)
{
    char why[FILM_WHY];
    for (int i = first; i < last; i++)
        if (!film_set(s, i, why))
            fail_input("%s: film: %s", r->scene, why);
        else if (!camera_is_good(s, film_along(&s->film, i)))
            fail_input(
                "%s: film: frame %d: look_at must be another point than position, and not straight up or "
                "down from it",
                r->scene, i + 1);
}

static void tell_levels(int least, int most)
{
    if (least > most) return;
    if (least == most)
        fprintf(stderr, "render: iterations: auto is %d\n", least);
    else
        fprintf(stderr, "render: iterations: auto is %d to %d\n", least, most);
}

static void draw(scene *s, const request *r)
{
    char file[NAME_SIZE], bar[40], why[FILM_WHY];
    tally total = {0};
    const int frames = r->film ? s->film.frames : r->frames ? r->frames : 1;
    const int samples = r->samples ? r->samples : s->samples;
    const int first = r->film && r->first ? r->first - 1 : 0, last = r->film && r->last ? r->last : frames;
    if (last > frames) fail_input("--frames: the film has only %d frames", frames);
    if (r->film) check_film(s, r, first, last);
    const bool several = r->film || r->frames;
    const uint64_t of_all = several ? digest_of(s, r, frames, samples) : 0;
    picture p = picture_new(s->width, s->height);
    arrays a = {0};
    if (r->arrays) a = arrays_new(&p);
    int todo = 0, drawn = 0, least = INT_MAX, most = 0;
    char *there = room(NULL, (size_t)frames, 1);
    for (int i = first; i < last; i++)
        todo += !(there[i] = r->resume && is_there(r, i, digest_of_frame(of_all, i)));
    const double began = progress_now();
    for (int i = first; i < last; i++) {
        uint64_t digest = several ? digest_of_frame(of_all, i) : 0;
        if (there[i]) continue;
        name_file(file, r, i, NULL);
        output_try(file); /* before the work, and not after */
        snprintf(bar, sizeof bar, "frame %d of %d", i + 1, frames);
        const double along = frames > 1 ? (double)i / (frames - 1) : 0;
        if (r->film) film_set(s, i, why);
        const view v = camera_at(s, along);
        levels_choose(s, &v, &least, &most);
        order o = {samples, r->threads, TILE, i, r->paint, bar, r->arrays ? &a : NULL, {drawn, todo, began}};
        tiles_render(s, along, &o, &p, &total);
        if (r->arrays) write_arrays(r, i, &p, &a);
        if (several && !add_arrays(r, i, &digest)) fail_input("%s: its arrays cannot be read again", file);
        if (r->paint == PAINT_LIGHT)
            picture_write(&p, s->exposure, file, digest);
        else
            paint_write(&p, r->paint, file, digest);
        drawn++;
    }
    free(p.pixel), free(there);
    arrays_free(&a);
    if (total.rays) tell(&total);
    tell_levels(least, most);
    if (r->resume) fprintf(stderr, "render: %d kept, %d drawn\n", last - first - drawn, drawn);
    if (r->film) tell_ffmpeg(s, r, first, last - first);
}

int main(int count, char *words[])
{
    static scene s;
    request r = parse(count, words);
    read_scene(&s, r.scene);
    if (r.width) s.width = r.width, s.height = r.height;
    if (r.film && s.film.frames == 0)
        fail_input("%s: film: missing; it says how many frames there are", r.scene);
    for (int i = 0; i < s.objects && r.normal >= 0; i++) s.object[i].normal = (normal_kind)r.normal;
    draw(&s, &r);
    scene_free(&s);
    return 0;
}
