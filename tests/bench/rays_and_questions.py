#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What is asked of the rays of a lens, beside the rays themselves: nanoseconds a ray.

    python3 tests/bench/rays_and_questions.py BUILD [--before BUILD] [--runs N] [--threads N] [--only WORDS]

Each row is a question: an analysis by the command (BUILD/src/tool/sagitta), or a call of the library
(BUILD/tests/bench/bench_questions).  Of the command the difference of two runs is taken, one of many rays
and one of few, so that starting it does not count; the coarse pattern that some analyses trace besides does.
All rows are run in turn, in one thread and in several, with the other build between them if there is one;
the table has medians.  "now" and "before" are processor time of one thread, which a busy machine hardly
changes; the last column is how many times less time passes with several threads.  That needs an idle machine: the load
stands above the table.

"to reach" was set on one processor (a Zen 4), where an earlier build took what WAS says.  On another processor
that figure is another one.  So with --before the table also has how many times less was wanted there, "wanted",
and how many times less it is here, "gained".  What another build cannot be asked is left out.

TABLES has the functions that give rows.  Another group of questions is another function there.
"""
import argparse
import collections
import math
import os
import pathlib
import statistics
import subprocess
import time

HERE = pathlib.Path(__file__).resolve().parent
LENS = HERE.parent.parent / 'examples' / 'lenses' / 'cooke_triplet.yaml'
PHONE = HERE / 'phone_lens.yaml'
FIELDS = 3

# limit: ns a ray to reach, None: there is none; was: ns a ray where that was set, None: not measured;
# took(build, threads): ns a ray, of the processor and that pass; threaded: it may be asked in several threads
Row = collections.namedtuple('Row', 'question limit was took threaded')

# Of a spot, and of an analysis with paths; all others go through the same functions.
WAS_SPOT, WAS_OPD = 4400, 3700
WAS_PATH, WAS_PHONE = 2.4, 58  # a surface; 2.4 is the least of a path


def seconds(command):
    """Of the processor, and that pass."""
    begin = time.perf_counter()
    child = subprocess.Popen([*map(str, command)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    said = child.stderr.read()
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    assert child.returncode in (0, 1), (command, said)
    return usage.ru_utime + usage.ru_stime, time.perf_counter() - begin


def analysis(name, limit, was, many, few, *more):
    """many, few: the patterns, (option, n, rays)."""
    def took(build, threads):
        def ask(pattern):
            return seconds((build / 'src/tool/sagitta', name, LENS, *pattern[:2], *more, '--threads', threads,
                            '--format', 'csv', '--output', os.devnull))
        return tuple((a - b) / (many[2] - few[2]) * 1e9 for a, b in zip(ask(many), ask(few)))
    return Row(f'`{" ".join(map(str, (name, *many[:2], *more)))}`', limit, was, took, True)


def hexapolar(n, fields=FIELDS):
    return '--hexapolar', n, fields * (1 + 3 * n * (n + 1))


def grid(n):
    """The points of the square that lie in the circle."""
    place = [(2 * i - n + 1) / (n - 1) for i in range(n)]
    return '--grid', n, FIELDS * sum(x * x + y * y <= 1 + 2 ** -44 for x in place for y in place)


def analyses():
    aimed = '--aim', 'real'
    yield analysis('spot', 300, WAS_SPOT, hexapolar(500), hexapolar(20))
    yield analysis('spot', 300, WAS_SPOT, hexapolar(300), hexapolar(20), *aimed)
    yield analysis('opd', 300, WAS_OPD, grid(600), grid(20), '--summary', *aimed)
    yield analysis('opd', 300, WAS_OPD, grid(300), grid(20), *aimed)
    yield analysis('fan', 300, WAS_OPD, grid(300), grid(20), *aimed)
    yield analysis('map', 300, WAS_OPD, grid(300), grid(20), *aimed)
    yield analysis('sweep', 300, WAS_SPOT, hexapolar(100, 20), hexapolar(10, 20), '--to', 14, '--steps', 20, *aimed)


def library():
    """The calls, in one thread.  A run of the first row of a lens asks them all."""
    kept = {}

    def ask(build, lens):
        done = subprocess.run([build / 'tests/bench/bench_questions', lens, '5'], capture_output=True,
                              text=True, check=True)
        lines = [line.split(',') for line in done.stdout.splitlines()]
        return collections.defaultdict(lambda: float('nan'), {name: float(ns) for name, ns, _ in lines},
                                       surfaces=int(lines[0][2]))

    def row(question, limit, of, first=False, was=None, lens=LENS):
        def took(build, threads):
            if first or (build, lens) not in kept:
                kept[build, lens] = ask(build, lens)
            return 2 * (of(kept[build, lens]),)
        return Row(question, limit, was, took, False)
    yield row('its rays alone: `sgt_trace_batch`, the last point', None, lambda k: k['trace'], first=True)
    yield row('the path besides, a surface', 1, lambda k: (k['trace and path'] - k['trace']) / k['surfaces'],
              was=WAS_PATH)
    yield row('all that errors need, at every element', None, lambda k: k['all told'])
    yield row('`sgt_trace_error_batch`: point and path', None, lambda k: k['errors'])
    yield row('`sgt_trace_sensitivity_batch`, two changes', None, lambda k: k['derivatives'])
    yield row('`sgt_trace_gradient_batch`, all parameters', None, lambda k: k['gradient'])
    yield row('a trace of eight odd aspheres, a surface', 20, lambda k: k['trace'] / k['surfaces'], first=True,
              was=WAS_PHONE, lens=PHONE)


TABLES = [library, analyses]


def print_row(cells):
    print('| ' + ' | '.join(cells) + ' |')


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('build', type=pathlib.Path)
    parser.add_argument('--before', type=pathlib.Path, help='another build, for a column of its own')
    parser.add_argument('--runs', type=int, default=5)
    parser.add_argument('--threads', type=int, default=2)
    parser.add_argument('--only', default='', help='questions with these words in them')
    asked = parser.parse_args()
    rows = [row for table in TABLES for row in table() if table is library or asked.only in row.question]
    several = f'{asked.threads} threads'
    ways = [('now', asked.build, 1), (several, asked.build, asked.threads)]
    if asked.before:
        ways.insert(0, ('before', asked.before, 1))
    took = collections.defaultdict(list)
    load = os.getloadavg()[0]
    for _ in range(asked.runs):
        for row in rows:
            for name, build, threads in ways:
                if row.threaded or (name != several and (build / 'tests/bench/bench_questions').exists()):
                    took[row.question, name].append(row.took(build, threads))
    print(f'Load of the machine: {load:.2f} before, {os.getloadavg()[0]:.2f} behind.\n')

    def median(row, name, which=0):
        pairs = took[row.question, name]
        return statistics.median(pair[which] for pair in pairs) if pairs else math.nan

    def figure(value, form='.3g'):
        return '' if value is None or math.isnan(value) else f'{value:{form}}'
    before = bool(asked.before)
    head = ['ns a ray', *before * ['before'], 'now', 'to reach', *before * ['wanted', 'gained'], 'times its rays', several]
    print_row(head)
    print('|' + '---|' * len(head))
    for row in rows:
        was, now = median(row, 'before'), median(row, 'now')
        wanted = row.was / row.limit if row.was and row.limit else None
        print_row([row.question, *before * [figure(was)], figure(now), figure(row.limit),
                   *before * [figure(wanted), figure(was / now)], figure(now / median(rows[0], 'now'), '.1f'),
                   figure(median(row, 'now', 1) / median(row, several, 1), '.2f')])


if __name__ == '__main__':
    main()
