// SPDX-License-Identifier: GPL-3.0-or-later
// A mathematical library that is wrong by one in a million, to be loaded before the right one.
#include <dlfcn.h>

extern "C" double erfc(double x) {
  static const auto right = reinterpret_cast<double (*)(double)>(::dlsym(RTLD_NEXT, "erfc"));
  return right(x) * (1 + 1e-6);
}
