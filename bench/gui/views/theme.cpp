// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/views/theme.h"

#include <QGuiApplication>

#include "bench/gui/presenters/text_of.h"

namespace todbench {

QPalette palette_of(Theme theme) {
  const bool dark = theme == Theme::dark;
  const QColor window = dark ? QColor(43, 45, 49) : QColor(243, 244, 246);
  const QColor base = dark ? QColor(30, 31, 34) : QColor(255, 255, 255);
  const QColor text = dark ? QColor(230, 230, 230) : QColor(28, 28, 30);
  const QColor button = dark ? QColor(58, 61, 66) : QColor(232, 234, 238);
  const QColor disabled = dark ? QColor(130, 132, 136) : QColor(140, 142, 146);
  QPalette palette(text, button, button.lighter(dark ? 140 : 108), button.darker(dark ? 160 : 150), button.darker(120),
                   text, text, base, window);
  palette.setColor(QPalette::AlternateBase, dark ? QColor(36, 38, 42) : QColor(247, 248, 250));
  palette.setColor(QPalette::ToolTipBase, base);
  palette.setColor(QPalette::ToolTipText, text);
  palette.setColor(QPalette::PlaceholderText, disabled);
  palette.setColor(QPalette::Highlight, dark ? QColor(45, 110, 170) : QColor(0, 114, 178));
  palette.setColor(QPalette::HighlightedText, Qt::white);
  palette.setColor(QPalette::Link, dark ? QColor(86, 180, 233) : QColor(0, 114, 178));
  for (const auto role : {QPalette::Text, QPalette::WindowText, QPalette::ButtonText})
    palette.setColor(QPalette::Disabled, role, disabled);
  return palette;
}

QPalette box_palette_of(Theme theme) {
  QPalette palette = palette_of(theme);
  if (theme == Theme::dark) palette.setColor(QPalette::Base, QColor(84, 88, 96));
  return palette;
}

QColor PlotColours::of(PlotTone tone) const {
  switch (tone) {
    case PlotTone::first:
      return first;
    case PlotTone::second:
      return second;
    case PlotTone::third:
      return third;
    case PlotTone::muted:
      return muted;
  }
  return ink;
}

PlotColours plot_colours_of(Theme theme) {
  const bool dark = theme == Theme::dark;
  const DrawingPalette palette = dark ? dark_palette() : light_palette();
  const auto tone = [&](PlotTone which) { return QColor(text_of(palette.of(Ink::tone, which))); };
  return {.ground = dark ? QColor(30, 31, 34) : QColor(255, 255, 255),
          .ink = dark ? QColor(226, 226, 226) : QColor(32, 32, 32),
          .grid = dark ? QColor(66, 68, 74) : QColor(222, 222, 222),
          .first = tone(PlotTone::first),
          .second = tone(PlotTone::second),
          .third = tone(PlotTone::third),
          .muted = tone(PlotTone::muted)};
}

Theme theme_of(const QPalette& palette) {
  return palette.color(QPalette::Window).lightness() < 128 ? Theme::dark : Theme::light;
}

Theme desktop_theme() {
  return theme_of(QGuiApplication::palette());
}

QString style_sheet(Theme theme) {
  const bool dark = theme == Theme::dark;
  return QString(R"(
    QListWidget#navigation { border: 0; background: %1; outline: 0; padding-top: 6px; }
    QListWidget#navigation::item { padding: 9px 10px; border: 0; color: %8; }
    QListWidget#navigation::item:selected { background: %2; color: white; }
    QFrame#messageBar { background: %3; border: 1px solid %4; border-radius: 3px; }
    QFrame#messageBar QLabel { color: %5; }
    QLabel[role="title"] { font-size: 15px; font-weight: bold; }
    QLabel[role="verdict"] { font-weight: bold; }
    QLabel[role="hint"] { color: %6; }
    QLabel[role="problem"] { color: %9; }
    *[idle="true"] { color: %6; }
    QToolButton[role="fold"] { font-weight: bold; border: 0; }
    QLabel[role="step"] { font-size: 24px; font-weight: bold; }
    QPushButton[role="primary"] { background: %2; color: white; padding: 5px 14px; border: 0; border-radius: 3px; }
    QPushButton[role="primary"]:disabled { background: %7; }
    QPushButton[role="primary"]:focus { border: 2px solid %5; }
  )")
      .arg(dark ? "#232529" : "#e6e8ec", dark ? "#2d6eaa" : "#0072b2", dark ? "#4a3420" : "#fdf0dc",
           dark ? "#b5702a" : "#d55e00", dark ? "#f2e6d8" : "#402000", dark ? "#b0b3b8" : "#55585e",
           dark ? "#55585e" : "#a8abb0", dark ? "#e6e6e6" : "#1c1c1e", dark ? "#ff9a7a" : "#a83800");
}

}  // namespace todbench
