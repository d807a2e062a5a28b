// SPDX-License-Identifier: GPL-3.0-or-later
// Makes text from cameras, instruments, files and networks safe to display. The text then cannot move the cursor, clear
// the screen or change the direction of writing.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace todbench {

/// Maximum characters of one_line().
inline constexpr std::size_t longest_shown_line = 4000;

/// Returns valid UTF-8. U+FFFD replaces three kinds of text: invalid bytes; control characters (C0 except tab and line
/// ends, DEL, C1); and characters that change the direction or the line of the surrounding text (Unicode 15, annex 9:
/// marks, embeddings, overrides, isolates; line and paragraph separators).
[[nodiscard]] std::string valid_text(std::string_view text);
/// Returns valid_text() on one line: C0 and DEL become blanks. A text of more than `longest` characters ends in an
/// ellipsis.
[[nodiscard]] std::string one_line(std::string_view text, std::size_t longest = longest_shown_line);
/// Returns the JSON text with \u escapes in place of the characters that valid_text() replaces. In JSON text these
/// characters occur only inside strings.
[[nodiscard]] std::string escaped_json(std::string_view json);
/// Returns the text with the letters A to Z in lower case, in every locale.
[[nodiscard]] std::string lower_case(std::string_view text);

}  // namespace todbench
