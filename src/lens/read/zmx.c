// SPDX-License-Identifier: MIT
/* zmx.c - lenses as OpticStudio (Zemax) writes them, .zmx.
 *
 * THE TEXT.  A line is a record: a keyword, and fields with blanks between.  SURF n opens a surface, and the
 * records of surfaces that follow belong to it; only the keyword tells them from records of the system, for
 * not all writers indent.  Records of the system stand before and behind the surfaces in any order: so all of
 * the file is read before anything is made of it.  The format is not published; what its numbers mean is
 * known from OpticStudio's help, which documents the quantities, and from files whose traces agree.
 *
 * WHAT STORED NUMBERS ARE.  Solves and pickups are stored together with the numbers they gave.  Those that
 * the lens file has, too, are kept if they give the stored number (../open/resolve.c); of others the number
 * is.  With several configurations the surfaces are those of the active one; zmx_operands.c has the others.
 * DIAM is a semi-diameter that blocks nothing: most of them were computed from rays.
 *
 * NOTHING IN SILENCE.  The tables of zmx_system.c and zmx_surface.c say of each keyword what becomes of it:
 * it is read, it was turned into its value, it is left out, or it has no effect on rays.  What is in no
 * table is a remark, once for each keyword.  An unknown type of surface is an error.
 *
 * FILES THAT ARE CUT OFF.  A number that is cut off is a number, too.  So a record that is read needs an end
 * of line.  Texts do not, and neither does DISZ at the end of a file: it is that of the last surface, where
 * it means nothing.  A surface without DISZ is refused.  A file that ends with its surfaces gets a note.
 *
 * Each line is looked at once, and what is kept of it is of its size. */
#include "zmx.h"
#include "vary.h"

#include <stdint.h>
#include <string.h>

/* ----------------------------------------------------------------- records */

/* Behind the surfaces: operands of the merit function (OpticStudio's help, Optimization Operands). */
static const char operands[] =
    "ABCD ABGT ABLT ABSO ACOS AMAG ANAC ANAR ANAX ANAY ANCX ANCY ASIN ASTI ATAN AXCL BFSD BIOC BIOD BIPF "
    "BLNK BLTH BSER CEGT CEHX CEHY CELT CENX CENY CEVA CIGT CILT CIVA CMFV CMGT CMLT CMVA CNAX CNAY CNPX "
    "CNPY CODA COGT COLT COMA CONF CONS COSI COVA CTGT CTLT CTVA CVGT CVLT CVOL CVVA DENC DENF DIFF DIMX "
    "DISA DISC DISG DIST DIVB DIVI DLTN DMFS DMGT DMLT DMVA DXDX DXDY DYDX DYDY EFFL EFLX EFLY EFNO ENDX "
    "ENPP EPDI EQUA ERFP ETGT ETLT ETVA EXPD EXPP FCGS FCGT FCUR FDMO FDRE FICL FICP FOUC FTGT FTLT GBPD "
    "GBPP GBPR GBPS GBPW GBPZ GCOS GENC GENF GLCA GLCB GLCC GLCR GLCX GLCY GLCZ GMTA GMTS GMTT GOTO GPIM "
    "GRMN GRMX GTCE HHCN HYLD IMAE INDX ISFN ISNA LACL LINV LOGE LOGT LONA LPTD MAXX MCOG MCOL MCOV MECA "
    "MECS MECT MINN MNAB MNCA MNCG MNCT MNCV MNDT MNEA MNEG MNET MNIN MNPD MNRE MNRI MNSD MSWA MSWS MSWT "
    "MTFA MTFS MTFT MTHA MTHS MTHT MXAB MXCA MXCG MXCT MXCV MXDT MXEA MXEG MXET MXIN MXPD MXRE MXRI MXSD "
    "NORD NORX NORY NORZ OBSN OOFF OPDC OPDM OPDX OPGT OPLT OPTH OPVA OSCD OSUM PANA PANB PANC PARA PARB "
    "PARC PARR PARX PARY PARZ PATX PATY PETC PETZ PIMH PLEN PMAG PMGT PMLT PMVA POWF POWP POWR PRIM PROB "
    "PROD QSUM RAED RAEN RAGA RAGB RAGC RAGX RAGY RAGZ RAID RAIN RANG REAA REAB REAC REAR REAX REAY REAZ "
    "RECI RELI RENA RENB RENC RETX RETY RGLA RSCE RSCH RSRE RSRH RWCE RWCH RWRE RWRH SAGX SAGY SFNO SINE "
    "SKIN SKIS SMIA SPCH SPHA SQRT SSAG STHI STRH SUMM SVIG TANG TFNO TGTH TMAS TOLR TOTR TRAC TRAD TRAE "
    "TRAI TRAR TRAX TRAY TRCX TRCY TTGT TTHI TTLT TTVA USYM VOLU WFNO WLEN XDGT XDLT XDVA XENC XENF XNEA "
    "XNEG XNET XXEA XXEG XXET YNIP ZERN ZPLM ZTHI ";

