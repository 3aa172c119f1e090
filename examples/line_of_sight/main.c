// SPDX-License-Identifier: MIT
/* main.c - line_of_sight: from the pixels of a camera in orbit to latitude, longitude and height.
 *
 * An example of a client: where a ray meets the Earth is asked of <sagitta/geo.h>, in one batch;
 * GeographicLib makes latitude, longitude and height of the points. */
#include "fail.h"
#include "picture.h"
#include "table.h"

#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <sagitta/geo.h>
#include <stdlib.h>
#include <string.h>

static const char HELP[] =
    "line_of_sight [options]\n"
    "\n"
    "A camera on a circular orbit sees the Earth line by line.  For each pixel: latitude, longitude and "
    "height of the\n"
    "point it sees, on WGS84, the angle of incidence there, and how far away it is.\n"
    "\n"
    "  the orbit\n"
    "  --altitude KM       above the equator (700)\n"
    "  --inclination DEG   (98)\n"
    "  --node DEG          longitude of the ascending node as the scan begins (30)\n"
    "  --start DEG         how far along the orbit from the node the scan begins (35)\n"
    "  the camera\n"
    "  --field DEG         across a line (60); each pixel has the same part of it\n"
    "  --roll DEG          the middle of the line is turned to the right (0), and\n"
    "  --pitch DEG         ahead (0); right and ahead of the centre of the Earth\n"
    "  --pixels N          of a line (512)\n"
    "  --lines N           (512)\n"
    "  --duration S        from the first line to the last, in seconds (80)\n"
    "  the Earth\n"
    "  --surface NAME      geodetic_height (the default): so high over the ellipsoid; geoid: over the sea "
    "(EGM96);\n"
    "                      level_gravity: where gravity has the potential that it has so high over the "
    "equator\n"
    "  --height M          so high (0)\n"
    "  --geoid FILE        a grid in NOAA's .gtx format; absent: egm96_15.gtx, where PROJ's data are "
    "installed\n"
    "  what comes out\n"
    "  --format FORMAT     text (the default), csv (numbers that read back to the same double) or none\n"
    "  --output FILE       absent: standard output\n"
    "  --picture FILE.png  the swath on a map, and the evaluations of each ray\n"
    "  --colour WHAT       of the map: incidence (the default) or height\n"
    "  --time              how long the rays took, on standard error\n"
    "  --help\n"
    "\n"
    "Exit status: 0 all pixels decided, 1 some undecided, 2 usage, 3 bad input.  A pixel that looks past the "
    "Earth is a miss, and decided.\n";

static const double DEGREE = 0.017453292519943295769;

/* What is asked for, and what that is in the units of the library. */
enum { MOST_RAYS = 20000000 };
typedef enum format { TEXT, CSV, NONE } format;
typedef struct request {
    camera camera;
    double duration, height;
    int surface; /* of sgt_geo_builtins */
    format format;
    const char *geoid, *output, *picture;
    bool by_height, timed;
} request;

static double number(const char *option, const char *text, double least, double most)
{
    char *end;
    double x = strtod(text, &end);
    if (end == text || *end || !(x >= least && x <= most))
        fail_usage("--%s wants a number from %.9g to %.9g, not \"%s\"", option, least, most, text);
    return x;
}

static int whole(const char *option, const char *text, int most)
{
    char *end;
    errno = 0;
    long n = *text >= '0' && *text <= '9' ? strtol(text, &end, 10) : 0;
    if (n < 1 || n > most || errno || *end)
        fail_usage("--%s wants a whole number from 1 to %d, not \"%s\"", option, most, text);
    return (int)n;
}

static int choice(const char *option, const char *text, const char *const words[])
{
    for (int i = 0; words[i]; i++)
        if (strcmp(words[i], text) == 0) return i;
    char known[200] = "";
    for (int i = 0; words[i]; i++)
        snprintf(known + strlen(known), sizeof known - strlen(known), "%s%s", i ? ", " : "", words[i]);
    fail_usage("--%s is one of %s, not \"%s\"", option, known, text);
}

static int surface_named(const char *text)
{
    const char *names[8] = {NULL};
    for (int i = 0; i < 7 && sgt_geo_builtins()[i].type; i++) names[i] = sgt_geo_builtins()[i].type;
    return choice("surface", text, names);
}

