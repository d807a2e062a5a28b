// A drawing as a value: lines, areas and text in units of its own, with what each means. svg.h writes it as text, the
// window paints it.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace todbench {

/// Colours of the palette by Okabe and Ito 2008, which colour-blind readers tell apart; each has a light and a dark
/// shade. Marker and line differ too, so that a black-and-white print is readable.
enum class PlotTone { first, second, third, muted };

/// Units to the right and down.
struct Place {
  double x = 0, y = 0;
};
struct Segment {
  Place from, to;
};
/// Lines through places; a new run begins where the line is interrupted.
struct Polyline {
  std::vector<std::vector<Place>> runs;
};
struct Box {
  double x = 0, y = 0, width = 0, height = 0;
};
struct Disc {
  Place centre;
  double radius = 0;
};

/// A picture of pixels, stretched over a place.
struct Raster {
  Box place;
  std::string png_base64;  ///< a PNG file; is_base64() holds
};

/// What a mark is for; style_of() says how that looks.
enum class Pen { frame, grid, axis, reference, curve, dashed, dotted, bar, marker, hollow, limit, band };

struct Mark {
  std::variant<Segment, Polyline, Box, Disc, Raster> shape;
  Pen pen = Pen::axis;
  PlotTone tone = PlotTone::first;  ///< where style_of(pen) takes the colour of the tone
};

enum class LabelRole { x_tick, y_tick, x_axis, y_axis, note, legend };

/// One line of text; `at` is on its base line, at the anchor of its role. The label of a y axis reads upwards.
struct Label {
  Place at;
  std::string text;
  LabelRole role = LabelRole::legend;
};

struct Drawing {
  std::string id;           ///< unique on the page; letters, digits, hyphens
  std::string title;        ///< for screen readers
  std::string description;  ///< for screen readers: what can be seen
  double width = 0, height = 0;
  Box frame;                  ///< drawn first
  std::vector<Mark> inside;   ///< what the frame clips, in the order of painting
  std::vector<Mark> marks;    ///< over it
  std::vector<Label> labels;  ///< over both
};

enum class Ink { none, ground, ink, grid, muted, tone };

struct PenStyle {
  std::string_view name;  ///< of its CSS class
  Ink stroke = Ink::none;
  double width = 0;
  std::array<double, 2> dash{0, 0};  ///< drawn and left out; 0: solid
  Ink fill = Ink::none;
  double fill_opacity = 1;
};
[[nodiscard]] PenStyle style_of(Pen pen);
inline constexpr std::array all_pens{Pen::frame,  Pen::grid, Pen::axis,   Pen::reference, Pen::curve, Pen::dashed,
                                     Pen::dotted, Pen::bar,  Pen::marker, Pen::hollow,    Pen::limit, Pen::band};

enum class Anchor { start, middle, end };
struct LabelStyle {
  std::string_view name;  ///< of its CSS class
  Anchor anchor = Anchor::start;
  double size = 13;
  Ink ink = Ink::ink;
  double halo = 0;  ///< of ground round the letters, half of it outside
};
[[nodiscard]] LabelStyle style_of(LabelRole role);
inline constexpr std::array all_label_roles{LabelRole::x_tick, LabelRole::y_tick, LabelRole::x_axis,
                                            LabelRole::y_axis, LabelRole::note,   LabelRole::legend};

/// Colours as #rrggbb. Every text and line has a contrast of at least 4.5 and 3 to 1 against the ground (WCAG 2.1),
/// except the grid, which is decoration.
struct DrawingPalette {
  std::string_view ground, ink, grid, muted;
  std::array<std::string_view, 4> tones;  ///< by PlotTone

  /// Empty for Ink::none.
  [[nodiscard]] std::string_view of(Ink ink, PlotTone tone) const;
};
/// For paper and light pages, and for dark ones.
[[nodiscard]] DrawingPalette light_palette();
[[nodiscard]] DrawingPalette dark_palette();

}  // namespace todbench
