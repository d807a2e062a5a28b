# SPDX-License-Identifier: GPL-3.0-or-later
"""Build backend of pyproject.toml: setuptools, with its script in this folder instead of the root."""
from setuptools import build_meta


class Backend(build_meta._BuildMetaBackend):
    def run_setup(self, setup_script="setup.py"):
        super().run_setup("bench/python/setup.py")


backend = Backend()
build_wheel = backend.build_wheel
build_sdist = backend.build_sdist
get_requires_for_build_wheel = backend.get_requires_for_build_wheel
get_requires_for_build_sdist = backend.get_requires_for_build_sdist
prepare_metadata_for_build_wheel = backend.prepare_metadata_for_build_wheel
