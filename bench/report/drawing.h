// SPDX-License-Identifier: GPL-3.0-or-later
// Drawing as a value: lines, areas and text with their roles, in units of the drawing. svg.h writes a drawing as text,
// and the window paints it.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace todbench {

/// Colours of the palette of Okabe and Ito (2008), which colour-blind readers can distinguish; each has a light and a
/// dark shade. Markers and lines also differ, so that a black-and-white print is readable.
enum class PlotTone { first, second, third, muted };

/// Position in units of the drawing: x to the right, y downwards.
struct Place {
  double x = 0, y = 0;
};
/// Straight line.
struct Segment {
  Place from, to;
};
/// Lines through positions; each run is continuous.
struct Polyline {
  std::vector<std::vector<Place>> runs;
};
/// Rectangle.
struct Box {
  double x = 0, y = 0, width = 0, height = 0;
};
/// Filled circle.
struct Disc {
  Place centre;
  double radius = 0;
};

/// Picture of pixels, scaled to a box.
struct Raster {
  Box place;
  std::string png_base64;  ///< PNG file as base64, for which is_base64() is true
};

/// Role of a mark; style_of() returns its appearance.
enum class Pen { frame, grid, axis, reference, curve, dashed, dotted, bar, marker, hollow, limit, band };

/// Shape with its role and tone.
struct Mark {
  std::variant<Segment, Polyline, Box, Disc, Raster> shape;
  Pen pen = Pen::axis;
  PlotTone tone = PlotTone::first;  ///< used if style_of(pen) takes the colour of the tone
};

/// Role of a text; style_of() returns its appearance.
enum class LabelRole { x_tick, y_tick, x_axis, y_axis, note, legend };

/// One line of text. `at` is the anchor of its role on the baseline. The label of a y axis reads upwards.
struct Label {
  Place at;
  std::string text;
  LabelRole role = LabelRole::legend;
};

/// Content of a drawing.
struct Drawing {
  std::string id;           ///< unique on the page; letters, digits, hyphens
  std::string title;        ///< for screen readers
  std::string description;  ///< description of the visible content, for screen readers
  double width = 0, height = 0;
  Box frame;                  ///< drawn first
  std::vector<Mark> inside;   ///< clipped by the frame, in the order of painting
  std::vector<Mark> marks;    ///< painted over `inside`
  std::vector<Label> labels;  ///< painted over both
};

/// Colour by its role; DrawingPalette::of() returns it.
enum class Ink { none, ground, ink, grid, muted, tone };

/// Appearance of a mark.
struct PenStyle {
  std::string_view name;  ///< CSS class
  Ink stroke = Ink::none;
  double width = 0;
  std::array<double, 2> dash{0, 0};  ///< dash and gap; 0: solid
  Ink fill = Ink::none;
  double fill_opacity = 1;
};
/// Returns the appearance of marks with this role.
[[nodiscard]] PenStyle style_of(Pen pen);
inline constexpr std::array all_pens{Pen::frame,  Pen::grid, Pen::axis,   Pen::reference, Pen::curve, Pen::dashed,
                                     Pen::dotted, Pen::bar,  Pen::marker, Pen::hollow,    Pen::limit, Pen::band};

/// Position of the anchor in the text.
enum class Anchor { start, middle, end };
/// Appearance of a label.
struct LabelStyle {
  std::string_view name;  ///< CSS class
  Anchor anchor = Anchor::start;
  double size = 13;
  Ink ink = Ink::ink;
  double halo = 0;  ///< outline in the background colour, half of it outside the letters
};
/// Returns the appearance of labels with this role.
[[nodiscard]] LabelStyle style_of(LabelRole role);
inline constexpr std::array all_label_roles{LabelRole::x_tick, LabelRole::y_tick, LabelRole::x_axis,
                                            LabelRole::y_axis, LabelRole::note,   LabelRole::legend};

/// Colours as #rrggbb. Text has a contrast of at least 4.5 to 1 against the ground, and lines of at least 3 to 1 (WCAG
/// 2.1). The grid is an exception, because it is decoration.
struct DrawingPalette {
  std::string_view ground, ink, grid, muted;
  std::array<std::string_view, 4> tones;  ///< by PlotTone

  /// Returns the colour; empty for Ink::none.
  [[nodiscard]] std::string_view of(Ink ink, PlotTone tone) const;
};
/// Return the palettes for paper and light pages, and for dark pages.
[[nodiscard]] DrawingPalette light_palette();
[[nodiscard]] DrawingPalette dark_palette();

}  // namespace todbench
