// SPDX-License-Identifier: GPL-3.0-or-later
// Inner loops compiled for several instruction sets, selected at program start. Use it only for loops whose result does
// not depend on the selection. Disabled with sanitizers, because they run before the selection. Disabled on all
// compilers and processors but GCC on x86-64, because only GCC combines the attribute with this build.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(TODBENCH_SANITIZED)
#define TODBENCH_MULTIVERSION __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define TODBENCH_MULTIVERSION
#endif
