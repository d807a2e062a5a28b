// SPDX-License-Identifier: GPL-3.0-or-later
// Failures of the target, as distinct from failures of the camera.
#pragma once

#include <string_view>

#include "acquisition/base/result.h"

namespace todbench {

/// Subject of a failure of the target. The keys of section [target] of the plan begin with this word.
inline constexpr std::string_view target_subject = "target";

/// Returns the error "DOING: CAUSE". Its subject is that of the cause, or the target if the cause has no subject.
[[nodiscard]] inline tl::unexpected<Error> target_failure(std::string_view doing, const Error& cause) {
  Error error = with_context(doing, cause);
  if (!error.key) error.key = ErrorKey{std::string(target_subject), cause.message};
  return tl::unexpected<Error>(std::move(error));
}

/// Returns whether the subject of a failure is the target and not the camera.
[[nodiscard]] inline bool is_target_failure(const Error& error) {
  return error.key && std::string_view(error.key->name).starts_with(target_subject);
}

}  // namespace todbench
