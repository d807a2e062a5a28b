// What the exit codes mean, in a few words: the manual has a line for each, the footer of every help the same text.
#pragma once

#include <array>
#include <string_view>

namespace todbench {

struct ExitCodeMeaning {
  int code;
  std::string_view words;
};

inline constexpr std::array exit_code_meanings{
    ExitCodeMeaning{0, "done, every limit met"}, ExitCodeMeaning{1, "a limit is missed"},
    ExitCodeMeaning{2, "usage or input"},        ExitCodeMeaning{3, "inconclusive"},
    ExitCodeMeaning{4, "device absent or busy"}, ExitCodeMeaning{5, "device lost or frames unusable"},
    ExitCodeMeaning{6, "calibration"},           ExitCodeMeaning{7, "internal error or full disk"},
    ExitCodeMeaning{130, "interrupted"},
};

}  // namespace todbench
