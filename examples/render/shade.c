// SPDX-License-Identifier: MIT
/* shade.c - light, after B. T. Phong (1975) and T. Whitted (1980).
 *
 * What is opaque shows its colour in the light of the lamps, each seen through a shadow ray, and of the
 * sky, seen through rays that are spread as the cosine, which is ambient occlusion; a lamp of some
 * radius has soft shadows, one ray a sample to a random point of its disc.  To that come the lamp's
 * highlight, a power of the cosine between its mirror image and the eye, and a mirror's part.  Glass
 * divides light as Fresnel's formula has it between the reflected ray and the refracted one.  A lamp
 * shines through glass in a straight line, less what is reflected and absorbed: there are no caustics.
 *
 * WAVES.  Rays are not followed one by one to their ends: a wave is all rays, of all looks, that have
 * turned equally often.  The whole wave is put to the scene at once; then, for each lamp and each ray of
 * the sky, all shadow rays of the wave; and what is reflected and refracted is the next wave.  Light goes
 * the other way, but its parts multiply in any order: a ray carries the part of the picture that it is, and
 * adds the light it finds to its look.  The sum is in the order of waves, the same whatever other looks
 * there are.
 *
 * A ray has a number in the tree of its look: 1 from the camera, 2 v reflected and 2 v + 1 refracted from v.
 * With the lamp's it names the sequence of random points, so that no two uses share one. */
#include "shade.h"

#include "fail.h"
#include "levels.h"

#include <stdlib.h>

enum { OF_LENS = 0, OF_SKY = 1, OF_LAMPS = 2, SEQUENCES = OF_LAMPS + MOST_LIGHTS };
/* a ray whose part of the picture is less is left out */
static const double FAINT = 0.002, TURN = 6.283185307179586;

typedef struct ray {
    look *of;         /* whom it brings light */
    uint32_t number;  /* in the tree */
    double weight;    /* its part of the picture, */
    vec3 part;        /* and what absorption and haze have left of that */
} ray;

typedef struct wave { size_t n; beam *beam; ray *ray; } wave; /* beam[i] is the way of ray[i] */

/* Where a ray has met something: the light that falls there, and the source that is looked for at present. */
typedef struct place { vec3 diffuse, highlight, toward, part; } place;

/* What a wave is worked out on, kept from one to the next. */
struct desk {
    size_t most;        /* rays that there is room for */
    wave now, next;
    meeting *met;       /* where the rays of `now` end, */
    place *at;          /* and the light there */
    beam *shadow;       /* the rays, of some of them, to one source; */
    meeting *shadowed;
    vec3 **lit;         /* *lit[i] is what comes along shadow[i] */
};

desk *desk_new(void)
{
    desk *d = room(NULL, 1, sizeof *d);
    *d = (desk){0};
    return d;
}

#define WIDEN(array) ((array) = room((array), most, sizeof *(array)))

static void desk_widen(desk *d, size_t most)
{
    if (most <= d->most) return;
    WIDEN(d->now.beam), WIDEN(d->now.ray), WIDEN(d->next.beam), WIDEN(d->next.ray);
    WIDEN(d->met), WIDEN(d->at), WIDEN(d->shadow), WIDEN(d->shadowed), WIDEN(d->lit);
    d->most = most;
}

void desk_free(desk *d)
{
    free(d->now.beam), free(d->now.ray), free(d->next.beam), free(d->next.ray);
    free(d->met), free(d->at), free(d->shadow), free(d->shadowed), free(d->lit);
    free(d);
}

static void wave_add(wave *w, beam b, ray r) { w->beam[w->n] = b, w->ray[w->n++] = r; }

static void shine(const ray *r, vec3 colour) { r->of->light = add(r->of->light, filtered(r->part, colour)); }

static vec3 sky(const scene *s, vec3 d)
{
    return d.z >= 0 ? mixed(s->sky.horizon, s->sky.zenith, sqrt(d.z))
                    : mixed(s->sky.horizon, s->sky.ground, fmin(1, -6 * d.z));
}

static vec3 darkened(vec3 a, double t) { return (vec3){exp(-t * a.x), exp(-t * a.y), exp(-t * a.z)}; }

static vec3 mirrored(vec3 d, vec3 n) { return along(d, -2 * dot(d, n), n); }

static vec3 colour_at(const object *o, vec3 at)
{
    const pattern *p = &o->material.pattern;
    if (p->kind == PATTERN_CHECKS)
        return p->colour[fmod(floor(at.x / p->size) + floor(at.y / p->size), 2) != 0];
    if (p->kind == PATTERN_PLAIN) return p->colour[0];
    const double by[] = {at.x, at.y, at.z, length(at), p->by == BY_TRAP ? levels_trap(o, at, p->trap) : 0};
    double x = fmax(0, fmin(1, (by[p->by] - p->from) / (p->to - p->from))) * (p->count - 1);
    int i = (int)fmin(floor(x), p->count - 2);
    return mixed(p->colour[i], p->colour[i + 1], x - i);
}

