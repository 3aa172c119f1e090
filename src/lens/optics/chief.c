// SPDX-License-Identifier: MIT
/* chief.c - first-order data along the real chief ray of a field.
 *
 * The chief ray goes through the centre of the stop, or of the paraxial pupil if the object is telecentric.
 * Whatever clips it, it is traced on: it is a reference, also where it is obscured.  The last element is an
 * image, as in the paraxial data: an ideal lens there bends nothing. */
#include "launch.h"

static bool not_through(const sgt_launcher *from, size_t element, sgt_error *error)
{
    sgt_launch_fail(from, error, "", "the chief ray does not get through surface %zu", element + 1);
    if (error) *error->file = 0; /* it is not the file's fault */
    return false;
}

static bool no_chief(const sgt_launcher *from, sgt_aimed status, sgt_error *error)
{
    sgt_launch_fail(from, error, "", status == SGT_NO_SUCH_RAY
                                         ? "there is no ray through the centre of the stop"
                                         : "no ray through the centre of the stop was found");
    if (error) *error->file = 0;
    return false;
}

/* e: the elements at the wavelength; room for as many follows, twice. */
static bool along_chief(const sgt_launcher *from, sgt_element e[], sgt_passage passages[], double before,
                        size_t field, sgt_parabasal *out, sgt_error *error)
{
    const sgt_lens *lens = from->lens;
    const sgt_pupil_point centre = {0, 0, 1};
    const size_t count = lens->count;
    sgt_element *own = e + count, *open = own + count;
    sgt_field_beam beam;
    sgt_launched chief;
    sgt_fate fate;
    sgt_launch_ending(count, e, own);
    if (!sgt_launch_field(from, lens->field_kind, &lens->field[field - 1], &beam, error) ||
        !sgt_launch_rays(from, &beam, own, before, 1, &centre, &chief, error))
        return false;
    if (chief.status != SGT_MET) return no_chief(from, chief.status, error);
    const size_t passed = sgt_trace_through(count, own, before, &chief.ray, open, passages, &fate);
    if (passed < count) return not_through(from, passed, error);
    return sgt_lens_parabasal(count, open, before, isfinite(lens->object_distance), &chief.ray, passages, out,
                              error);
}

bool sgt_field_parabasal(const sgt_lens *lens, double um, size_t field, sgt_parabasal *out, sgt_error *error)
{
    const sgt_lens_aim aim = lens->telecentric ? SGT_LENS_AIM_PUPIL : SGT_LENS_AIM_STOP;
    sgt_lens_parabasal(0, NULL, 1, false, &(sgt_ray){.d = {0, 0, 1}}, NULL, out, NULL); /* no data as yet */
    if (isnan(um) && lens->wavelength) um = lens->wavelength[lens->primary];
    sgt_launcher *from = sgt_launcher_new(
        lens, &(sgt_launcher_options){.aim = &aim, .wavelength = isnan(um) ? 0 : um}, error);
    if (!from) return false;
    const size_t count = lens->count;
    sgt_element *e = sgt_launch_take(from, 3 * count, sizeof *e);
    sgt_passage *passages = sgt_launch_take(from, count, sizeof *passages);
    double before;
    bool fine = (e && passages) || sgt_launch_memory(from, error);
    if (fine && !(field >= 1 && field <= lens->fields))
        fine = sgt_launch_fail(from, error, "", "there is no field %zu: fields are 1 to %zu", field,
                               lens->fields);
    fine = fine && sgt_lens_at(lens, um, e, &before, error) &&
           along_chief(from, e, passages, before, field, out, error);
    sgt_launch_forget(from, passages);
    sgt_launch_forget(from, e);
    sgt_launcher_free(from);
    return fine;
}
