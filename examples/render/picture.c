// SPDX-License-Identifier: MIT
/* picture.c - from linear light to eight bits, and to a file: cairo makes the PNG, in memory.
 *
 * Light up to 0.6 of white stays as it is; what is more comes ever nearer to white, by tanh, so that
 * a highlight has no edge where it becomes too bright.  Then the curve of sRGB (IEC 61966-2-1).
 *
 * A frame of a film has a chunk tEXt behind its head with the digest of all that it depends on (PNG
 * specification, W3C 2003, section 11.3.4.3).  By it --resume knows a frame that is whole and of this
 * film. */
#include "picture.h"

#include "fail.h"
#include "output.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

picture picture_new(int width, int height)
{
    picture p = {width, height, calloc((size_t)width * (size_t)height, sizeof *p.pixel)};
    if (!p.pixel) fail_input("out of memory for %d x %d pixels", width, height);
    return p;
}

static unsigned byte_of(double x)
{
    x = fmax(0, fmin(1, x)); /* NaN: 0 */
    return (unsigned)(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055) + 0.5);
}

unsigned picture_code(vec3 c) { return byte_of(c.x) << 16 | byte_of(c.y) << 8 | byte_of(c.z); }

cairo_surface_t *picture_surface(int width, int height)
{
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
    cairo_status_t status = cairo_surface_status(surface);
    if (status != CAIRO_STATUS_SUCCESS)
        fail_input("a picture of %d x %d: %s", width, height, cairo_status_to_string(status));
    return surface;
}

void picture_put(cairo_surface_t *surface, int x, int y, unsigned code)
{
    unsigned char *row = cairo_image_surface_get_data(surface) +
                         (ptrdiff_t)y * cairo_image_surface_get_stride(surface);
    ((uint32_t *)(void *)row)[x] = code;
}

/* The sum of PNG's chunks: x^32 + x^26 + ... + 1, bits from the lowest on. */
static uint32_t sum_of(const unsigned char *at, size_t n)
{
    uint32_t sum = 0xffffffff;
    for (size_t i = 0; i < n; i++) {
        sum ^= at[i];
        for (int bit = 0; bit < 8; bit++) sum = sum >> 1 ^ (sum & 1 ? 0xedb88320 : 0);
    }
    return ~sum;
}

static uint32_t word_at(const unsigned char *at)
{
    return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

static void put_word(unsigned char *at, uint32_t x)
{
    for (int i = 0; i < 4; i++) at[i] = (unsigned char)(x >> (24 - 8 * i));
}

enum { SIGNATURE = 8, HEAD = SIGNATURE + 12 + 13, TEXT = 7 + 16, CHUNK = 12 + TEXT }; /* 12 are around each */

/* tEXt, "render" and the digest in 16 digits. */
static void digest_chunk(uint64_t digest, unsigned char chunk[CHUNK])
{
    char text[TEXT + 1];
    snprintf(text, sizeof text, "render.%016llx", (unsigned long long)digest);
    text[6] = 0; /* parts the two */
    put_word(chunk, TEXT);
    memcpy(chunk + 4, "tEXt", 4);
    memcpy(chunk + 8, text, TEXT);
    put_word(chunk + 8 + TEXT, sum_of(chunk + 4, 4 + TEXT));
}

static cairo_status_t take(void *to, const unsigned char *data, unsigned length)
{
    bytes_add(to, data, length);
    return CAIRO_STATUS_SUCCESS;
}

void picture_save(cairo_surface_t *surface, const char *file, uint64_t digest)
{
    bytes png = {0}, whole = {0};
    unsigned char chunk[CHUNK];
    cairo_surface_mark_dirty(surface);
    cairo_status_t status = cairo_surface_write_to_png_stream(surface, take, &png);
    cairo_surface_destroy(surface);
    if (status != CAIRO_STATUS_SUCCESS) fail_input("%s: %s", file, cairo_status_to_string(status));
    if (digest && png.n > HEAD) {
        digest_chunk(digest, chunk);
        bytes_add(&whole, png.at, HEAD);
        bytes_add(&whole, chunk, CHUNK);
        bytes_add(&whole, png.at + HEAD, png.n - HEAD);
    }
    output_write(file, digest && png.n > HEAD ? &whole : &png);
    free(png.at), free(whole.at);
}

bool picture_is_whole(const char *file, uint64_t digest)
{
    bytes b = {0};
    unsigned char chunk[CHUNK];
    digest_chunk(digest, chunk);
    bool whole = output_read(file, &b) && b.n > HEAD + CHUNK &&
                 memcmp(b.at, "\x89PNG\r\n\x1a\n", SIGNATURE) == 0 &&
                 memcmp(b.at + HEAD, chunk, CHUNK) == 0;
    size_t at = SIGNATURE;
    bool ended = false;
    while (whole && !ended) {
        whole = b.n - at >= 12 && word_at(b.at + at) <= b.n - at - 12;
        if (!whole) break;
        const size_t length = word_at(b.at + at);
        whole = sum_of(b.at + at + 4, length + 4) == word_at(b.at + at + 8 + length);
        ended = memcmp(b.at + at + 4, "IEND", 4) == 0;
        at += 12 + length;
    }
    whole = whole && at == b.n;
    free(b.at);
    return whole;
}

static double shouldered(double x) { return x < 0.6 ? x : 0.6 + 0.4 * tanh((x - 0.6) / 0.4); }

void picture_write(const picture *p, double exposure, const char *file, uint64_t digest)
{
    cairo_surface_t *surface = picture_surface(p->width, p->height);
    for (int y = 0; y < p->height; y++)
        for (int x = 0; x < p->width; x++) {
            vec3 c = scaled(p->pixel[(size_t)y * (size_t)p->width + (size_t)x], exposure);
            picture_put(surface, x, y,
                        picture_code((vec3){shouldered(c.x), shouldered(c.y), shouldered(c.z)}));
        }
    picture_save(surface, file, digest);
}
