#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Every constant and type of every public header, named in a C++ program.

C++ scopes what stands inside a struct, and C does not.

    python3 cxx_names.py INCLUDE C++
"""
import pathlib
import re
import shlex
import subprocess
import sys

include = pathlib.Path(sys.argv[1])
headers = sorted(h for h in (include / 'sagitta').glob('*.h'))
text = ''.join(re.sub(r'/\*.*?\*/|//[^\n]*', '', h.read_text(), flags=re.S) for h in headers)
constants, types = set(), set(re.findall(r'^\}\s*(sgt_\w+)\s*;', text, re.M))
for body in re.findall(r'\benum\b[^{;]*\{([^}]*)\}', text):
    constants |= set(re.findall(r'(?:^|,)\s*(SGT_\w+)', body))
assert len(constants) > 50 and len(types) > 30, (len(constants), len(types))
program = ''.join(f'#include <sagitta/{h.name}>\n' for h in headers) + 'int main()\n{\n'
program += ''.join(f'    (void)sizeof({t});\n' for t in sorted(types))
program += ''.join(f'    (void)({c});\n' for c in sorted(constants)) + '}\n'
done = subprocess.run([*shlex.split(sys.argv[2]), '-fsyntax-only', '-x', 'c++', f'-I{include}', '-'],
                      input=program, text=True, capture_output=True)
sys.exit(done.stderr if done.returncode else 0)