/* Behind MNUM: operands of the configurations (Multi-Configuration Operands).  Some are keywords elsewhere.
 */
static const char configurations[] =
    "AFOC AICN APDF APDT APDX APDY APER APMN APMX APTP CADX CADY CATX CATY CATZ CHZF CONN COTN CROR CRSR "
    "CRVT "
    "CSP1 CSP2 CWGT DCCA EDVA FLTP FLWT FVAN FVCX FVCY FVDX FVDY GCRS GLSS GPEX GPEY GPIU GPJX GPJY GPPX "
    "GPPY "
    "GQPO HOLD IGNM IGNR LTTL MABB MABT MCOM MCSD MDPG MIND MOFF MTFU NCOM NCOT NGLS NPAR NPOS NPRO NSPO "
    "OPDR PAR1 PAR2 PAR3 PAR4 PAR5 PAR6 PAR7 PAR8 PRAM PRES PRWV PSCX PSCY PSHX PSHY PSHZ PSP1 PSP2 PSP3 "
    "PSP4 PUCN PXAR RAAM SATP SDIA SDRW SRTS STPS TELE TEMP THIC TSP1 TSP2 TSP3 WAVE WLWT XFIE YFIE ";

static bool listed(piece key, const char *names)
{
    size_t length = (size_t)(key.end - key.begin);
    if (length != 4 && length != 3) return false;
    for (; *names; names += 5)
        if (memcmp(key.begin, names, length) == 0 && (length == 4 || names[3] == ' ')) return true;
    return false;
}

static void count_unknown(zmx *z, piece key)
{
    key.end = key.begin + sgt_reader_width(key);
    for (size_t i = 0; i < z->unknowns; i++)
        if (sgt_reader_is(key, z->unknown[i].key)) {
            z->unknown[i].count++;
            return;
        }
    if (z->unknowns == ZMX_UNKNOWN)
        z->others++;
    else
        z->unknown[z->unknowns++] = (zmx_count){sgt_zmx_copy(z, key), z->lines.line, 1};
}

static const zmx_table *const tables[] = {&sgt_zmx_surface_records, &sgt_zmx_system_records};

/* Reads a record of a table: 0 is that of the surfaces. */
static void read_known(zmx *z, size_t table)
{
    const zmx_record *r = z->row;
    size_t line = z->lines.line, place = (size_t)(r - tables[table]->record);
    if (table == 0 && z->count == 0 && r->fate != ZMX_OPEN)
        tree_fail(z->s, line, r->key, "this record of a surface stands before the first surface");
    size_t *met = &z->record[table][place].met, now = table == 0 ? z->count : 1;
    if (*met == now && (r->fate == ZMX_ONCE || r->fate == ZMX_LOOSE))
        tree_fail(z->s, line, r->key, "a second %s%s", r->key, table == 0 ? " of this surface" : "");
    *met = now;
    zmx_count *count = &z->record[table][place].count;
    if (count->count++ == 0) count->line = line;
    if (!r->read) return;
    if (!z->lines.whole && r->fate != ZMX_LOOSE && r->fate != ZMX_FREE)
        tree_fail(z->s, line, r->key, "the file ends in the middle of this line; is it cut off?");
    z->field = 0;
    r->read(z);
}

