// SPDX-License-Identifier: MIT
/* read.c - a scene file, key by key; docs/render.md has the list of them.
 *
 * A reader of a map opens it with the keys it knows and then asks for each; a key that is absent
 * leaves the default, which was set before. */
#include "read.h"

#include "document.h"
#include "own.h"
#include "sample.h"
#include "shape.h"

#include <sagitta/surfaces.h>
#include <stdio.h>
#include <string.h>

static const double FAR = 1e6; /* of all lengths */

static void read_real(document *d, const node *map, const char *key, double lo, double hi, double *x)
{
    const node *n = document_find(d, map, key);
    if (n) *x = document_number(d, n, key, lo, hi);
}

static void read_whole(document *d, const node *map, const char *key, int lo, int hi, int *x)
{
    const node *n = document_find(d, map, key);
    if (n) *x = document_whole(d, n, key, lo, hi);
}

static vec3 vector_of(document *d, const node *n, const char *key, double lo, double hi)
{
    double v[3];
    document_numbers(d, n, key, 3, 3, lo, hi, v);
    return (vec3){v[0], v[1], v[2]};
}

static void read_vector(document *d, const node *map, const char *key, double lo, double hi, vec3 *v)
{
    const node *n = document_find(d, map, key);
    if (n) *v = vector_of(d, n, key, lo, hi);
}

static void read_colour(document *d, const node *map, const char *key, double hi, vec3 *v)
{
    read_vector(d, map, key, 0, hi, v);
}

/* A point, or a list of points. */
static void read_path(document *d, const node *map, const char *key, path *p)
{
    const node *n = document_find(d, map, key);
    if (!n) document_fail(d, map, key, "missing");
    bool several = n->type == YAML_SEQUENCE_NODE && document_list(d, n, key, 1, MOST_POINTS) > 0 &&
                   document_item(d, n, 0)->type == YAML_SEQUENCE_NODE;
    p->count = several ? document_list(d, n, key, 1, MOST_POINTS) : 1;
    for (int i = 0; i < p->count; i++)
        p->point[i] = vector_of(d, several ? document_item(d, n, i) : n, key, -FAR, FAR);
}

static void read_camera(document *d, const node *map, scene *s)
{
    double degrees = 40;
    document_map(d, map, "camera", "position look_at up field");
    read_path(d, map, "position", &s->camera.position);
    read_path(d, map, "look_at", &s->camera.look_at);
    read_vector(d, map, "up", -FAR, FAR, &s->camera.up);
    read_real(d, map, "field", 0.001, 170, &degrees);
    s->camera.field = degrees * 0.017453292519943295;
    vec3 forward = subtract(s->camera.look_at.point[0], s->camera.position.point[0]);
    if (!(length(cross(forward, s->camera.up)) > 1e-9 * length(forward) * length(s->camera.up)))
        document_fail(d, map, "look_at",
                      "must be another point than position, and not straight up or down from it");
}

static void read_picture(document *d, const node *map, scene *s)
{
    document_map(d, map, "picture", "size samples depth exposure");
    const node *n = document_find(d, map, "size");
    if (n) {
        document_list(d, n, "size", 2, 2);
        s->width = document_whole(d, document_item(d, n, 0), "size", 1, 20000);
        s->height = document_whole(d, document_item(d, n, 1), "size", 1, 20000);
    }
    read_whole(d, map, "samples", 1, SAMPLE_MOST, &s->samples);
    read_whole(d, map, "depth", 0, MOST_DEPTH, &s->depth);
    read_real(d, map, "exposure", 0, 1e6, &s->exposure);
}

static void read_sky(document *d, const node *map, scene *s)
{
    document_map(d, map, "sky", "zenith horizon ground haze");
    read_colour(d, map, "zenith", 1e6, &s->sky.zenith);
    read_colour(d, map, "horizon", 1e6, &s->sky.horizon);
    s->sky.ground = s->sky.horizon;
    read_colour(d, map, "ground", 1e6, &s->sky.ground);
    read_real(d, map, "haze", 0, FAR, &s->sky.haze);
}

static void read_ambient(document *d, const node *map, scene *s)
{
    document_map(d, map, "ambient", "strength reach rays");
    read_real(d, map, "strength", 0, 1e6, &s->ambient.strength);
    read_real(d, map, "reach", 0, FAR, &s->ambient.reach);
    read_whole(d, map, "rays", 0, 256, &s->ambient.rays);
}

