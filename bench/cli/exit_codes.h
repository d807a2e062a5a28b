// SPDX-License-Identifier: GPL-3.0-or-later
// Meaning of the exit codes in a few words, for the manual and the footer of every help text.
#pragma once

#include <array>
#include <string_view>

namespace todbench {

/// Exit code with its meaning.
struct ExitCodeMeaning {
  int code;
  std::string_view words;
};

inline constexpr std::array exit_code_meanings{
    ExitCodeMeaning{0, "all limits met"},        ExitCodeMeaning{1, "limit not met"},
    ExitCodeMeaning{2, "wrong usage or input"},  ExitCodeMeaning{3, "inconclusive"},
    ExitCodeMeaning{4, "device absent or busy"}, ExitCodeMeaning{5, "device lost or bad frames"},
    ExitCodeMeaning{6, "invalid calibration"},   ExitCodeMeaning{7, "internal error or full disk"},
    ExitCodeMeaning{130, "interrupted"},
};

}  // namespace todbench
