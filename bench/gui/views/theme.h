// Light and dark.
#pragma once

#include <QColor>
#include <QPalette>
#include <QString>

#include "bench/report/drawing.h"

namespace todbench {

enum class Theme { light, dark };
[[nodiscard]] QPalette palette_of(Theme theme);
/// Of check boxes, whose frames the style derives from the window: on a dark one they would not be seen.
[[nodiscard]] QPalette box_palette_of(Theme theme);
/// Colours of the plots of a window: the tones of the report on a ground of the theme.
struct PlotColours {
  QColor ground, ink, grid;
  QColor first, second, third, muted;
  [[nodiscard]] QColor of(PlotTone tone) const;
};
[[nodiscard]] PlotColours plot_colours_of(Theme theme);
/// What the desktop prefers, as its palette tells.
[[nodiscard]] Theme desktop_theme();
/// The theme that a palette belongs to.
[[nodiscard]] Theme theme_of(const QPalette& palette);
/// Style sheet of the few things that the palette does not reach.
[[nodiscard]] QString style_sheet(Theme theme);

}  // namespace todbench
