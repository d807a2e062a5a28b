// SPDX-License-Identifier: GPL-3.0-or-later
// The emulated laboratory in the Python module. Its unit alone is compiled with the flags of the camera libraries.
#pragma once

#include <pybind11/pybind11.h>

namespace todbench {

void add_laboratory(pybind11::module_& module);

}  // namespace todbench
