// Test pictures on a monitor of choice: stepped by the keyboard, or by the bench over standard input and output.
#pragma once

#include <QString>

namespace todbench {

/// Pictures of these kinds, separated by commas, as large as the screen, until escape. With `truth` the truth of each
/// is written into that folder, as by `todbench pattern`. The exit code; an error is a sentence on standard error.
[[nodiscard]] int show_patterns(const QString& kinds, const QString& screen, const QString& truth);

/// Shows what comes on standard input as arrays in the .npy format and answers each with what is on the screen then
/// (docs/modules.md); ends with the input. With `copy` every answer is in that file, too, before it is given. The exit
/// code.
[[nodiscard]] int show_pictures_of_input(const QString& screen, const QString& copy);

/// Whether there is a window system to show something on, as far as the environment says.
[[nodiscard]] bool has_screen();

}  // namespace todbench