static void read_lights(document *d, const node *list, scene *s)
{
    s->lights = document_list(d, list, "lights", 0, MOST_LIGHTS);
    for (int i = 0; i < s->lights; i++) {
        const node *map = document_item(d, list, i);
        light *l = &s->light[i];
        *l = (light){.colour = {1, 1, 1}};
        document_map(d, map, "lights", "position colour radius");
        if (!document_find(d, map, "position")) document_fail(d, map, "position", "missing");
        read_vector(d, map, "position", -FAR, FAR, &l->position);
        read_colour(d, map, "colour", 1e6, &l->colour);
        read_real(d, map, "radius", 0, FAR, &l->radius);
    }
}

static void read_colours(document *d, const node *map, int least, pattern *p)
{
    const node *list = document_find(d, map, "colours");
    if (!list) document_fail(d, map, "colours", "missing");
    p->count = document_list(d, list, "colours", least, p->kind == PATTERN_CHECKS ? 2 : MOST_COLOURS);
    for (int i = 0; i < p->count; i++)
        p->colour[i] = vector_of(d, document_item(d, list, i), "colours", 0, 1);
}

/* [r, g, b], or {checks: size, colours: [...]}, or {blend: radius, from: 0, to: 1, colours: [...]}. */
static void read_pattern(document *d, const node *n, pattern *p)
{
    static const char *const axes[] = {"x", "y", "z", "radius", "trap", NULL};
    *p = (pattern){.kind = PATTERN_PLAIN, .count = 1, .to = 1};
    if (n->type != YAML_MAPPING_NODE) {
        p->colour[0] = vector_of(d, n, "colour", 0, 1);
        return;
    }
    document_map(d, n, "colour",
                 document_find(d, n, "checks") ? "checks colours" : "blend from to trap colours");
    if (document_find(d, n, "checks")) {
        p->kind = PATTERN_CHECKS;
        read_real(d, n, "checks", 1e-6, FAR, &p->size);
    } else {
        const node *by = document_find(d, n, "blend");
        if (!by) document_fail(d, n, "blend", "missing: by what?  Or checks");
        p->kind = PATTERN_BLEND;
        p->by = document_choice(d, by, "blend", axes);
        read_real(d, n, "from", -FAR, FAR, &p->from);
        read_real(d, n, "to", -FAR, FAR, &p->to);
        if (p->from == p->to) document_fail(d, n, "to", "must differ from `from`");
        const node *trap = document_find(d, n, "trap");
        if (trap && p->by != BY_TRAP) document_fail(d, trap, "trap", "only of {blend: trap}");
        if (trap) document_numbers(d, trap, "trap", 4, 4, -FAR, FAR, p->trap);
    }
    read_colours(d, n, 2, p);
}

static void read_material(document *d, const node *map, material *m)
{
    document_map(d, map, "material", "colour diffuse specular shininess reflection index absorption");
    const node *colour = document_find(d, map, "colour");
    if (colour) read_pattern(d, colour, &m->pattern);
    read_real(d, map, "diffuse", 0, 10, &m->diffuse);
    read_real(d, map, "specular", 0, 10, &m->specular);
    read_real(d, map, "shininess", 1, 1e6, &m->shininess);
    read_real(d, map, "reflection", 0, 1, &m->reflection);
    read_real(d, map, "index", 1, 10, &m->index);
    read_colour(d, map, "absorption", 1e6, &m->absorption);
}

/* ------------------------------------------------------------------ bodies */

/* What is above an object: its place in the world, and what it has unless it says otherwise. */
typedef struct setting {
    sgt_pose pose;
    double scale;
    sgt_options options;
    normal_kind normal;
    material material;
} setting;

/* Of something placed within the frame `in`. */
static void place_in(const setting *in, vec3 position, vec3 rotation, double scale, sgt_pose *pose,
                     double *all)
{
    sgt_pose own = sgt_pose_tilted(position, rotation);
    *all = in->scale * scale;
    pose->origin = along(in->pose.origin, in->scale, turned(&in->pose, position));
    pose->ex = turned(&in->pose, own.ex), pose->ey = turned(&in->pose, own.ey),
    pose->ez = turned(&in->pose, own.ez);
}

#define OF_ALL "position rotation scale t_tol dt_min max_evals normal material"
static const char OF_OBJECT[] = OF_ALL " clip",
                  OF_COMPOUND[] = "union intersection difference " OF_ALL " clip";
