// SPDX-License-Identifier: GPL-3.0-or-later
// Macros that evaluate a Result and return its error to the caller.
#pragma once

#include <utility>

#include "acquisition/base/result.h"

#define TODBENCH_TRY_JOIN_(a, b) a##b
#define TODBENCH_TRY_NAME_(line) TODBENCH_TRY_JOIN_(todbench_try_, line)
#define TODBENCH_TRY_(result, target, ...)                                            \
  auto result = (__VA_ARGS__);                                                        \
  if (!(result)) return tl::unexpected<::todbench::Error>(std::move(result).error()); \
  target = *std::move(result)

/// Evaluates an expression of type Result<T>. On an error, the surrounding function returns this error. Otherwise the
/// value initializes `target` or is assigned to it:
///   TODBENCH_TRY(const auto text, read_text_file(file));
///   TODBENCH_TRY(session.plan, load_plan(file));
/// Expands to three statements: do not use it as the body of an `if` without braces, and write at most one on a line.
#define TODBENCH_TRY(target, ...) TODBENCH_TRY_(TODBENCH_TRY_NAME_(__LINE__), target, __VA_ARGS__)

#define TODBENCH_TRY_VOID_(result, ...)                                                 \
  do {                                                                                  \
    auto result = (__VA_ARGS__);                                                        \
    if (!(result)) return tl::unexpected<::todbench::Error>(std::move(result).error()); \
  } while (false)

/// Evaluates an expression of type Result<void>, or one whose value is not needed. On an error, the surrounding
/// function returns this error. One statement:
///   TODBENCH_TRY_VOID(validate(plan));
#define TODBENCH_TRY_VOID(...) TODBENCH_TRY_VOID_(TODBENCH_TRY_NAME_(__LINE__), __VA_ARGS__)
