#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The bill of materials (docs/sbom.py) says what a build links to: no more, no less.

    python3 tests/build/sbom.py BUILD PART=FILE...

What the files ask the loader for (readelf) is the witness.  And the bill has the members that SPDX 2.3 requires, no
identifier twice, no relation to what is not there.
"""
import pathlib
import re
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / 'docs'))
import sbom

LIBRARY = {'libyaml-0': 'libyaml', 'libcairo': 'cairo', 'libGeographicLib': 'GeographicLib', 'libgomp': 'OpenMP',
           'libomp': 'OpenMP', 'libmpi': 'MPI'}
OF_EACH_SYSTEM = {'libc', 'libm', 'libgcc_s', 'libstdc++', 'libpthread', 'ld-linux-x86-64', 'ld-linux-aarch64'}
DOCUMENT = {'spdxVersion', 'dataLicense', 'SPDXID', 'name', 'documentNamespace', 'creationInfo'}
PACKAGE = {'SPDXID', 'name', 'downloadLocation', 'licenseConcluded', 'licenseDeclared', 'copyrightText'}


def needed(path):
    text = subprocess.run(['readelf', '-d', path], capture_output=True, text=True, check=True).stdout
    return {name for name in re.findall(r'NEEDED.*\[(.+?)\.so', text)
            if name not in OF_EACH_SYSTEM and not name.startswith('libsagitta')}


def main(build, *files):
    bill = sbom.bill(build)
    assert DOCUMENT <= set(bill), DOCUMENT - set(bill)
    for package in bill['packages']:
        assert PACKAGE <= set(package), package
    known = [one['SPDXID'] for one in bill['packages'] + bill['files']] + ['SPDXRef-DOCUMENT']
    assert len(known) == len(set(known)) and all(re.fullmatch(r'SPDXRef-[A-Za-z0-9.-]+', one) for one in known)
    for link in bill['relationships']:
        assert link['spdxElementId'] in known and link['relatedSpdxElement'] in known, link
    name = {one['SPDXID']: one['name'] for one in bill['packages']}
    parts = 0
    for part, path in (one.split('=', 1) for one in files):
        said = {name[link['relatedSpdxElement']] for link in bill['relationships']
                if link['relationshipType'] == 'DEPENDS_ON' and link['spdxElementId'] == 'SPDXRef-' + part.replace('_', '-')}
        true = {LIBRARY.get(one, one) for one in needed(path)}
        assert said == true, f'{part}: the bill has {sorted(said)}, the file {sorted(true)}'
        parts += 1
    assert parts == len(sbom.PARTS), f'{parts} of {len(sbom.PARTS)} parts were given'
    print(f'{len(bill["files"])} files, {len(bill["packages"])} packages, {parts} parts as they are linked')


main(*sys.argv[1:])
