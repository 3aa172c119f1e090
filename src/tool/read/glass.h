/* glass.h - a glass as a lens file names it: its index at a wavelength. */
#ifndef TOOL_GLASS_H
#define TOOL_GLASS_H
#include "document.h"

/* --glass: a catalogue, or a folder of them, whose glasses go before those that ship. */
void glass_folder(const char *path);

/* Makers in the order in which one is taken where several have a name. */
typedef struct glass_makers {
    size_t count;
    const char **name;
} glass_makers;

/* The index at `um` micrometres of what `n` says: a name, {nd, vd, dPgF}, {sellmeier: [...]}, or a list of
 * [wavelength, index].  Notes what a user should know: a wavelength outside the range, which maker was taken,
 * an approximation. */
double glass_index(const document *d, node *n, const char *key, double um, const glass_makers *makers);

#endif
