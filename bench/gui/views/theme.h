// SPDX-License-Identifier: GPL-3.0-or-later
// Light and dark theme.
#pragma once

#include <QColor>
#include <QPalette>
#include <QString>

#include "bench/report/drawing.h"

namespace todbench {

enum class Theme { light, dark };
[[nodiscard]] QPalette palette_of(Theme theme);
/// Palette of check boxes: their frames, which the style derives from the window, would be invisible on a dark one.
[[nodiscard]] QPalette box_palette_of(Theme theme);
/// Colours of plots in the window: the tones of the report on the background of the theme.
struct PlotColours {
  QColor ground, ink, grid;
  QColor first, second, third, muted;
  [[nodiscard]] QColor of(PlotTone tone) const;
};
[[nodiscard]] PlotColours plot_colours_of(Theme theme);
/// Returns the theme of the desktop, from its palette.
[[nodiscard]] Theme desktop_theme();
/// The theme that a palette belongs to.
[[nodiscard]] Theme theme_of(const QPalette& palette);
/// Style sheet for the parts that the palette does not reach.
[[nodiscard]] QString style_sheet(Theme theme);

}  // namespace todbench
