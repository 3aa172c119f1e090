// SPDX-License-Identifier: MIT
/* fuzz_array.c - bytes as an array of rays, NAME.npy.
 *
 * The first byte says whether bad rows are skipped.  What is not refused must be as long as its header says:
 * so many rays are told, good or bad, and each good one is as rays.h promises. */
#include "tool.h"

#include "../../src/tool/read/rays.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static bool sound(const launch *l)
{
    const sgt_ray *r = &l->ray;
    return isfinite(r->o.x) && isfinite(r->o.y) && isfinite(r->o.z) && isfinite(r->d.x) && isfinite(r->d.y) &&
           isfinite(r->d.z) && (r->d.x != 0 || r->d.y != 0 || r->d.z != 0) && r->tmin <= r->tmax;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static ray_list list;
    if (size < 1) return 0;
    const bool skip_bad = data[0] & 1;
    list = (ray_list){.count = 0};
    read_anew(data + 1, size - 1);
    if (setjmp(refused) == 0) {
        rays_read(&list, "some.npy", skip_bad);
        REQUIRE(list.count * 6 * sizeof(double) <= size, "%zu rays in %zu bytes", list.count, size);
        for (size_t i = 0; i < list.count; i++) REQUIRE(sound(&list.ray[i]), "ray %zu", list.ray[i].number);
        REQUIRE(skip_bad || !*noted, "\"%s\"", noted);
    } else {
        REQUIRE(status == EXIT_BAD_INPUT && strncmp(message, "some.npy:", 9) == 0, "status %d: \"%s\"",
                (int)status, message);
    }
    return 0;
}
