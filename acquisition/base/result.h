// SPDX-License-Identifier: GPL-3.0-or-later
// Errors as values. No exception crosses an interface of todbench.
#pragma once

#include <cassert>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>

namespace todbench {

/// Kinds of failure that callers treat differently; the command line maps them to exit codes.
enum class ErrorCode {
  invalid_input,     ///< usage, configuration or input file is wrong
  not_found,         ///< device absent or cannot be opened (busy, access denied, wrong format)
  disconnected,      ///< device lost while in use
  integrity,         ///< too many frames unusable
  timeout,           ///< no answer in time; the device may still be there
  calibration,       ///< calibration missing, invalid or contradicted by the measurement
  not_identifiable,  ///< the data do not determine the requested quantity
  io,                ///< file or disk
  interrupted,       ///< stopped on request
  internal,          ///< a bug of the program
};

/// The subject of a failure. Forms and command lines can replace its name by the name that the user sees.
struct ErrorKey {
  std::string name;    ///< a key of a description with its section ("target.delta_t_k"), an option ("--seed") or a file
  std::string reason;  ///< the fault without the name: "expected a number above 0, found 0"
  bool operator==(const ErrorKey&) const = default;
};

/// A failure. Each caller adds its action before the message: "opening gige:X: setting PixelFormat=Mono16: access
/// denied". The message is for people; callers branch on `code` and read the subject from `key`.
struct Error {
  ErrorCode code = ErrorCode::internal;
  std::string message;
  std::optional<ErrorKey> key{};
};

/// A value or an error.
template <typename T>
using Result = tl::expected<T, Error>;

/// Returns the failing side of a Result.
[[nodiscard]] inline tl::unexpected<Error> fail(ErrorCode code, std::string message) {
  return tl::unexpected<Error>(Error{code, std::move(message)});
}

/// Returns the failing side of a Result with `name` as subject: "NAME: REASON".
[[nodiscard]] inline tl::unexpected<Error> fail_at(ErrorCode code, std::string name, std::string reason) {
  std::string message = name + ": " + reason;
  return tl::unexpected<Error>(Error{code, std::move(message), ErrorKey{std::move(name), std::move(reason)}});
}

/// Returns the same error with the caller's action before the message. The subject does not change.
[[nodiscard]] inline Error with_context(std::string_view doing, const Error& cause) {
  return {cause.code, std::string(doing) + ": " + cause.message, cause.key};
}

/// Returns with_context() as the failing side of a Result.
[[nodiscard]] inline tl::unexpected<Error> fail(std::string_view doing, const Error& cause) {
  return tl::unexpected<Error>(with_context(doing, cause));
}

/// Returns the same error with its subject renamed to the user's term: "NAME: REASON". Precondition: the error has a
/// key.
[[nodiscard]] inline Error renamed(const Error& cause, std::string name) {
  assert(cause.key);
  std::string message = name + ": " + cause.key->reason;
  return {cause.code, std::move(message), ErrorKey{std::move(name), cause.key->reason}};
}

/// Returns the same error with a different code, for a caller that interprets the error differently.
[[nodiscard]] inline Error with_code(ErrorCode code, Error cause) {
  cause.code = code;
  return cause;
}

}  // namespace todbench
