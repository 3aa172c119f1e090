// SPDX-License-Identifier: MIT
/* palette.c - seven colours that can be told apart on white, also by the colour-blind.
 *
 * The hues are those of Okabe & Ito (2008, jfly.uni-koeln.de/color) without yellow, which is too light for a
 * thin line.  Theirs are alike in lightness, so blue, red and green are darkened here, and dark and light
 * ones take turns.  Neighbours then differ by 17 or more in CIELAB's L*, so also in grey, and by 32 or more
 * in its distance.  That holds for normal sight and for protanopia, deuteranopia and tritanopia as simulated
 * by Machado, Oliveira & Fernandes (2009, IEEE Trans. Vis. Comput. Graph. 15, 1291).  Of the first five
 * colours any two differ by 38 or more. */
#include "palette.h"

static const double palette[PALETTE_COLOURS][3] = {
    {0.000, 0.314, 0.647}, /* blue */
    {0.922, 0.608, 0.000}, /* orange */
    {0.686, 0.157, 0.039}, /* red */
    {0.337, 0.725, 0.922}, /* sky */
    {0.078, 0.078, 0.078}, /* black */
    {0.000, 0.471, 0.314}, /* green */
    {0.863, 0.431, 0.706}, /* pink */
};

const double *palette_colour(size_t i) { return palette[i % PALETTE_COLOURS]; }

void palette_set(cairo_t *cr, size_t i)
{
    const double *c = palette_colour(i);
    cairo_set_source_rgb(cr, c[0], c[1], c[2]);
}

void palette_dash(cairo_t *cr, size_t i)
{
    static const struct {
        int count;
        double length[4];
    } dash[PALETTE_DASHES] = {
        {0, {0}}, {2, {5, 3}}, {2, {1, 2.6}}, {4, {6, 2.6, 1, 2.6}}, {2, {11, 3.5}},
    };
    i %= PALETTE_DASHES;
    cairo_set_dash(cr, dash[i].length, dash[i].count, 0);
}