static request parse(int count, char *words[])
{
    enum {
        ALTITUDE,
        INCLINATION,
        NODE,
        START,
        FIELD,
        ROLL,
        PITCH,
        PIXELS,
        LINES,
        DURATION,
        SURFACE,
        HEIGHT,
        GEOID,
        FORMAT,
        OUTPUT,
        PICTURE,
        COLOUR,
        TIME,
        HELP_WANTED
    };
    static const struct option options[] = {{"altitude", required_argument, NULL, ALTITUDE},
                                            {"inclination", required_argument, NULL, INCLINATION},
                                            {"node", required_argument, NULL, NODE},
                                            {"start", required_argument, NULL, START},
                                            {"field", required_argument, NULL, FIELD},
                                            {"roll", required_argument, NULL, ROLL},
                                            {"pitch", required_argument, NULL, PITCH},
                                            {"pixels", required_argument, NULL, PIXELS},
                                            {"lines", required_argument, NULL, LINES},
                                            {"duration", required_argument, NULL, DURATION},
                                            {"surface", required_argument, NULL, SURFACE},
                                            {"height", required_argument, NULL, HEIGHT},
                                            {"geoid", required_argument, NULL, GEOID},
                                            {"format", required_argument, NULL, FORMAT},
                                            {"output", required_argument, NULL, OUTPUT},
                                            {"picture", required_argument, NULL, PICTURE},
                                            {"colour", required_argument, NULL, COLOUR},
                                            {"time", no_argument, NULL, TIME},
                                            {"help", no_argument, NULL, HELP_WANTED},
                                            {0}};
    static const char *const formats[] = {"text", "csv", "none", NULL}, *const colours[] = {"incidence",
                                                                                            "height", NULL};
    request r = {.camera = {.altitude = 700e3,
                            .inclination = 98 * DEGREE,
                            .node = 30 * DEGREE,
                            .start = 35 * DEGREE,
                            .field = 60 * DEGREE,
                            .pixels = 512,
                            .lines = 512},
                 .duration = 80,
                 .surface = surface_named("geodetic_height")};
    camera *c = &r.camera;
    for (int code; (code = getopt_long(count, words, "h", options, NULL)) != -1;) switch (code) {
        case ALTITUDE: c->altitude = 1e3 * number("altitude", optarg, 1, 1e6); break;
        case INCLINATION: c->inclination = DEGREE * number("inclination", optarg, 0, 180); break;
        case NODE: c->node = DEGREE * number("node", optarg, -360, 360); break;
        case START: c->start = DEGREE * number("start", optarg, -360, 360); break;
        case FIELD: c->field = DEGREE * number("field", optarg, 0, 360); break;
        case ROLL: c->roll = DEGREE * number("roll", optarg, -180, 180); break;
        case PITCH: c->pitch = DEGREE * number("pitch", optarg, -180, 180); break;
        case PIXELS: c->pixels = whole("pixels", optarg, MOST_RAYS); break;
        case LINES: c->lines = whole("lines", optarg, MOST_RAYS); break;
        case DURATION: r.duration = number("duration", optarg, 0, 1e6); break;
        case SURFACE: r.surface = surface_named(optarg); break;
        case HEIGHT: r.height = number("height", optarg, -1e7, 1e9); break;
        case GEOID: r.geoid = optarg; break;
        case FORMAT: r.format = (format)choice("format", optarg, formats); break;
        case OUTPUT: r.output = optarg; break;
        case PICTURE: r.picture = optarg; break;
        case COLOUR: r.by_height = choice("colour", optarg, colours) == 1; break;
        case TIME: r.timed = true; break;
        case 'h':
        case HELP_WANTED:
            if (fputs(HELP, stdout) < 0 || fflush(stdout)) fail_input("standard output: %s", strerror(errno));
            exit(EXIT_DECIDED);
        default: fail_hint();
        }
    if (optind != count) fail_usage("what is \"%s\"?", words[optind]);
    if ((double)c->lines * c->pixels > MOST_RAYS)
        fail_usage("--pixels times --lines is at most %d", MOST_RAYS);
    if (r.height > c->altitude - 1e3) fail_usage("--height wants to be 1 km below --altitude, and more");
    if (r.geoid && sgt_geo_builtins()[r.surface].ops != &sgt_geoid_height_ops)
        fail_usage("--geoid goes with --surface geoid");
    if (r.output && r.format == NONE) fail_usage("--output, and --format none?");
    if (r.picture) {
        const char *dot = strrchr(r.picture, '.');
        if (!dot || strcmp(dot, ".png") != 0)
            fail_usage("--picture wants a name that ends with .png, not \"%s\"", r.picture);
        if (!picture_can()) fail_usage("--picture: this was built without cairo, which draws it");
    }
    c->line_time = c->lines > 1 ? r.duration / (c->lines - 1) : 0;
    return r;
}

