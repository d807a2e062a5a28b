# SPDX-License-Identifier: GPL-3.0-or-later
"""Thermal cameras measured by a model observer: observers, simulated sensors, plates, fits, measures, plans, sessions and cameras.

Numbers are those of the program todbench, bit for bit: both use the same libraries. Pictures are numpy arrays that share their pixels with
the libraries and are read only. Failures raise todbench.Error with `code` and `key`. Calls that take long release the lock of Python.
"""
from . import _core
from ._core import *  # noqa: F401,F403
from ._core import __commit__, __version__  # noqa: F401

__all__ = [name for name in dir(_core) if not name.startswith("_")]
