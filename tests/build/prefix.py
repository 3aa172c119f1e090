# SPDX-License-Identifier: MIT
"""A build, installed into a folder of its own, for the tests that look at it from outside."""
import os
import pathlib
import re
import shlex
import subprocess
import sys


def run(*command, fails=False, **more):
    """What it prints; its status has to be 0, or with `fails` anything else."""
    words = [str(word) for word in command]
    done = subprocess.run(words, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, **more)
    if bool(done.returncode) != fails:
        sys.exit(f'{shlex.join(words)}\n{done.stdout}\nexit status {done.returncode}')
    return done.stdout


def meson_command():
    """The words of the meson that runs this test, or of one in the PATH."""
    return shlex.split(os.environ.get('MESONINTROSPECT', 'meson introspect'))[:-1]


class Prefix:
    """The build installed below `folder`, which becomes the home of whom `environment` belongs to.

    It is in HOME/.local, as README.md has it, though the build was set up for another prefix: files that name
    paths (*.pc) name the new ones, all others have to find their way by themselves.
    """

    def __init__(self, build, folder):
        self.home = pathlib.Path(folder).resolve() / 'home'
        self.path = self.home / '.local'
        root = self.home.parent / 'root'
        run(*meson_command(), 'install', '-C', build, '--no-rebuild', '--quiet', '--destdir', root)
        [pc] = root.rglob('sagitta.pc')
        was = re.search(r'^prefix=(/.*)$', pc.read_text(), re.MULTILINE)[1]
        self.home.mkdir()
        (root / was.lstrip('/')).rename(self.path)
        [pc] = self.path.rglob('sagitta.pc')
        for file in pc.parent.glob('*.pc'):
            file.write_text(re.sub(r'^prefix=.*$', lambda _: f'prefix={self.path}', file.read_text(),
                                   flags=re.MULTILINE))
        self.libraries = pc.parents[1]
        self.geo = (pc.parent / 'sagitta-geo.pc').exists()  # where GeographicLib was found
        self.command = self.path / 'bin' / 'sagitta'        # where libyaml was found
        [glass] = (self.path / 'share').rglob('sagitta/glass')
        kept = {name: value for name, value in os.environ.items()
                if name not in ('CFLAGS', 'CXXFLAGS', 'LDFLAGS', 'DESTDIR')}
        self.environment = {**kept, 'HOME': str(self.home), 'PKG_CONFIG_PATH': str(pc.parent),
                            'LD_LIBRARY_PATH': str(self.libraries), 'SAGITTA_GLASS': str(glass),
                            'PATH': f'{self.path / "bin"}{os.pathsep}{os.environ["PATH"]}'}
        # What rustup and its like keep in the home that was.
        for name, folder in (('RUSTUP_HOME', '.rustup'), ('CARGO_HOME', '.cargo')):
            self.environment.setdefault(name, str(pathlib.Path.home() / folder))

    def without_shared(self):
        """As a package of static libraries alone has it."""
        for library in self.libraries.glob('libsagitta*.so*'):
            library.unlink()
