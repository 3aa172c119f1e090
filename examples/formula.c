// SPDX-License-Identifier: MIT
/* formula.c - a surface from its formula, and the same with another number in it. */
#include <sagitta/formula.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

int main(void)
{
    const char *text = "x^4 + y^4 + z^4 = a";
    const sgt_named parameters[] = {{"a", 1}};

    /* The tape of the formula lies in memory of ours, as long as the surface is used. */
    size_t size = sgt_formula_room(text, 1);
    void *room = malloc(size);
    if (!room) return 1;
    sgt_error error;
    sgt_tape *tape = sgt_formula_read(text, SGT_FORMULA_XYZ, 1, parameters, room, size, &error);
    if (!tape) {
        fprintf(stderr, "column %zu: %s\n", error.column, error.words);
        return 1;
    }

    sgt_formula goursat = {.tape = tape, .ball = 1.6};
    sgt_surface surface = {&sgt_formula_ops, &goursat};
    sgt_ray ray = {.o = {0.2, 0.1, -3}, .d = {0, 0, 1}};
    sgt_options options = {.proof = SGT_PROVE_FIRST};

    sgt_hit hit = sgt_intersect(surface, ray, &options);
    printf("a = 1:  %s at t = %.17g, right within %.2g\n", sgt_status_text(hit.status), hit.t, hit.t_err);

    /* Another value of a: nothing is read anew. */
    sgt_formula_set(tape, (const double[]){0.001}, NULL);
    sgt_hit miss = sgt_intersect(surface, ray, &options);
    printf("a = 0.001: %s\n", sgt_status_text(miss.status));

    /* A text that is wrong.  The tape is overwritten: the surface is not used any more. */
    if (!sgt_formula_read("x^4 + 2y", SGT_FORMULA_XYZ, 0, NULL, room, size, &error))
        printf("column %zu: %s\n", error.column, error.words);
    free(room);

    /* On the ray x^4 + y^4 = 0.0017: z^4 = 1 - 0.0017, and with a = 0.001 there is no such z. */
    double t = 3 - sqrt(sqrt(1 - 0.0017));
    return hit.status == SGT_HIT && fabs(hit.t - t) < 4e-15 && miss.status == SGT_MISS ? 0 : 1;
}
