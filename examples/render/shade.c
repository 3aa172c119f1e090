/* shade.c - light, after B. T. Phong (1975) and T. Whitted (1980).
 *
 * What is opaque shows its colour in the light of the lamps, each seen through a shadow ray, and of the
 * sky, seen through rays that are spread as the cosine, which is ambient occlusion; a lamp of some
 * radius has soft shadows, one ray a sample to a random point of its disc.  To that come the lamp's
 * highlight, a power of the cosine between its mirror image and the eye, and a mirror's part.  Glass divides light as Fresnel's formula
 * has it between the reflected ray and the refracted one.  A lamp shines through glass in a straight line,
 * less what is reflected and absorbed: there are no caustics.
 *
 * A ray has a number in the tree of its pixel: 1 from the camera, 2 v reflected and 2 v + 1 refracted from v.
 * With the lamp's it names the sequence of random points, so that no two uses share one. */
#include "shade.h"

typedef struct walk { const scene *scene; pixel pixel; uint32_t index; tally *sum; } walk;

enum { OF_LENS = 0, OF_SKY = 1, OF_LAMPS = 2, SEQUENCES = OF_LAMPS + MOST_LIGHTS };
static const double FAINT = 0.002; /* a ray whose part of the picture is less is left out */

static vec3 sky(const scene *s, vec3 d)
{
    return d.z >= 0 ? mixed(s->sky.horizon, s->sky.zenith, sqrt(d.z)) : mixed(s->sky.horizon, s->sky.ground, fmin(1, -6 * d.z));
}

static vec3 darkened(vec3 a, double t) { return (vec3){exp(-t * a.x), exp(-t * a.y), exp(-t * a.z)}; }

static vec3 mirrored(vec3 d, vec3 n) { return along(d, -2 * dot(d, n), n); }

