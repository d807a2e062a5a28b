// Text of cameras, instruments, files and networks, made fit to be shown: whoever wrote it moves no cursor, clears no
// screen and turns no line round.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace todbench {

/// Characters of one_line() at most.
inline constexpr std::size_t longest_shown_line = 4000;

/// Valid UTF-8: bytes that are none, control characters (C0 but tab and line ends, DEL, C1) and characters that change
/// the direction or the line of the text around them (Unicode 15, annex 9: marks, embeddings, overrides, isolates; line
/// and paragraph separators) become U+FFFD.
[[nodiscard]] std::string valid_text(std::string_view text);
/// valid_text() on one line: C0 and DEL as blanks, the end of a text of more than `longest` characters as an ellipsis.
[[nodiscard]] std::string one_line(std::string_view text, std::size_t longest = longest_shown_line);
/// Finished JSON with the characters that valid_text() replaces as \u escapes. They occur within its strings only.
[[nodiscard]] std::string escaped_json(std::string_view json);

}  // namespace todbench
