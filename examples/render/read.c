/* read.c - a scene file, key by key; docs/render.md has the list of them.
 *
 * A reader of a map opens it with the keys it knows and then asks for each; a key that is absent
 * leaves the default, which was set before. */
#include "read.h"

#include "document.h"
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
    bool several = n->type == YAML_SEQUENCE_NODE && document_list(d, n, key, 1, MOST_POINTS) > 0
                && document_item(d, n, 0)->type == YAML_SEQUENCE_NODE;
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
    static const char *const axes[] = {"x", "y", "z", "radius", NULL};
    *p = (pattern){.kind = PATTERN_PLAIN, .count = 1, .to = 1};
    if (n->type != YAML_MAPPING_NODE) {
        p->colour[0] = vector_of(d, n, "colour", 0, 1);
        return;
    }
    document_map(d, n, "colour", document_find(d, n, "checks") ? "checks colours" : "blend from to colours");
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

static void read_object(document *d, const node *map, object *o)
{
    static const char *const normals[] = {"gradient", "difference", "potential", NULL};
    vec3 position = {0}, rotation = {0};
    *o = (object){
        .scale = 1,
        .material = {.pattern = {.count = 1, .colour = {{0.7, 0.7, 0.7}}}, .diffuse = 1, .shininess = 40}};
    shape_read(d, map, "position rotation scale t_tol dt_min max_evals normal material", o);
    read_vector(d, map, "position", -FAR, FAR, &position);
    read_vector(d, map, "rotation", -FAR, FAR, &rotation);
    read_real(d, map, "scale", 1e-6, FAR, &o->scale);
    o->pose = sgt_pose_tilted(position, rotation);
    read_real(d, map, "t_tol", 0, FAR, &o->options.t_tol);
    read_real(d, map, "dt_min", 0, FAR, &o->options.dt_min);
    read_whole(d, map, "max_evals", 0, 1 << 30, &o->options.max_evals);
    const node *normal = document_find(d, map, "normal"), *of = document_find(d, map, "material");
    if (normal) {
        o->normal = (normal_kind)document_choice(d, normal, "normal", normals);
        if (o->normal == NORMAL_POTENTIAL && o->surface.ops != &sgt_julia_ops &&
            o->surface.ops != &sgt_mandelbrot_ops)
            document_fail(d, normal, "normal", "only julia and mandelbrot have a potential");
    }
    if (of) read_material(d, of, &o->material);
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
    document_map(&d, root, NULL, "name picture camera sky ambient lights objects");
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
    s->objects = document_list(&d, objects, "objects", 1, MOST_OBJECTS);
    for (int i = 0; i < s->objects; i++) read_object(&d, document_item(&d, objects, i), &s->object[i]);
    document_close(&d);
}

void scene_free(scene *s)
{
    for (int i = 0; i < s->objects; i++) sgt_lens_free(s->object[i].read);
    s->objects = 0;
}