static vec3 colour_at(const pattern *p, vec3 at)
{
    if (p->kind == PATTERN_CHECKS) return p->colour[fmod(floor(at.x / p->size) + floor(at.y / p->size), 2) != 0];
    if (p->kind == PATTERN_PLAIN) return p->colour[0];
    const double by[] = {at.x, at.y, at.z, length(at)};
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

/* What part of the light from `far` away comes along the beam. */
static vec3 reaches(const walk *w, beam b, double far)
{
    vec3 part = {1, 1, 1};
    meeting m;
    for (int i = 0; i <= w->scene->depth; i++) {
        bool met = meet(w->scene, &b, far, &m, w->sum, NULL, NULL);
        if (met && m.object->material.index == 0) return (vec3){0, 0, 0};
        if (!met) return part;
        if (b.medium) part = filtered(part, darkened(b.medium->material.absorption, m.t));
        double inside;
        const object *next = behind(b.medium, m.object);
        part = scaled(part, 1 - fresnel(1, m.object->material.index, -dot(b.d, m.n), &inside)); /* as from the air, both ways */
        far -= m.t;
        b = leaving(&m, b.d, -m.side, next);
    }
    return (vec3){0, 0, 0};
}

static uint32_t sequence(uint32_t ray, uint32_t use) { return ray * SEQUENCES + use; }

/* The light of the sky on a surface. */
static vec3 skylight(const walk *w, const meeting *m, const object *medium, uint32_t ray)
{
    const scene *s = w->scene;
    vec3 sum = {0}, a, b;
    if (s->ambient.rays == 0) return scaled(sky(s, m->n), s->ambient.strength);
    across(m->n, &a, &b);
    for (int i = 0; i < s->ambient.rays; i++) {
        double u, v;
        sample_square(w->pixel, sequence(ray, OF_SKY), w->index * (uint32_t)s->ambient.rays + (uint32_t)i, &u, &v);
        double r = sqrt(u), angle = 6.283185307179586 * v;
        vec3 d = along(along(scaled(m->n, sqrt(1 - u)), r * cos(angle), a), r * sin(angle), b);
        vec3 part = reaches(w, leaving(m, d, m->side, medium), s->ambient.reach > 0 ? s->ambient.reach : HUGE_VAL);
        sum = add(sum, filtered(part, sky(s, d)));
    }
    return scaled(sum, s->ambient.strength / s->ambient.rays);
}

/* What of the lamps' light goes along `out`: diffuse in *diffuse, the highlight in *highlight. */
static void lamplight(const walk *w, const meeting *m, vec3 out, const object *medium, uint32_t ray, vec3 *diffuse, vec3 *highlight)
{
    const material *of = &m->object->material;
    *diffuse = *highlight = (vec3){0, 0, 0};
    for (int i = 0; i < w->scene->lights; i++) {
        const light *l = &w->scene->light[i];
        vec3 to = subtract(l->position, m->p), a, b;
        if (l->radius > 0) {
            double u, v;
            sample_square(w->pixel, sequence(ray, OF_LAMPS + (uint32_t)i), w->index, &u, &v);
            across(unit(to), &a, &b);
            double r = l->radius * sqrt(u), angle = 6.283185307179586 * v;
            to = along(along(to, r * cos(angle), a), r * sin(angle), b);
        }
        double far = length(to), cosine = dot(to, m->n) / far;
        if (!(cosine > 0)) continue;
        vec3 d = scaled(to, 1 / far), lit = filtered(l->colour, reaches(w, leaving(m, d, m->side, medium), far));
        *diffuse = along(*diffuse, cosine, lit);
        double shine = of->specular > 0 ? -dot(mirrored(d, m->n), out) : 0;
        if (shine > 0) *highlight = along(*highlight, of->specular * pow(shine, of->shininess), lit);
    }
}

/* depth: how many more times light may turn; weight: its part of the picture so far. */
static vec3 seen(const walk *w, const beam *b, int depth, uint32_t ray, double weight);

/* Along d from the meeting, times `part`. */
static vec3 seen_further(const walk *w, const meeting *m, vec3 d, double side, const object *medium, int depth, uint32_t ray,
                         double part, double weight)
{
    if (!(part * weight > FAINT)) return (vec3){0, 0, 0};
    if (depth == 0) return scaled(sky(w->scene, d), part);
    beam b = leaving(m, unit(d), side, medium);
    return scaled(seen(w, &b, depth - 1, ray, part * weight), part);
}

static vec3 seen(const walk *w, const beam *b, int depth, uint32_t ray, double weight)
{
    const scene *s = w->scene;
    meeting m;
    if (!meet(s, b, HUGE_VAL, &m, w->sum, NULL, NULL)) return sky(s, b->d);
    const material *of = &m.object->material;
    double cosine = -dot(b->d, m.n), reflected = of->reflection;
    vec3 colour = {0}, diffuse, highlight;
    lamplight(w, &m, scaled(b->d, -1), b->medium, ray, &diffuse, &highlight);
    if (of->index > 0) {
        const object *next = behind(b->medium, m.object);
        double inside, ratio = index_of(b->medium) / index_of(next);
        reflected = fresnel(index_of(b->medium), index_of(next), cosine, &inside);
        vec3 refracted = along(scaled(b->d, ratio), ratio * cosine - inside, m.n);
        colour = seen_further(w, &m, refracted, -m.side, next, depth, 2 * ray + 1, 1 - reflected, weight);
    } else {
        diffuse = add(diffuse, skylight(w, &m, b->medium, ray));
        colour = scaled(filtered(diffuse, colour_at(&of->pattern, m.at)), of->diffuse * (1 - reflected));
    }
    colour = add(colour, seen_further(w, &m, mirrored(b->d, m.n), m.side, b->medium, depth, 2 * ray, reflected, weight));
    colour = add(colour, highlight);
    if (b->medium) return filtered(colour, darkened(b->medium->material.absorption, m.t));
    return s->sky.haze > 0 ? mixed(s->sky.horizon, colour, exp(-m.t / s->sky.haze)) : colour;
}

vec3 shade(const scene *s, const view *v, pixel p, uint32_t index, tally *sum)
{
    /* A sample's place: spread as a tent of two pixels, which is a picture's reconstruction by straight lines. */
    double x, y;
    sample_square(p, OF_LENS, index, &x, &y);
    x = x < 0.5 ? sqrt(2 * x) - 1 : 1 - sqrt(2 - 2 * x);
    y = y < 0.5 ? sqrt(2 * y) - 1 : 1 - sqrt(2 - 2 * y);
    walk w = {s, p, index, sum};
    beam b = {.o = v->eye, .d = camera_direction(v, p.x + 0.5 + x, p.y + 0.5 + y)};
    return seen(&w, &b, s->depth, 1, 1);
}