/* Before the work, and not after. */
static FILE *writable(const char *file)
{
    FILE *to = fopen(file, "wb");
    if (!to) fail_input("%s: %s", file, strerror(errno));
    return to;
}

/* The same of a picture: it is renamed when it is whole, and what is there stays until then. */
static void try_picture(const char *file)
{
    char part[PICTURE_NAME];
    picture_part(part, file);
    fclose(writable(part));
    remove(part);
}

/* The parameters, whatever the surface: a height h in each, and for the geoid its grid too. */
typedef union earth { sgt_geodetic_height ellipsoid; sgt_level_gravity level; sgt_geoid_height geoid; } earth;

static sgt_geoid *open_geoid(const request *r)
{
    char found[4096];
    sgt_error error;
    if (!r->geoid && !sgt_geoid_find(found, sizeof found, &error))
        fail_input("--surface geoid: %s (Debian: proj-data); --geoid names a grid", error.words);
    sgt_geoid *geoid = sgt_geoid_open(r->geoid ? r->geoid : found, &error);
    if (!geoid) fail_input("%s: %s", error.file, error.words);
    return geoid;
}

static earth earth_of(const request *r, sgt_geoid **geoid)
{
    const sgt_builtin *row = &sgt_geo_builtins()[r->surface];
    earth e;
    memset(&e, 0, sizeof e);
    *geoid = NULL;
    if (row->ops == &sgt_geodetic_height_ops) e.ellipsoid.h = r->height;
    else if (row->ops == &sgt_level_gravity_ops) e.level.h = r->height;
    else e.geoid = (sgt_geoid_height){*geoid = open_geoid(r), r->height};
    sgt_objection no = row->object(&e);
    if (no.param) fail_input("--height %.9g, on the surface %s: %s", r->height, row->type, no.reason);
    return e;
}

static void write_table(const request *r, const scan *s, FILE *to)
{
    if (r->format == NONE) return;
    (r->format == CSV ? table_csv : table_text)(to, s);
    if (fflush(to) || ferror(to) || (r->output && fclose(to)))
        fail_input("%s: %s", r->output ? r->output : "standard output", strerror(errno));
}

static void draw(const request *r, const scan *s)
{
    const camera *c = &r->camera;
    const sgt_surface_ops *ops = sgt_geo_builtins()[r->surface].ops;
    const char *level = ops == &sgt_level_gravity_ops ? "level of gravity " : "",
               *over = *level                         ? "equator"
                       : ops == &sgt_geoid_height_ops ? "geoid"
                                                      : "ellipsoid";
    char title[240];
    snprintf(title, sizeof title,
             "From %g km, inclination %g\302\260, field %g\302\260: %d line%s of %d pixel%s in %g s, %s%g m "
             "over the %s",
             c->altitude / 1e3, c->inclination / DEGREE, c->field / DEGREE, c->lines,
             c->lines == 1 ? "" : "s", c->pixels, c->pixels == 1 ? "" : "s", c->line_time * (c->lines - 1),
             level, r->height, over);
    picture_write(r->picture, s, title, r->by_height);
}

static void tell(const request *r, const scan *s)
{
    double evals = 0;
    int most = 0;
    for (size_t i = 0; i < s->rays; i++) {
        evals += s->evals[i];
        if (s->evals[i] > most) most = s->evals[i];
    }
    fprintf(
        stderr,
        "%zu pixel%s: %zu on the Earth, %zu past it, %zu undecided.  %.2f evaluations each, at most %d.\n",
        s->rays, s->rays == 1 ? "" : "s", s->met, s->rays - s->met - s->undecided, s->undecided,
        evals / (double)s->rays, most);
    if (r->timed)
        fprintf(stderr, "%.3g s, in one thread: %.3g million rays a second.\n", s->seconds,
                1e-6 * (double)s->rays / s->seconds);
}

int main(int count, char *words[])
{
    sgt_geoid *geoid;
    request r = parse(count, words);
    earth e = earth_of(&r, &geoid);
    FILE *to = r.output ? writable(r.output) : stdout;
    if (r.picture) try_picture(r.picture);
    scan s = scan_begin(&r.camera);
    scan_meet(&s, (sgt_surface){sgt_geo_builtins()[r.surface].ops, &e});
    write_table(&r, &s, to);
    if (r.picture) draw(&r, &s);
    tell(&r, &s);
    bool undecided = s.undecided > 0;
    scan_end(&s);
    sgt_geoid_close(geoid);
    return undecided ? EXIT_UNDECIDED : EXIT_DECIDED;
}
