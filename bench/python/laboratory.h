// SPDX-License-Identifier: GPL-3.0-or-later
// Binding of the emulated laboratory for the Python module. Only laboratory.cpp depends on whether the build has the
// camera libraries.
#pragma once

#include <pybind11/pybind11.h>

namespace todbench {

/// Adds the laboratory to the module.
void add_laboratory(pybind11::module_& module);

}  // namespace todbench