static const char *const NORMALS[] = {"gradient", "difference", "potential", NULL};

/* The keys that all have, read into what is above; returns its own setting. */
static setting read_setting(document *d, const node *map, const setting *in)
{
    setting own = *in;
    vec3 position = {0}, rotation = {0};
    double scale = 1;
    read_vector(d, map, "position", -FAR, FAR, &position);
    read_vector(d, map, "rotation", -FAR, FAR, &rotation);
    read_real(d, map, "scale", 1e-6, FAR, &scale);
    place_in(in, position, rotation, scale, &own.pose, &own.scale);
    read_real(d, map, "t_tol", 0, FAR, &own.options.t_tol);
    read_real(d, map, "dt_min", 0, FAR, &own.options.dt_min);
    read_whole(d, map, "max_evals", 0, 1 << 30, &own.options.max_evals);
    const node *normal = document_find(d, map, "normal"), *of = document_find(d, map, "material");
    if (normal) own.normal = (normal_kind)document_choice(d, normal, "normal", NORMALS);
    if (of) read_material(d, of, &own.material);
    return own;
}

static bool has_potential(const object *o)
{
    return o->surface.ops == &sgt_julia_ops || o->surface.ops == &sgt_mandelbrot_ops;
}

/* A surface: the next object of the scene. */
static void read_surface(document *d, const node *map, const setting *in, bool part, scene *s)
{
    if (s->objects == MOST_OBJECTS) document_fail(d, map, "objects", "more than %d surfaces", MOST_OBJECTS);
    object *o = &s->object[s->objects];
    *o = (object){.scale = 1};
    shape_read(d, map, OF_OBJECT, o);
    s->objects++;
    const setting own = read_setting(d, map, in);
    o->pose = own.pose, o->scale = own.scale, o->options = own.options, o->normal = own.normal;
    o->material = own.material;
    const node *normal = document_find(d, map, "normal"), *rim = document_find(d, map, "semi_diameter");
    if (normal && o->normal == NORMAL_POTENTIAL && !has_potential(o))
        document_fail(d, normal, "normal", "only julia and mandelbrot have a potential");
    if (o->material.pattern.by == BY_TRAP && !has_potential(o))
        document_fail(d, map, "material", "a trap is of an orbit: of julia and mandelbrot");
    if (part && o->surface.ops == &edge_ops)
        document_fail(d, document_find(d, map, "type"), "type",
                      "an edge has no inside: take a quadric and planes");
    if (part && rim)
        document_fail(d, rim, "semi_diameter",
                      "a part has no rim: its inside is all that lies below the sag");
}

static int add_knot(document *d, const node *at, operation op, scene *s)
{
    if (s->knots == MOST_KNOTS) document_fail(d, at, "objects", "more than %d parts of bodies", MOST_KNOTS);
    s->knot[s->knots] = (knot){.op = op, .object = s->objects};
    return s->knots++;
}

/* The key of an operation that the map has; NULL: none. */
static const node *operation_of(document *d, const node *map, operation *op, const char **key)
{
    static const char *const names[] = {"union", "intersection", "difference"};
    const node *found = NULL;
    for (int i = 0; i < 3; i++) {
        const node *n = document_find(d, map, names[i]);
        if (n && found) document_fail(d, n, names[i], "given beside %s; an object is one of them", *key);
        if (n) found = n, *op = (operation)(UNION + i), *key = names[i];
    }
    const node *type = document_find(d, map, "type");
    if (found && type) document_fail(d, type, "type", "given beside %s; an object is one of them", *key);
    return found;
}

/* An object, or several, as a tree; part: of a tree, or a region that clips. */
static int read_tree(document *d, const node *map, const setting *in, bool part, int depth, scene *s)
{
    enum { DEPTH_MOST = 32, CHILDREN_MOST = 64 };
    operation op = PART;
    const char *key;
    document_keys(d, map, "objects");
    const node *list = operation_of(d, map, &op, &key), *cut = document_find(d, map, "clip");
    if (cut && part)
        document_fail(d, cut, "clip",
                      "what is clipped has no inside: a part is cut by an intersection or difference");
    int at = add_knot(d, map, op, s);
    if (list) {
        if (depth == DEPTH_MOST) document_fail(d, list, key, "more than %d within each other", DEPTH_MOST);
        document_map(d, map, NULL, OF_COMPOUND);
        setting own = read_setting(d, map, in);
        int count = document_list(d, list, key, 2, CHILDREN_MOST);
        for (int i = 0; i < count; i++) read_tree(d, document_item(d, list, i), &own, true, depth + 1, s);
    } else {
        read_surface(d, map, in, part, s);
    }
    s->knot[at].end = s->knots;
    return at;
}

