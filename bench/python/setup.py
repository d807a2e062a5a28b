# SPDX-License-Identifier: GPL-3.0-or-later
"""The package todbench: CMake compiles the module and what it needs, without window, tests and benchmarks."""
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path.cwd()


class CMakeBuild(build_ext):
    """Compiles into TODBENCH_PYTHON_BUILD, by default build/python, where the next installation finds it."""

    def build_extension(self, ext):
        build = Path(os.environ.get("TODBENCH_PYTHON_BUILD", ROOT / "build" / "python")).resolve()
        target = Path(self.get_ext_fullpath(ext.name)).parent.parent.resolve()
        options = {
            "CMAKE_BUILD_TYPE": "Release",
            "BUILD_TESTING": "OFF",
            "TODBENCH_WITH_GUI": "OFF",
            "TODBENCH_BENCHMARKS": "OFF",
            "TODBENCH_WITH_PYTHON": "ON",
            "Python_EXECUTABLE": sys.executable,
            "TODBENCH_PYTHON_INSTALL_DIR": ".",
        }
        ninja = ["-G", "Ninja"] if not (build / "CMakeCache.txt").exists() else []
        subprocess.run(["cmake", "-S", ROOT, "-B", build, *ninja, *(f"-D{name}={value}" for name, value in options.items()),
                        *os.environ.get("CMAKE_ARGS", "").split()], check=True)
        subprocess.run(["cmake", "--build", build, "--target", "todbench_python"], check=True)
        subprocess.run(["cmake", "--install", build, "--component", "python", "--prefix", target], check=True)
        # The wheel has metadata of its own.
        for left in [target / "share", *target.glob("todbench-*.egg-info")]:
            shutil.rmtree(left, ignore_errors=True)


version = re.search(r"project\(todbench VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text()).group(1)
(ROOT / "build").mkdir(exist_ok=True)
# What setuptools writes beside the wheel goes where the build is.
options = {"egg_info": {"egg_base": "build"}, "build": {"build_base": "build/python-package"}}
setup(version=version, options=options, packages=["todbench"], package_dir={"todbench": "bench/python/todbench"},
      package_data={"todbench": ["py.typed"]}, ext_modules=[Extension("todbench._core", sources=[])], cmdclass={"build_ext": CMakeBuild})
