// SPDX-License-Identifier: GPL-3.0-or-later
// Test pictures on a chosen monitor, selected with the keyboard or by the bench over standard input and output.
#pragma once

#include <QString>

namespace todbench {

/// Shows pictures of these kinds (separated by commas), as large as the screen, until escape. With `truth`, writes the
/// truth of each picture into that folder, like `todbench pattern`. Returns the exit code; errors go to standard error.
[[nodiscard]] int show_patterns(const QString& kinds, const QString& screen, const QString& truth);

/// Shows arrays in .npy format from standard input and returns the resulting screen content of each on standard output
/// (docs/reference/modules.md); ends with the input. With `copy`, writes each content to that file first. Returns the
/// exit code.
[[nodiscard]] int show_pictures_of_input(const QString& screen, const QString& copy);

/// Returns whether a window system is available, according to the environment.
[[nodiscard]] bool has_screen();

}  // namespace todbench
