// SPDX-License-Identifier: MIT
/* glass.c - what the library of glass answers, as text for test_glass.py.
 *
 *     glass list PATH UM...              each glass, and its indices in hexadecimal
 *     glass find PATH NAME MAKER...      the glass of that name
 *     glass prefixes FILE STEP           every STEP-th prefix of a file: its glasses, or the error
 *     glass text NAME FILE               the bytes of a file under another name
 *     glass index FORMULA UM C...        a glass of one's own
 *     glass memory FILE                  each allocation fails once
 * PATH - is the table that ships. */
#include <sagitta/lens.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int told(const sgt_error *e)
{
    printf("error\t%s\t%zu\t%s\t%s\n", e->file, e->line, e->key, e->words);
    return 3;
}

static void show(const sgt_glass *g, int count, char **um)
{
    printf("%s\t%s\t%d\t%a\t%a\t%a\t%a\t%s\t%zu", g->maker, g->name, g->formula, g->from, g->to, g->nd, g->vd,
           g->remark ? g->remark : "", g->line);
    for (size_t i = 0; i < g->count; i++) printf("%c%a", i ? ' ' : '\t', g->coefficient[i]);
    for (int i = 0; i < count; i++) {
        double w = strtod(um[i], NULL);
        printf("\t%a%s", sgt_glass_index(g, w), sgt_glass_covers(g, w) ? "" : " outside");
    }
    printf("\n");
}

static char *all_of(const char *path, size_t *length)
{
    FILE *file = fopen(path, "rb");
    if (!file) exit(2);
    char *text = malloc(1 << 22);
    *length = text ? fread(text, 1, 1 << 22, file) : 0;
    fclose(file);
    return text;
}

static int prefixes(const char *path, size_t step)
{
    size_t length;
    char *text = all_of(path, &length);
    for (size_t n = 0; n <= length; n += step) {
        sgt_error e = {0};
        sgt_catalogue *c = sgt_catalogue_new(NULL);
        char *exact = malloc(n ? n : 1); /* so that a sanitizer sees a step too far */
        if (!c || !exact) return 2;
        memcpy(exact, text, n);
        bool fine = sgt_catalogue_add_text(c, path, exact, n, &e);
        if (fine) printf("fine\t%zu\t%zu\n", n, sgt_catalogue_count(c));
        else told(&e);
        free(exact);
        sgt_catalogue_free(c);
    }
    free(text);
    return 0;
}

typedef struct meter { long left, held; } meter;

static void *metered(void *context, void *old, size_t size)
{
    meter *m = context;
    if (size && m->left-- <= 0) return NULL;
    m->held += (size != 0) - (old != NULL);
    if (size) return realloc(old, size);
    free(old);
    return NULL;
}

static int memory(const char *path)
{
    for (long most = 0; most < 100000; most++) {
        meter m = {.left = most};
        sgt_error e = {0};
        sgt_catalogue *c = sgt_catalogue_new(&(sgt_allocator){metered, &m});
        bool fine = c && sgt_catalogue_add(c, path, &e);
        if (c && !fine && !strstr(e.words, "memory")) return told(&e);
        sgt_catalogue_free(c);
        if (m.held) return printf("%ld blocks are left\n", m.held), 1;
        if (fine) return printf("fine after %ld\n", most), 0;
    }
    return 1;
}

int main(int argc, char **argv)
{
    if (argc < 3) return 2;
    const char *what = argv[1], *path = strcmp(argv[2], "-") ? argv[2] : NULL;
    if (!strcmp(what, "prefixes") && argc == 4) return prefixes(path, (size_t)atol(argv[3]));
    if (!strcmp(what, "memory")) return memory(path);
    if (!strcmp(what, "index") && argc > 3) {
        double c[100];
        sgt_glass g = {.formula = atoi(argv[2]), .coefficient = c};
        for (int i = 4; i < argc && g.count < 100; i++) c[g.count++] = strtod(argv[i], NULL);
        sgt_error fault = {.words = ""};
        (void)sgt_glass_sound(&g, &fault);
        printf("%a\t%s\n", sgt_glass_index(&g, strtod(argv[3], NULL)), fault.words);
        return 0;
    }
    sgt_error e = {0};
    sgt_glass g;
    sgt_catalogue *c = sgt_catalogue_new(NULL);
    int status = 0;
    bool fine;
    if (!strcmp(what, "text") && argc == 4) {
        size_t length;
        char *text = all_of(argv[3], &length);
        fine = sgt_catalogue_add_text(c, path, text, length, &e);
        free(text);
    } else {
        fine = sgt_catalogue_add(c, path, &e);
    }
    if (!fine) status = told(&e);
    else if (!strcmp(what, "find") && argc > 3) {
        if (sgt_catalogue_find(c, argv[3], (size_t)(argc - 4), (const char *const *)argv + 4, &g, &e))
            show(&g, 0, NULL);
        else status = told(&e);
    } else {
        for (size_t i = 0; sgt_catalogue_glass(c, i, &g); i++) show(&g, argc - 3, argv + 3);
    }
    sgt_catalogue_free(c);
    return status;
}
