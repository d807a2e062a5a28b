// What can go wrong, as a value. No exception crosses an interface of todbench.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

namespace todbench {

/// The few kinds of failure that a caller treats differently; the command line maps them to its exit codes.
enum class ErrorCode {
  invalid_input,     ///< usage, configuration or input file is wrong
  not_found,         ///< device absent or cannot be opened (busy, access denied, wrong format)
  disconnected,      ///< device lost while in use
  integrity,         ///< too many frames unusable
  timeout,           ///< nothing came in time; the device may still be there
  calibration,       ///< calibration missing, invalid or contradicted by the measurement
  not_identifiable,  ///< what was asked for cannot be told from such data
  io,                ///< file or disk
  interrupted,       ///< stopped on request
  internal,          ///< a defect of the program
};

/// A failure in one sentence. The message grows outwards: "opening gige:X: setting PixelFormat=Mono16: access denied".
struct Error {
  ErrorCode code = ErrorCode::internal;
  std::string message;
};

/// A value, or why there is none.
template <typename T>
using Result = tl::expected<T, Error>;

/// Shorthand for the failing side of a Result.
[[nodiscard]] inline tl::unexpected<Error> fail(ErrorCode code, std::string message) {
  return tl::unexpected<Error>(Error{code, std::move(message)});
}

/// The same error, with what the caller was doing put in front.
[[nodiscard]] inline tl::unexpected<Error> fail(std::string_view doing, const Error& cause) {
  return tl::unexpected<Error>(Error{cause.code, std::string(doing) + ": " + cause.message});
}

}  // namespace todbench