/* {ball: radius}, {box: [a, b, c]}, both with position and rotation; {object: ...} or {outside: ...} */
static void read_clip(document *d, const node *map, const setting *in, scene *s, clip *c)
{
    static const char *const kinds[] = {"ball", "box", "object", "outside"};
    static const char *const known[] = {"ball position rotation", "box position rotation", "object",
                                        "outside"};
    vec3 position = {0}, rotation = {0};
    const node *n = NULL;
    document_keys(d, map, "clip");
    for (int i = 0; i < 4 && !n; i++)
        if ((n = document_find(d, map, kinds[i]))) c->kind = (clip_kind)i;
    if (!n) document_fail(d, map, "clip", "wants one of the keys ball, box, object, outside");
    document_map(d, map, "clip", known[c->kind]);
    if (c->kind == CLIP_BALL) {
        double radius = document_number(d, n, "ball", 1e-6, FAR);
        c->half = (vec3){radius, radius, radius};
    } else if (c->kind == CLIP_BOX) {
        c->half = vector_of(d, n, "box", 1e-6, FAR);
    } else {
        c->knot = read_tree(d, n, in, true, 0, s);
    }
    read_vector(d, map, "position", -FAR, FAR, &position);
    read_vector(d, map, "rotation", -FAR, FAR, &rotation);
    place_in(in, position, rotation, 1, &c->pose, &c->scale);
}

static void read_clips(document *d, const node *n, const setting *in, scene *s, body *of)
{
    bool several = n->type == YAML_SEQUENCE_NODE;
    of->clips = several ? document_list(d, n, "clip", 1, MOST_CLIPS) : 1;
    for (int i = 0; i < of->clips; i++)
        read_clip(d, several ? document_item(d, n, i) : n, in, s, &of->clip[i]);
}

static void read_body(document *d, const node *map, scene *s)
{
    const setting plain = {
        .pose = sgt_pose_tilted((vec3){0}, (vec3){0}),
        .scale = 1,
        .material = {.pattern = {.count = 1, .colour = {{0.7, 0.7, 0.7}}}, .diffuse = 1, .shininess = 40}};
    body *of = &s->body[s->bodies];
    *of = (body){.first = s->objects};
    of->knot = read_tree(d, map, &plain, false, 0, s);
    of->parts = s->objects - of->first;
    const node *cut = document_find(d, map, "clip");
    if (cut) {
        setting own = read_setting(d, map, &plain);
        read_clips(d, cut, &own, s, of);
    }
    s->bodies++;
}

/* -------------------------------------------------------------------- film */

static int width_of(track_kind kind)
{
    return kind == TRACK_C ? 4 : kind == TRACK_POSITION || kind == TRACK_LOOK_AT ? 3 : 1;
}

static void read_times(document *d, const node *map, const film *f, track *k)
{
    const double last = (f->frames > 1 ? f->frames - 1 : 1) / f->rate;
    const int wanted = k->bezier ? 2 : k->count;
    const node *n = document_find(d, map, "times");
    for (int i = 0; i < wanted; i++) k->time[i] = last * i / (wanted - 1);
    if (!n) return;
    document_numbers(d, n, "times", wanted, wanted, 0, FAR, k->time);
    for (int i = 1; i < wanted; i++)
        if (!(k->time[i] > k->time[i - 1])) document_fail(d, n, "times", "must increase");
}

