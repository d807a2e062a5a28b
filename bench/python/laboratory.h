// SPDX-License-Identifier: GPL-3.0-or-later
// Emulated laboratory in the Python module. Only its source file is compiled with the flags of the camera libraries.
#pragma once

#include <pybind11/pybind11.h>

namespace todbench {

/// Adds the laboratory to the module.
void add_laboratory(pybind11::module_& module);

}  // namespace todbench
