#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The bill of materials of a build, as SPDX 2.3 in JSON: what sagitta is made of, and what it links to.

    python3 docs/sbom.py build > sagitta.spdx.json

Of the sources: each file that git knows (or that is in the folder of an archive), with its SHA-1 and SHA-256; two
licences are in them, MIT and that of the table of glasses.  Of the build: the dependencies that meson found and linked
into what is installed, with their versions, and what depends on each.  The date is SOURCE_DATE_EPOCH or that of the
commit, and the name of the document is made of the sources: two runs give the same bytes.
"""
import datetime
import hashlib
import json
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
GLASSES = {'data/glass/glasses.csv': 'CC0-1.0'}
# What meson calls it: its name, licence, and what of sagitta links to it.
LINKED = {
    'yaml-0.1': ('libyaml', 'MIT', ['sagitta_lens', 'sagitta_python']),
    'cairo-svg': ('cairo', 'LGPL-2.1-only OR MPL-1.1', ['sagitta-command', 'sagitta-mpi']),
    'geographiclib': ('GeographicLib', 'MIT', ['sagitta_geo', 'sagitta_python']),
    'openmp': ('OpenMP', 'NOASSERTION', ['sagitta-command', 'sagitta-mpi']),
    'ompi-c': ('MPI', 'NOASSERTION', ['sagitta-mpi']),
}
PARTS = {'sagitta_core': 'libsagitta', 'sagitta_lens': 'libsagitta_lens', 'sagitta_geo': 'libsagitta_geo',
         'sagitta_python': 'the package for Python', 'sagitta-command': 'the command sagitta',
         'sagitta-mpi': 'the command sagitta-mpi'}


def git(*words):
    return subprocess.run(['git', '-C', ROOT, *words], capture_output=True, text=True, check=True).stdout


def sources():
    try:
        return sorted(git('ls-files').split('\n')[:-1])
    except (OSError, subprocess.CalledProcessError):  # an archive
        return sorted(str(path.relative_to(ROOT)) for path in ROOT.rglob('*')
                      if path.is_file() and not str(path.relative_to(ROOT)).startswith(('build', '.')))


def written():
    seconds = os.environ.get('SOURCE_DATE_EPOCH')
    try:
        seconds = seconds or git('log', '-1', '--format=%ct')
    except (OSError, subprocess.CalledProcessError):
        seconds = 0
    return datetime.datetime.fromtimestamp(int(seconds), datetime.timezone.utc).strftime('%Y-%m-%dT%H:%M:%SZ')


def introspected(build, what):
    return json.loads((pathlib.Path(build) / 'meson-info' / f'intro-{what}.json').read_text())


def package(name, said, version, licence, **more):
    return {'SPDXID': f'SPDXRef-{name.replace("_", "-")}', 'name': said, 'versionInfo': version,
            'downloadLocation': 'NOASSERTION', 'filesAnalyzed': False, 'licenseConcluded': licence,
            'licenseDeclared': licence, 'copyrightText': 'NOASSERTION', **more}


def bill(build):
    version = introspected(build, 'projectinfo')['version']
    found = {row['name']: row['version'] for row in introspected(build, 'dependencies')}
    files, digest = [], hashlib.sha256()
    for name in sources():
        content = (ROOT / name).read_bytes()
        digest.update(name.encode() + b'\0' + content)
        licence = GLASSES.get(name, 'MIT')
        files.append({'SPDXID': f'SPDXRef-File-{len(files) + 1}', 'fileName': './' + name,
                      'checksums': [{'algorithm': 'SHA1', 'checksumValue': hashlib.sha1(content).hexdigest()},
                                    {'algorithm': 'SHA256', 'checksumValue': hashlib.sha256(content).hexdigest()}],
                      'licenseConcluded': licence, 'licenseInfoInFiles': [licence], 'copyrightText': 'NOASSERTION'})
    packages = [package('sagitta', 'sagitta', version, 'MIT AND CC0-1.0', copyrightText='2026 The sagitta authors')]
    links = [{'spdxElementId': 'SPDXRef-DOCUMENT', 'relationshipType': 'DESCRIBES', 'relatedSpdxElement': 'SPDXRef-sagitta'}]

    def relate(one, how, other):
        links.append({'spdxElementId': f'SPDXRef-{one.replace("_", "-")}', 'relationshipType': how,
                      'relatedSpdxElement': f'SPDXRef-{other.replace("_", "-")}'})

    for file in files:
        relate('sagitta', 'CONTAINS', file['SPDXID'].removeprefix('SPDXRef-'))
    for name, said in PARTS.items():
        packages.append(package(name, said, version, 'MIT'))
        relate(name, 'GENERATED_FROM', 'sagitta')
    for name, (said, licence, users) in LINKED.items():
        if name in found:
            packages.append(package('linked-' + said, said, found[name], licence))
            for user in users:
                relate(user, 'DEPENDS_ON', 'linked-' + said)
    return {'spdxVersion': 'SPDX-2.3', 'dataLicense': 'CC0-1.0', 'SPDXID': 'SPDXRef-DOCUMENT',
            'name': f'sagitta-{version}', 'documentNamespace': f'urn:sha256:{digest.hexdigest()}',
            'creationInfo': {'created': written(), 'creators': ['Organization: The sagitta authors', 'Tool: docs/sbom.py']},
            'packages': packages, 'files': files, 'relationships': links}


if __name__ == '__main__':
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    json.dump(bill(sys.argv[1]), sys.stdout, indent=1)
    print()
