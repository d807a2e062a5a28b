// SPDX-License-Identifier: GPL-3.0-or-later
// Inner loops compiled for several instruction sets, selected at program start. Use it only for loops whose result does
// not depend on the selection. Enabled only with GCC on x86-64: with other compilers the attribute does not work in
// this build. Disabled with sanitizers: the selection runs before a sanitizer is initialised.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(TODBENCH_SANITIZED)
#define TODBENCH_MULTIVERSION __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define TODBENCH_MULTIVERSION
#endif
