// SPDX-License-Identifier: GPL-3.0-or-later
// Light and dark theme.
#pragma once

#include <QColor>
#include <QPalette>
#include <QString>

#include "bench/report/drawing.h"

namespace todbench {

/// Theme of the window.
enum class Theme { light, dark };
/// Returns the palette of a theme.
[[nodiscard]] QPalette palette_of(Theme theme);
/// Returns the palette of check boxes. Their frames, which the style derives from the window colour, would be invisible
/// on a dark window.
[[nodiscard]] QPalette box_palette_of(Theme theme);
/// Colours of plots in the window: the tones of the report on the background of the theme.
struct PlotColours {
  QColor ground, ink, grid;
  QColor first, second, third, muted;
  [[nodiscard]] QColor of(PlotTone tone) const;
};
/// Returns the colours of plots in a theme.
[[nodiscard]] PlotColours plot_colours_of(Theme theme);
/// Returns the theme of the desktop, from its palette.
[[nodiscard]] Theme desktop_theme();
/// Returns the theme to which a palette belongs.
[[nodiscard]] Theme theme_of(const QPalette& palette);
/// Returns the style sheet for the parts that the palette does not affect.
[[nodiscard]] QString style_sheet(Theme theme);

}  // namespace todbench
