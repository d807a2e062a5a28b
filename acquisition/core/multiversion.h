// Inner loops compiled for several instruction sets, chosen at program start. Only for loops whose result does not
// depend on the choice. Sanitizers run before the choice can be made, and only GCC on x86-64 combines the attribute
// with this build.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(TODBENCH_SANITIZED)
#define TODBENCH_MULTIVERSION __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define TODBENCH_MULTIVERSION
#endif