static void read_record(zmx *z, piece line)
{
    z->rest = line;
    piece key = sgt_reader_word(&z->rest);
    if (key.begin == key.end) return;
    if (!z->line) z->line = z->lines.line;
    if (z->configuration_line && z->count && listed(key, configurations)) {
        sgt_zmx_operand(z, key);
        return;
    }
    for (size_t table = 0; table < 2; table++)
        for (size_t i = 0; i < tables[table]->count; i++)
            if (sgt_reader_is(key, tables[table]->record[i].key)) {
                z->row = &tables[table]->record[i];
                z->behind = table == 1 || (z->behind && z->row->fate != ZMX_OPEN);
                read_known(z, table);
                return;
            }
    if (listed(key, tables[0]->idle)) return;
    if (listed(key, tables[1]->idle) || (z->count && listed(key, operands)))
        z->behind = true;
    else
        count_unknown(z, key);
}

/* ----------------------------------------------------------------- remarks */

static void tell(zmx *z, sgt_remark_kind kind, const char *key, const zmx_count *c, const char *words)
{
    if (c->count == 1) tree_remark(z->s, kind, c->line, key, "%s", words);
    if (c->count > 1) tree_remark(z->s, kind, c->line, key, "%s (%zu times)", words, c->count);
}

static void tell_tallies(zmx *z)
{
    enum { TURNED = SGT_REMARK_TURNED, LEFT = SGT_REMARK_LEFT_OUT };
    static const struct {
        int kind;
        const char *words;
    } tallies[ZMX_TALLIES] = {
        [ZMX_BREAKS] = {TURNED, "a break"},
        [ZMX_TILTED] = {TURNED, "a plane with a tilt"},
        [ZMX_SCBD] = {TURNED, "a break before or behind the surface: its tilt or decenter"},
        [ZMX_RETURNS] = {TURNED, "the numbers that are stored in its break: it is a coordinate return"},
        [ZMX_SOLVES] = {TURNED, "the number that is stored: it is a solve or pickup"},
        [ZMX_PICKUPS] = {TURNED, "the glass of the surface that it names: it is a pickup"},
        [ZMX_MODELS] = {TURNED, "its nd, vd and dPgF: a model glass, which is approximate"},
        [ZMX_FLAP] = {TURNED, "a clear aperture of the size of DIAM: it is a floating one"},
        [ZMX_UNUSED] = {LEFT, "a number that this type of surface does not use"},
        [ZMX_BREAK_GLASS] = {LEFT, "the glass of a coordinate break"},
        [ZMX_APERTURES] = {LEFT,
                           "an aperture without a size, or of an object, a coordinate break or a tilted "
                           "surface"},
        [ZMX_VIGNETTED] = {LEFT, "vignetting factors"},
    };
    for (size_t i = 0; i < ZMX_TALLIES; i++)
        for (const zmx_count *t = z->tally[i]; t < z->tally[i] + ZMX_KEYS; t++)
            tell(z, (sgt_remark_kind)tallies[i].kind, t->key, t, tallies[i].words);
}

