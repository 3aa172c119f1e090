#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fast_math.py ROOT LIBRARY COMMAND CC   arithmetic that no bound was made for is told, and not compiled.

A program linked with -Ofast, rounding upward, a library linked with -Ofast and loaded before the command:
sgt_arithmetic, sgt_check and the command say so.  Each flag of meson.build's list ends the configuration, wherever it
is given, with its name; and a compiler that has such a flag in itself, where no name is to be seen, does too.
"""
import os, re, shlex, subprocess, sys, tempfile

root, library, command, cc = sys.argv[1], sys.argv[2], sys.argv[3], shlex.split(sys.argv[4])
failures = 0


def require(condition, what):
    global failures
    if not condition:
        failures += 1
        print("FAIL " + what)


def run(*words, **more):
    return subprocess.run(words, capture_output=True, text=True, **more)


def programs(folder):
    source, where = os.path.join(root, "tests/build/fast_math.c"), os.path.dirname(library)
    plain = [source, "-I" + os.path.join(root, "include"), library, "-Wl,-rpath," + where, "-lm"]
    said = {}
    for flag in ("-O2", "-Ofast"):
        program = os.path.join(folder, "program" + flag)
        built = run(*cc, flag, "-o", program, *plain)
        require(built.returncode == 0, f"{flag}: {built.stderr}")
        said[flag] = [line.split(" ", 2) for line in run(program).stdout.splitlines()]
    require([s[:2] for s in said["-O2"]] == [["0", "0"], ["4", "1"], ["0", "0"]], f"-O2: {said['-O2']}")
    bits = [int(s[0]) for s in said["-Ofast"]]
    # (Not each compiler and processor has a start that flushes.)
    flushes = bits[0] & 3
    require(bits == [flushes, flushes | 4, flushes], f"-Ofast: {said['-Ofast']}")
    require(all(s[1] == str(int(s[0] != "0")) for s in said["-Ofast"]), f"sgt_check: {said['-Ofast']}")
    for line in said["-O2"] + said["-Ofast"]:
        for bit, word in ((1, "flush-to-zero"), (2, "denormals-are-zero"), (4, "not to nearest")):
            require((word in line[2]) == bool(int(line[0]) & bit), f"the text of {line}")
    if os.uname().machine == "x86_64":
        require(flushes == 3, "a program linked with -Ofast flushes on x86-64")
    return flushes


def preloaded(folder, flushes):
    empty, loaded = os.path.join(folder, "empty.c"), os.path.join(folder, "loaded.so")
    open(empty, "w").write("int loaded = 1;\n")
    run(*cc, "-shared", "-fPIC", "-Ofast", "-o", loaded, empty, check=True)
    ask = [command, "intersect", "--surface", "{type: sphere, radius: 20}", "--ray", "0 3 -5 0 0 1"]
    before, after = run(*ask), run(*ask, env={**os.environ, "LD_PRELOAD": loaded})
    require(before.returncode == 0, f"the command: {before}")
    if not flushes or after.returncode == 0 and after.stdout == before.stdout and not sets_word(loaded):
        return  # this linker leaves the start of fast arithmetic out of libraries
    require(after.returncode == 3 and not after.stdout, f"the command with {loaded}: {after}")
    require("flush-to-zero" in after.stderr and "-Ofast" in after.stderr, f"the command says {after.stderr}")


def sets_word(loaded):
    return "set_fast_math" in run("nm", loaded).stdout


def configured(folder, *arguments, **environment):
    build = tempfile.mkdtemp(dir=folder)
    done = run("meson", "setup", build, root, *arguments, env={**os.environ, "CC": shlex.join(cc), **environment})
    return done.returncode, done.stdout + done.stderr


def refused(folder):
    text = open(os.path.join(root, "meson.build")).read()
    flags = re.findall(r"'(-[^']+)'", re.search(r"refused_flags = \[(.*?)\]", text, re.S)[1])
    require(len(flags) > 15, f"the list of flags in meson.build: {flags}")
    empty = os.path.join(folder, "empty.c")
    ways = [
        lambda flag: configured(folder, f"-Dc_args=-O2 {flag}"),
        lambda flag: configured(folder, CFLAGS=f"-g {flag}"),
        lambda flag: configured(folder, f"-Dc_link_args={flag}"),
    ]
    code, said = configured(folder, "-Dcpp_args=-ffast-math")
    require(code != 0 and "-ffast-math: the error bounds" in said, f"-Dcpp_args: {code}: {said[-300:]}")
    for i, flag in enumerate(flags):
        if run(*cc, "-Werror", flag, "-shared", "-fPIC", "-o", empty + ".so", empty).returncode:
            continue  # this compiler has no such flag
        code, said = ways[i % len(ways)](flag)
        require(code != 0 and flag + ": the error bounds" in said, f"{flag}: {code}: {said[-300:]}")
    for flag in ("-ffinite-math-only", "-fno-signed-zeros", "-freciprocal-math", "-funsafe-math-optimizations"):
        hidden = os.path.join(folder, "cc" + flag)
        open(hidden, "w").write(f"#!/bin/sh\nexec {shlex.join(cc)} \"$@\" {flag}\n")
        os.chmod(hidden, 0o755)
        code, said = configured(folder, CC=hidden)
        require(code != 0 and "takes it that" in said, f"a compiler with {flag} in itself: {code}: {said[-300:]}")


with tempfile.TemporaryDirectory() as folder:
    preloaded(folder, programs(folder))
    refused(folder)
print(f"{failures} failures")
sys.exit(failures > 0)