/* {position: [[...], ...], times: [...], curve: bezier} */
static void read_track(document *d, const node *map, const scene *s, const film *f, track *k)
{
    static const char *const curves[] = {"catmull-rom", "bezier", NULL};
    document_map(d, map, "tracks", "position look_at field exposure c slice times curve object");
    const node *values = NULL, *curve = document_find(d, map, "curve"), *of = document_find(d, map, "object");
    *k = (track){.object = -1};
    for (int i = 0; i <= TRACK_SLICE; i++) {
        const node *n = document_find(d, map, TRACK_NAMES[i]);
        if (n && values)
            document_fail(d, n, TRACK_NAMES[i], "given beside %s; a track is of one", TRACK_NAMES[k->kind]);
        if (n) values = n, k->kind = (track_kind)i;
    }
    if (!values)
        document_fail(d, map, "tracks", "wants one of the keys position, look_at, field, exposure, c, slice");
    const char *name = TRACK_NAMES[k->kind];
    const int width = width_of(k->kind);
    k->bezier = curve && document_choice(d, curve, "curve", curves) == 1;
    k->count = document_list(d, values, name, 2, MOST_KEYS);
    for (int i = 0; i < k->count; i++) {
        const node *n = document_item(d, values, i);
        if (width == 1)
            k->value[i][0] = document_number(d, n, name, -FAR, FAR);
        else
            document_numbers(d, n, name, width, width, -FAR, FAR, k->value[i]);
    }
    read_times(d, map, f, k);
    if (of && width != 4 && k->kind != TRACK_SLICE)
        document_fail(d, of, "object", "only of a track of c or slice");
    if (of) k->object = document_whole(d, of, "object", 1, s->objects) - 1;
    bool any = k->kind < TRACK_C;
    for (int i = 0; i < s->objects; i++)
        any = any || ((k->object < 0 || k->object == i) &&
                      (s->object[i].surface.ops == &sgt_julia_ops ||
                       (k->kind == TRACK_SLICE && s->object[i].surface.ops == &sgt_mandelbrot_ops)));
    if (!any)
        document_fail(d, values, name, "no object has it: %s",
                      k->kind == TRACK_C ? "julia" : "julia, mandelbrot");
}

static void read_film(document *d, const node *map, scene *s)
{
    film *f = &s->film;
    document_map(d, map, "film", "frames rate tracks");
    f->rate = 24;
    if (!document_find(d, map, "frames")) document_fail(d, map, "frames", "missing: how many?");
    read_whole(d, map, "frames", 1, 9999, &f->frames);
    read_real(d, map, "rate", 0.01, 1000, &f->rate);
    const node *list = document_find(d, map, "tracks");
    f->tracks = list ? document_list(d, list, "tracks", 1, MOST_TRACKS) : 0;
    for (int i = 0; i < f->tracks; i++) {
        read_track(d, document_item(d, list, i), s, f, &f->track[i]);
        for (int k = 0; k < i; k++)
            if (f->track[k].kind == f->track[i].kind && f->track[k].object == f->track[i].object)
                document_fail(d, document_item(d, list, i), TRACK_NAMES[f->track[i].kind],
                              "two tracks of it");
    }
}

void read_scene(scene *s, const char *file)
{
    static document d; /* is found at exit, whatever happens here */
    document_read(&d, file);
    const node *root = document_root(&d);
    *s = (scene){.width = 640,
                 .height = 400,
                 .samples = 16,
                 .depth = 6,
                 .exposure = 1,
                 .camera.up = {0, 0, 1},
                 .sky = {.zenith = {0.35, 0.5, 0.8}, .horizon = {0.8, 0.85, 0.9}, .ground = {0.4, 0.4, 0.4}},
                 .ambient = {.strength = 0.5, .rays = 1}};
    document_map(&d, root, NULL, "name picture camera sky ambient lights objects film");
    const node *name = document_find(&d, root, "name"), *camera = document_find(&d, root, "camera");
    const node *objects = document_find(&d, root, "objects"), *part;
    if (name) document_word(&d, name, "name");
    if (!camera) document_fail(&d, root, "camera", "missing");
    if (!objects) document_fail(&d, root, "objects", "missing");
    read_camera(&d, camera, s);
    if ((part = document_find(&d, root, "picture"))) read_picture(&d, part, s);
    if ((part = document_find(&d, root, "sky"))) read_sky(&d, part, s);
    if ((part = document_find(&d, root, "ambient"))) read_ambient(&d, part, s);
    if ((part = document_find(&d, root, "lights"))) read_lights(&d, part, s);
    int count = document_list(&d, objects, "objects", 1, MOST_OBJECTS);
    for (int i = 0; i < count; i++) read_body(&d, document_item(&d, objects, i), s);
    if ((part = document_find(&d, root, "film"))) read_film(&d, part, s);
    document_close(&d);
}

void scene_free(scene *s)
{
    for (int i = 0; i < s->objects; i++) sgt_lens_free(s->object[i].read);
    s->objects = s->bodies = s->knots = 0;
}