static void tell_records(zmx *z)
{
    for (size_t table = 0; table < 2; table++)
        for (size_t i = 0; i < tables[table]->count; i++) {
            const zmx_record *r = &tables[table]->record[i];
            const zmx_count *count = &z->record[table][i].count;
            if (r->fate == ZMX_SOLVE)
                tell(z, SGT_REMARK_TURNED, r->key, count,
                     "the number that is stored: it is a solve or pickup");
            if (r->fate == ZMX_LEFT)
                tell(z, SGT_REMARK_LEFT_OUT, r->key, count, "this record");
        }
    for (size_t i = 0; i < z->unknowns; i++)
        tell(z, SGT_REMARK_LEFT_OUT, z->unknown[i].key, &z->unknown[i], "an unknown record");
    if (z->others)
        tree_remark(z->s, SGT_REMARK_LEFT_OUT, z->lines.line, "records", "%zu more unknown ones",
                    z->others);
    if (!z->behind)
        tree_remark(
            z->s, SGT_REMARK_NOTE, z->lines.line, "SURF",
            "the file ends with a surface; OpticStudio writes other records behind it, so it may be cut off");
}

/* ---------------------------------------------------------------- the file */

static void require_surfaces(zmx *z)
{
    if (z->count == 0)
        tree_fail(z->s, z->lines.line ? z->lines.line : 1, "SURF", "there is no surface in this file");
    if (z->count == 1) tree_fail(z->s, z->surface[0].line, "SURF", "there is no surface behind the object");
    for (size_t i = 0; i < z->count; i++)
        if (!z->surface[i].thickness_line && (i < z->count - 1 || !z->behind))
            tree_fail(z->s, z->surface[i].line, "SURF", "surface %zu has no DISZ", i);
    if (!z->stop_line)
        tree_remark(z->s, SGT_REMARK_NOTE, z->line, "STOP",
                    "taken as the first surface, since none is marked");
}

static void require_configuration(const zmx *z, int wanted)
{
    const size_t line = z->configuration_line ? z->configuration_line : z->line;
    const size_t count = z->configurations > 1 ? z->configurations : 1;
    if (count > 1 && (z->configuration < 1 || z->configuration > count))
        tree_fail(z->s, line, "MNUM", "there are %zu; number %zu is said to be active", count,
                  z->configuration);
    if (wanted < 0 || (size_t)wanted > count)
        tree_fail(z->s, line, "MNUM", "there %s %zu; there is no configuration %d", count == 1 ? "is" : "are",
                  count, wanted);
}

/* Of several configurations: those that the rows behind MNUM can make of the active one. */
static void read_others(zmx *z, size_t taken, int wanted)
{
    source *s = z->s;
    const size_t active = z->configuration;
    const bool vary = taken && (!wanted || (size_t)wanted != active);
    if (z->configurations < 2 || s->varies) return;
    const size_t line = z->configuration_line;
    if (vary && sgt_vary(s, z->configurations, line, "MNUM", "configuration", sgt_read_zmx)) {
        tree_remark(s, SGT_REMARK_NOTE, line, "MNUM",
                    "number %zu of %zu is the active one: its values are those of the file itself", active,
                    z->configurations);
        return;
    }
    if (!vary && wanted) s->chosen_number = active; /* it is that one */
    if (wanted && (size_t)wanted != active)
        tree_fail(s, line, "MNUM",
                  "the surfaces are those of configuration %zu; number %d cannot be made of them", active,
                  wanted);
    if (!wanted && !vary)
        tree_remark(s, SGT_REMARK_LEFT_OUT, line, "MNUM",
                    "all of the %zu configurations but the active one, number %zu", z->configurations,
                    active);
}

void sgt_read_zmx(source *s)
{
    zmx *z = tree_room(s, 1, sizeof *z);
    z->s = s, z->fields = z->waves = SIZE_MAX;
    z->lines.at = s->text, z->lines.end = s->text + s->length;
    for (piece line; sgt_reader_line(&z->lines, &line);) read_record(z, line);
    sgt_zmx_end_note(z);
    require_surfaces(z);
    const int wanted = s->options->configuration;
    require_configuration(z, wanted);
    const size_t taken = sgt_zmx_configure(z, s->varies ? (size_t)wanted : z->configuration);
    s->root = tree_node(s, NODE_MAP, z->line);
    sgt_zmx_write_system(z, s->root);
    sgt_zmx_write_surfaces(z, s->root);
    tell_tallies(z);
    tell_records(z);
    read_others(z, taken, wanted);
}
