// SPDX-License-Identifier: MIT
/* ranks_mpi.c - the ranks of MPI, for `sagitta-mpi` (ranks.h).
 *
 * WHO GETS WHICH SHARE.  A counter lies in a window of rank 0, and a rank that is free adds one to it and has
 * what stood there (MPI_Fetch_and_op).  The other way is a coordinator, whom a message asks, and who looks
 * for it between two pieces of his own work.  Measured, for a claim of two ranks with tasks of 2 ms on a
 * machine of two busy processors: 2.6 us by the counter in the memory that they share, 5.6 ms by a
 * coordinator.  Over TCP both took 6 ms: there Open MPI adds when rank 0 calls MPI.  So rank 0 calls it often
 * (ranks_serve), and nobody has to be kept free for asking.
 *
 * TWO COUNTERS take turns.  When all have met at the end of a pass (ranks_wait), rank 0 sets the one that is
 * done to 0 while the other one is in use; it is not used again before the next meeting.
 *
 * WHO SPEAKS.  Until all have read the input (ranks_meet), what fails in one rank mostly fails in all: the
 * lowest rank that fails says why, and all end in good order.  Notes are those of rank 0.  Later a rank that
 * fails says so with its number, and ends the run by MPI_Abort.  What it was writing has no name yet
 * (part.c, output_name). */
#include "ranks.h"

#include "fail.h"
#include "memory.h"

#include <getopt.h>
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static struct {
    int here, all;
    bool met, alone, ending; /* ending: all ranks end, in good order */
    MPI_Win window;
    uint64_t *counter;       /* [2], of rank 0 */
    int turn;                /* which one is in use */
} ranks;

/* Waits for all, without taking a processor from those that still work: MPI itself would ask all the time. */
static void wait_for_all(void)
{
    const struct timespec moment = {.tv_nsec = 200000};
    MPI_Request all;
    int here = 0;
    MPI_Ibarrier(MPI_COMM_WORLD, &all);
    while (MPI_Test(&all, &here, MPI_STATUS_IGNORE), !here) nanosleep(&moment, NULL);
}

static void end_ranks(void)
{
    wait_for_all();
    MPI_Win_unlock_all(ranks.window);
    MPI_Win_free(&ranks.window);
    MPI_Finalize();
}

/* The lowest of the ranks that call with true; `all`: none did. */
static int lowest_that(bool fails)
{
    const int mine = fails ? ranks.here : ranks.all;
    int lowest = ranks.all;
    MPI_Allreduce(&mine, &lowest, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
    return lowest;
}

static bool may_fail(void)
{
    if (ranks.met || ranks.alone || ranks.ending) return true;
    ranks.ending = true;
    return lowest_that(true) == ranks.here;
}

static bool may_note(void) { return !ranks.here || ranks.met; }

static void end_all(int status)
{
    if (!ranks.met || ranks.ending) return;
    fail_tidy();
    MPI_Abort(MPI_COMM_WORLD, status);
}

void ranks_begin(int *argc, char **argv[])
{
    int level;
    MPI_Init_thread(argc, argv, MPI_THREAD_SERIALIZED, &level);
    MPI_Comm_rank(MPI_COMM_WORLD, &ranks.here);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks.all);
    MPI_Win_allocate(ranks.here ? 0 : 2 * sizeof *ranks.counter, sizeof *ranks.counter, MPI_INFO_NULL,
                     MPI_COMM_WORLD, &ranks.counter, &ranks.window);
    if (!ranks.here) ranks.counter[0] = ranks.counter[1] = 0;
    MPI_Win_lock_all(MPI_MODE_NOCHECK, ranks.window);
    MPI_Win_sync(ranks.window);
    MPI_Barrier(MPI_COMM_WORLD);
    atexit(end_ranks);
    const char *who = ranks.here ? memory_print("sagitta: rank %d: ", ranks.here) : "sagitta: ";
    fail_as(&(fail_speaker){.who = who, .fails = may_fail, .notes = may_note, .end = end_all});
    if (level < MPI_THREAD_SERIALIZED) fail_input("this MPI allows no threads (MPI_THREAD_SERIALIZED)");
    if (!ranks.here) return;
    opterr = 0; /* what is wrong with the arguments rank 0 says */
    if (!freopen("/dev/null", "w", stdout)) fail_input("/dev/null: cannot be opened");
}

bool ranks_are(void) { return true; }
int ranks_here(void) { return ranks.here; }
int ranks_all(void) { return ranks.all; }

void ranks_alone(void)
{
    if (ranks.here) exit(EXIT_DECIDED);
    ranks.all = 1, ranks.alone = true;
}

void ranks_meet(uint64_t digest)
{
    uint64_t first = digest;
    if (lowest_that(false) < ranks.all) {
        ranks.ending = true;
        exit(EXIT_BAD_INPUT);
    }
    ranks.met = true;
    ranks_tell(&first, sizeof first);
    if (first != digest) fail_input("the lens or the rays are not those that rank 0 has read");
}

void ranks_tell(void *bytes, size_t size) { MPI_Bcast(bytes, (int)size, MPI_BYTE, 0, MPI_COMM_WORLD); }

void ranks_tell_text(char **text, size_t *length)
{
    enum { PIECE = 1 << 30 };
    if (ranks.all == 1) return;
    ranks_tell(length, sizeof *length);
    if (ranks.here) *text = memory_grow(*text, *length + 1, 1), (*text)[*length] = 0;
    for (size_t at = 0; at < *length; at += PIECE)
        ranks_tell(*text + at, *length - at < PIECE ? *length - at : PIECE);
}

struct ranks_file { MPI_File file; const char *path; };

static void require_written(const ranks_file *f, int error)
{
    char why[MPI_MAX_ERROR_STRING];
    int length;
    if (error == MPI_SUCCESS) return;
    MPI_Error_string(error, why, &length);
    fail_input("--output %s: could not be written: %s", f->path, why);
}

ranks_file *ranks_open(const char *path, const char *name)
{
    ranks_file *f = memory_take(1, sizeof *f);
    f->path = path;
    require_written(f, MPI_File_open(MPI_COMM_WORLD, name, MPI_MODE_WRONLY, MPI_INFO_NULL, &f->file));
    return f;
}

void ranks_write(ranks_file *f, size_t at, const void *bytes, size_t size)
{
    MPI_Status status;
    int count = 0;
    if (!size) return;
    require_written(f, MPI_File_write_at(f->file, (MPI_Offset)at, bytes, (int)size, MPI_BYTE, &status));
    MPI_Get_count(&status, MPI_BYTE, &count);
    if (count < 0 || (size_t)count != size) fail_input("--output %s: could not be written", f->path);
}

void ranks_close(ranks_file *f) { require_written(f, MPI_File_close(&f->file)); }

/* Does this to the counter that is in use; returns what stood there. */
static uint64_t change_counter(MPI_Op how, uint64_t by)
{
    uint64_t before = 0;
    MPI_Fetch_and_op(&by, &before, MPI_UINT64_T, 0, ranks.turn, how, ranks.window);
    MPI_Win_flush(0, ranks.window);
    return before;
}

size_t ranks_next(void) { return (size_t)change_counter(MPI_SUM, 1); }

void ranks_serve(void)
{
    int any;
    if (!ranks.here && ranks.all > 1) MPI_Iprobe(MPI_ANY_SOURCE, 0, MPI_COMM_WORLD, &any, MPI_STATUS_IGNORE);
}

void ranks_wait(void)
{
    wait_for_all();
    if (!ranks.here) change_counter(MPI_REPLACE, 0);
    ranks.turn = !ranks.turn;
}