/* The part of light that is reflected where the index goes from n1 to n2; cosine is that of incidence.  The
 * other cosine in *inside; 1 and 0 in total reflection. */
static double fresnel(double n1, double n2, double cosine, double *inside)
{
    double sine2 = n1 / n2 * (n1 / n2) * (1 - cosine * cosine);
    *inside = 0;
    if (sine2 >= 1) return 1;
    *inside = sqrt(1 - sine2);
    double across = (n1 * cosine - n2 * *inside) / (n1 * cosine + n2 * *inside);
    double in_plane = (n2 * cosine - n1 * *inside) / (n2 * cosine + n1 * *inside);
    return 0.5 * (across * across + in_plane * in_plane);
}

static double index_of(const object *medium) { return medium ? medium->material.index : 1; }

/* Glass is entered from the air and left into it. */
static const object *behind(const object *medium, const object *glass) { return medium ? NULL : glass; }

/* What of the light from its far end comes along each shadow ray: *lit[i] is multiplied by it.  They are
 * used up. */
static void reaches(const scene *s, size_t n, desk *d, tally *sum)
{
    for (int i = 0; i <= s->depth && n > 0; i++) {
        size_t left = 0;
        meet(s, n, d->shadow, d->shadowed, sum);
        for (size_t k = 0; k < n; k++) {
            const beam *b = &d->shadow[k];
            const meeting *m = &d->shadowed[k];
            vec3 *lit = d->lit[k];
            if (!m->object) continue;
            double inside, index = m->object->material.index;
            /* as if from the air */
            *lit = scaled(*lit, index > 0 ? 1 - fresnel(1, index, -dot(b->d, m->n), &inside) : 0);
            if (index == 0) continue;
            if (b->medium) *lit = filtered(*lit, darkened(b->medium->material.absorption, m->t));
            d->shadow[left] = leaving(m, b->d, b->far - m->t, -m->side, behind(b->medium, m->object));
            d->lit[left++] = lit;
        }
        n = left;
    }
    for (size_t k = 0; k < n; k++) *d->lit[k] = (vec3){0, 0, 0};
}

static uint32_t sequence(uint32_t number, uint32_t use) { return number * SEQUENCES + use; }

/* A random point of the unit disc at right angles to n, which is of unit length. */
static vec3 on_disc(pixel p, uint32_t which, uint32_t index, vec3 n)
{
    double u, v;
    vec3 a, b;
    sample_square(p, which, index, &u, &v);
    across(n, &a, &b);
    return along(scaled(a, sqrt(u) * cos(TURN * v)), sqrt(u) * sin(TURN * v), b);
}

/* Light is looked for at each lamp, 0 ... s->lights - 1, and then along each ray of the sky.  The beam from a
 * meeting to the source; false: the source does not shine there. */
static bool aim(const scene *s, int source, const ray *r, const beam *b, const meeting *m, beam *out)
{
    const look *of = r->of;
    if (source < s->lights) {
        const light *l = &s->light[source];
        vec3 to = subtract(l->position, m->p);
        if (l->radius > 0)
            to = along(
                to, l->radius,
                on_disc(of->pixel, sequence(r->number, OF_LAMPS + (uint32_t)source), of->index, unit(to)));
        double far = length(to);
        *out = leaving(m, scaled(to, 1 / far), far, m->side, b->medium);
        return dot(to, m->n) > 0;
    }
    uint32_t index = of->index * (uint32_t)s->ambient.rays + (uint32_t)(source - s->lights);
    double reach = s->ambient.reach > 0 ? s->ambient.reach : HUGE_VAL;
    vec3 aside = on_disc(of->pixel, sequence(r->number, OF_SKY), index, m->n);
    *out = leaving(m, along(aside, sqrt(1 - dot(aside, aside)), m->n), reach, m->side, b->medium);
    return m->object->material.index == 0;
}

static void receive(const scene *s, int source, const beam *b, const meeting *m, place *p)
{
    const material *of = &m->object->material;
    if (source < s->lights) {
        vec3 lit = filtered(s->light[source].colour, p->part);
        double shine = of->specular > 0 ? dot(mirrored(p->toward, m->n), b->d) : 0;
        p->diffuse = along(p->diffuse, dot(p->toward, m->n), lit);
        if (shine > 0) p->highlight = along(p->highlight, of->specular * pow(shine, of->shininess), lit);
    } else {
        p->diffuse = along(p->diffuse, s->ambient.strength / s->ambient.rays,
                           filtered(p->part, sky(s, p->toward)));
    }
}

