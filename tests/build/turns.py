#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""turns.py - turns of phrase that a reader stumbles over, in the public headers and in docs.

    python3 turns.py [TREE] [--list]

"is told", "tells", "has a say", "so many", "but for", "besides", "is no X" and ", too" are right now and then.
More than one in a thousand words reads like a translation: libdeflate.h and geodesic.h have none.  --list shows
each with its line.  Quoted runs and code do not count.
"""
import pathlib
import re
import sys

MOST = 1.0  # in a thousand words
PLAIN = 'more|longer|one|less|greater|better|worse|other|such|need'  # "is no longer" is plain English
TURNS = re.compile(r'\b(?:besides|(?:is|are|was) told|tells|ha(?:s|ve) a say|so many|but for'
                   rf'|is no (?!(?:{PLAIN})\b)[a-z]+)\b|, too\b', re.IGNORECASE)
CODE = re.compile(r'^```.*?^```', re.DOTALL | re.MULTILINE)


def main(arguments):
    listed = '--list' in arguments
    paths = [a for a in arguments if a != '--list']
    tree = pathlib.Path(paths[0]) if paths else pathlib.Path(__file__).resolve().parents[2]
    groups = {'headers': sorted((tree / 'include' / 'sagitta').glob('*.h*')),
              'docs': [*sorted((tree / 'docs').rglob('*.md')), *(tree / f'{n}.md' for n in
                                                                ('README', 'CONTRIBUTING', 'NEWS'))]}
    bad = 0
    for name, files in groups.items():
        words = turns = 0
        for path in files:
            text = CODE.sub(lambda m: re.sub(r'[^\n]', ' ', m[0]), path.read_text())
            words += len(text.split())
            for m in TURNS.finditer(text):
                turns += 1
                if listed:
                    line = text.count('\n', 0, m.start())
                    print(f'{path.relative_to(tree)}:{line + 1}: {text.splitlines()[line].strip()}')
        rate = 1000 * turns / words
        bad += rate > MOST
        print(f'{name}: {turns} turns in {words} words, {rate:.2f} in a thousand; {MOST:g} at most')
    return 1 if bad else 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
