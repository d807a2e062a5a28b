// SPDX-License-Identifier: GPL-3.0-or-later
// Test pictures on a chosen monitor, selected with the keyboard or by the bench over standard input and output.
#pragma once

#include <QString>

namespace todbench {

/// Shows pictures of these kinds (separated by commas) at the size of the screen until the user presses escape. With
/// `truth`, writes the truth of each picture into that folder, like `todbench pattern`. Returns the exit code; errors
/// go to standard error.
[[nodiscard]] int show_patterns(const QString& kinds, const QString& screen, const QString& truth);

/// Reads arrays in .npy format from standard input, shows each, and writes the resulting screen content to standard
/// output (docs/reference/modules.md). Ends at the end of the input. With `copy`, writes each content to that file
/// first. Returns the exit code.
[[nodiscard]] int show_pictures_of_input(const QString& screen, const QString& copy);

/// Returns whether a window system is available, according to the environment.
[[nodiscard]] bool has_screen();

}  // namespace todbench