static void light_up(const scene *s, desk *d, tally *sum)
{
    size_t all = d->now.n;
    for (size_t i = 0; i < all; i++) {
        d->at[i] = (place){0};
        if (s->ambient.rays == 0 && d->met[i].object)
            d->at[i].diffuse = scaled(sky(s, d->met[i].n), s->ambient.strength);
    }
    for (int source = 0; source < s->lights + s->ambient.rays; source++) {
        size_t n = 0;
        for (size_t i = 0; i < all; i++) {
            d->at[i].part = (vec3){0, 0, 0};
            if (!d->met[i].object ||
                !aim(s, source, &d->now.ray[i], &d->now.beam[i], &d->met[i], &d->shadow[n]))
                continue;
            d->at[i].part = (vec3){1, 1, 1};
            d->at[i].toward = d->shadow[n].d;
            d->lit[n++] = &d->at[i].part;
        }
        reaches(s, n, d, sum);
        for (size_t i = 0; i < all; i++)
            if (largest(d->at[i].part) > 0) receive(s, source, &d->now.beam[i], &d->met[i], &d->at[i]);
    }
}

/* The ray r turns: `part` of it is light along b.  depth: how many times it may. */
static void turn(const scene *s, const ray *r, beam b, uint32_t number, double part, int depth, wave *next)
{
    if (!(part * r->weight > FAINT)) return;
    ray turned = {r->of, number, part * r->weight, scaled(r->part, part)};
    if (depth > 0) wave_add(next, b, turned);
    else shine(&turned, sky(s, b.d));
}

/* What a ray sees where it ends, and where it goes from there. */
static void end(const scene *s, ray r, const beam *b, const meeting *m, const place *at, int depth,
                wave *next)
{
    if (!m->object) {
        shine(&r, sky(s, b->d));
        return;
    }
    const material *of = &m->object->material;
    if (b->medium) {
        r.part = filtered(r.part, darkened(b->medium->material.absorption, m->t));
    } else if (s->sky.haze > 0) {
        double clear = exp(-m->t / s->sky.haze);
        shine(&r, scaled(s->sky.horizon, 1 - clear));
        r.part = scaled(r.part, clear);
    }
    double cosine = -dot(b->d, m->n), reflected = of->reflection;
    if (of->index > 0) {
        const object *medium = behind(b->medium, m->object);
        double inside, ratio = index_of(b->medium) / index_of(medium);
        reflected = fresnel(index_of(b->medium), index_of(medium), cosine, &inside);
        vec3 refracted = along(scaled(b->d, ratio), ratio * cosine - inside, m->n);
        turn(s, &r, leaving(m, unit(refracted), HUGE_VAL, -m->side, medium), 2 * r.number + 1, 1 - reflected,
             depth, next);
    } else {
        shine(&r,
              scaled(filtered(at->diffuse, colour_at(m->object, m->at.p)), of->diffuse * (1 - reflected)));
    }
    turn(s, &r, leaving(m, unit(mirrored(b->d, m->n)), HUGE_VAL, m->side, b->medium), 2 * r.number, reflected,
         depth, next);
    shine(&r, at->highlight);
}

/* A ray of the camera: its place in the pixel is spread as a tent of two pixels, which is a picture's
 * reconstruction by straight lines. */
static beam first(const view *v, const look *of)
{
    double x, y;
    sample_square(of->pixel, OF_LENS, of->index, &x, &y);
    x = x < 0.5 ? sqrt(2 * x) - 1 : 1 - sqrt(2 - 2 * x);
    y = y < 0.5 ? sqrt(2 * y) - 1 : 1 - sqrt(2 - 2 * y);
    return (beam){
        .o = v->eye, .d = camera_direction(v, of->pixel.x + 0.5 + x, of->pixel.y + 0.5 + y), .far = HUGE_VAL};
}

void shade(const scene *s, const view *v, size_t n, look looks[], desk *d, tally *sum)
{
    desk_widen(d, n);
    d->now.n = 0;
    for (size_t i = 0; i < n; i++) {
        looks[i].light = (vec3){0, 0, 0};
        wave_add(&d->now, first(v, &looks[i]), (ray){&looks[i], 1, 1, {1, 1, 1}});
    }
    for (int depth = s->depth; d->now.n > 0; depth--) {
        desk_widen(d, 2 * d->now.n);
        meet(s, d->now.n, d->now.beam, d->met, sum);
        light_up(s, d, sum);
        d->next.n = 0;
        for (size_t i = 0; i < d->now.n; i++)
            end(s, d->now.ray[i], &d->now.beam[i], &d->met[i], &d->at[i], depth, &d->next);
        wave done = d->now;
        d->now = d->next, d->next = done;
    }
}
