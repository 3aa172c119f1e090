// SPDX-License-Identifier: MIT
/* info_json.c - sagitta info as json: an object with all that is known of a lens.
 *
 * Its names are a contract (docs/rays.md).  A quantity that is not there is null; its key stays. */
#include "info.h"

#include "../base/memory.h"
#include "../show/json.h"

static const char *none_if_empty(const char *text) { return *text ? text : NULL; }

static void put_pupil(json *j, const char *key, double z, double radius)
{
    json_open(j, key, '{', false);
    json_number(j, "z", z);
    json_number(j, "radius", radius);
    json_close(j);
}

static void put_numbers(json *j, const char *key, size_t count, const double x[])
{
    json_open(j, key, '[', false);
    for (size_t i = 0; i < count; i++) json_number(j, NULL, x[i]);
    json_close(j);
}

static void put_fields(json *j, const sgt_lens *l)
{
    static const char *const kinds[] = {[SGT_FIELD_ANGLE] = "angle",
                                        [SGT_FIELD_OBJECT_HEIGHT] = "object_height",
                                        [SGT_FIELD_PARAXIAL_IMAGE_HEIGHT] = "paraxial_image_height",
                                        [SGT_FIELD_REAL_IMAGE_HEIGHT] = "real_image_height"};
    json_open(j, "fields", '[', true);
    for (size_t i = 0; i < l->fields; i++) {
        json_open(j, NULL, '{', false);
        json_number(j, "x", l->field[i].x);
        json_number(j, "y", l->field[i].y);
        json_word(j, "kind", kinds[l->field_kind]);
        json_number(j, "weight", l->field[i].weight);
        json_close(j);
    }
    json_close(j);
}

static void put_parabasal(json *j, const lens *l)
{
    const info_chief *chief = info_chiefs(l);
    size_t known = 0, fields = l->of->fields;
    for (size_t i = 0; i < fields; i++) known += !chief[i].why_not;
    if (!known) {
        json_word(j, "parabasal", NULL);
        json_word(j, "parabasal_why_not", chief[0].why_not);
        return;
    }
    json_open(j, "parabasal", '{', true);
    json_open(j, "fields", '[', true);
    for (size_t i = 0; i < fields; i++) {
        const sgt_parabasal *p = &chief[i].of;
        json_open(j, NULL, '{', false);
        json_count(j, "field", i + 1);
        json_number(j, "efl_x", p->efl[0]), json_number(j, "efl_y", p->efl[1]);
        json_number(j, "focus_x", p->focus[0]), json_number(j, "focus_y", p->focus[1]);
        json_number(j, "image_x", p->image[0]), json_number(j, "image_y", p->image[1]);
        json_number(j, "magnification_x", p->magnification[0]);
        json_number(j, "magnification_y", p->magnification[1]);
        json_number(j, "power_xy", p->power_xy);
        json_word(j, "why_not", chief[i].why_not);
        json_close(j);
    }
    json_close(j);
    json_close(j);
    json_word(j, "parabasal_why_not", NULL);
}

static void put_sums(json *j, const sgt_seidel *s)
{
    json_number(j, "spherical", s->spherical), json_number(j, "coma", s->coma);
    json_number(j, "astigmatism", s->astigmatism), json_number(j, "petzval", s->petzval);
    json_number(j, "distortion", s->distortion);
    json_number(j, "axial", s->chromatic[0]), json_number(j, "lateral", s->chromatic[1]);
    json_close(j);
}

static void put_seidel(json *j, const lens *l, const sgt_seidel seidel[], const char *why_not)
{
    if (why_not) {
        json_word(j, "seidel", NULL);
        json_word(j, "seidel_sum", NULL);
    } else {
        json_open(j, "seidel", '[', true);
        for (size_t i = 0; i < l->count; i++) {
            json_open(j, NULL, '{', false);
            json_count(j, "surface", i + 1);
            json_word(j, "type", l->surface[i].type);
            put_sums(j, &seidel[i]);
        }
        json_close(j);
        const sgt_seidel sum = info_seidel_sum(l, seidel);
        json_open(j, "seidel_sum", '{', false);
        put_sums(j, &sum);
    }
    json_word(j, "seidel_why_not", why_not);
}

static void put_lens(json *j, const lens *l)
{
    const sgt_lens *of = l->of;
    sgt_seidel *seidel = memory_take(l->count, sizeof *seidel);
    const sgt_first_order o = info_first_order(l, seidel);
    json_open(j, NULL, '{', true);
    json_word(j, "name", none_if_empty(of->name));
    json_word(j, "units", none_if_empty(of->units));
    json_number(j, "wavelength", o.wavelength);
    json_number(j, "efl", o.efl);
    json_number(j, "bfd", o.bfd);
    json_number(j, "ffd", o.ffd);
    json_number(j, "f_number", o.f_number);
    json_number(j, "f_number_working", o.f_number_working);
    json_number(j, "magnification", o.magnification);
    put_pupil(j, "entrance_pupil", o.entrance_pupil, o.entrance_radius);
    put_pupil(j, "exit_pupil", o.exit_pupil, o.exit_radius);
    put_numbers(j, "image_height", of->fields, info_image_heights(l, &o));
    json_number(j, "petzval_radius", o.petzval_radius);
    json_number(j, "lagrange", o.lagrange);
    put_fields(j, of);
    put_numbers(j, "wavelengths", of->wavelength ? of->wavelengths : 0, of->wavelength);
    json_count(j, "surfaces", l->count);
    put_parabasal(j, l);
    json_count(j, "stop", of->stop + 1);
    json_number(j, "stop_radius", o.stop_radius);
    json_number(j, "efl_image", o.efl_image);
    json_number(j, "focus", o.focus);
    json_number(j, "image", o.image);
    json_number(j, "front_principal", o.front_principal);
    json_number(j, "rear_principal", o.rear_principal);
    json_number(j, "front_nodal", o.front_nodal);
    json_number(j, "rear_nodal", o.rear_nodal);
    put_seidel(j, l, seidel, o.without_seidel);
    json_number(j, "angular_magnification", o.angular_magnification);
    json_truth(j, "afocal", of->afocal);
    if (l->configuration) json_count(j, "configuration", l->configuration);
    if (l->configuration) json_word(j, "configuration_name", none_if_empty(l->configuration_name));
    const size_t configurations = sgt_lens_configurations(of);
    if (configurations) json_open(j, "configurations", '[', false);
    for (size_t i = 1; i <= configurations; i++)
        json_word(j, NULL, none_if_empty(sgt_lens_configuration_name(of, i)));
    if (configurations) json_close(j);
    json_close(j);
}

void info_json(const table_target *target, const lens_list *at, bool as_list)
{
    json *j = json_begin(target);
    if (as_list) json_open(j, NULL, '[', true);
    for (size_t i = 0; i < at->count; i++) put_lens(j, &at->lens[i]);
    if (as_list) json_close(j);
    json_end(j);
}
