#include "bench/report/svg_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>

#include "bench/report/number_format.h"

namespace todbench {
namespace {

// Lengths in user units. Text is 13 units high and, in the fonts of the style, at most 0.62 of that wide per character
// on average.
constexpr double character_width = 0.58 * 13;
constexpr double margin_top = 14, margin_right = 18, margin_left = 66;
constexpr double below_axis = 50;  // tick labels and axis label
constexpr double legend_row = 22, legend_swatch = 34, legend_gap = 22;
constexpr double marker_radius = 4.2, cap = 5, arrow = 7;
constexpr double x_label_spacing = 62, y_label_spacing = 34;

std::string at(double coordinate) {
  return fixed(coordinate, 2);
}

std::string joined(std::initializer_list<std::string_view> parts) {
  std::string text;
  for (const std::string_view part : parts) text.append(part);
  return text;
}

std::string number_attribute(std::string_view name, double value) {
  return joined({" ", name, "=\"", at(value), "\""});
}

Markup empty_element(std::string_view tag, const std::string& attributes) {
  return Markup{joined({"<", tag, attributes, "/>\n"})};
}

Markup line_element(std::string_view css, double x1, double y1, double x2, double y2) {
  return empty_element("line", " class=\"" + std::string(css) + "\"" + number_attribute("x1", x1) +
                                   number_attribute("y1", y1) + number_attribute("x2", x2) +
                                   number_attribute("y2", y2));
}

Markup text_element(std::string_view css, double x, double y, std::string_view text) {
  return element("text", escaped(text),
                 "class=\"" + std::string(css) + "\"" + number_attribute("x", x) + number_attribute("y", y)) +
         literal("\n");
}

std::string_view tone_class(PlotTone tone) {
  constexpr std::array<std::string_view, 4> names{"tone-a", "tone-b", "tone-c", "tone-m"};
  return names[static_cast<std::size_t>(tone)];
}

std::string_view line_class(PlotLine line) {
  constexpr std::array<std::string_view, 4> names{"", "curve", "curve dashed", "curve dotted"};
  return names[static_cast<std::size_t>(line)];
}

/// Characters, not bytes.
double text_width(std::string_view text) {
  return character_width * static_cast<double>(std::count_if(text.begin(), text.end(), [](char byte) {
           return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U;
         }));
}

struct LegendEntry {
  std::string label;
  const PlotSeries* series = nullptr;  ///< or, where null, a band
  PlotTone tone = PlotTone::first;
  double x = 0;
  int row = 0;
};

/// Entries side by side, a new row where the next would leave the picture.
std::vector<LegendEntry> legend_entries(const Plot& plot) {
  std::vector<LegendEntry> entries;
  for (auto series = plot.series.rbegin(); series != plot.series.rend(); ++series)
    if (!series->label.empty()) entries.push_back({series->label, &*series, series->tone, 0, 0});
  for (const PlotBand& band : plot.bands)
    if (!band.label.empty()) entries.push_back({band.label, nullptr, band.tone, 0, 0});
  double x = margin_left;
  int row = 0;
  for (LegendEntry& entry : entries) {
    const double width = legend_swatch + 6 + text_width(entry.label);
    if (x > margin_left && x + width > plot.width - margin_right / 2) {
      x = margin_left;
      ++row;
    }
    entry.x = x;
    entry.row = row;
    x += width + legend_gap;
  }
  return entries;
}

/// Draws one plot.
class Canvas {
 public:
  explicit Canvas(const Plot& plot) : plot_(plot), legend_(legend_entries(plot)) {
    const int rows = legend_.empty() ? 0 : legend_.back().row + 1;
    bottom_ = plot.height - below_axis - rows * legend_row;
    right_ = plot.width - margin_right;
  }

  [[nodiscard]] Markup draw() const {
    Markup inside;
    for (const PlotBand& band : plot_.bands) inside += draw_band(band);
    inside += draw_grid();
    for (const PlotReference& reference : plot_.references)
      inside += line_element("reference", margin_left, y(reference.y), right_, y(reference.y));
    for (const PlotSeries& series : plot_.series) inside += draw_line(series);
    Markup picture = draw_frame();
    picture += element("g", inside, "clip-path=\"url(#" + plot_.id + "-clip)\"") + literal("\n");
    for (const PlotSeries& series : plot_.series) picture += draw_points(series);
    for (const PlotReference& reference : plot_.references)
      if (inside_y(reference.y)) picture += text_element("note", right_ - 5, y(reference.y) - 5, reference.label);
    return picture + draw_ticks() + draw_legend();
  }

 private:
  static double fraction(const PlotAxis& axis, double value) {
    if (axis.scale == AxisScale::linear) return (value - axis.low) / (axis.high - axis.low);
    if (value <= 0) return -1;
    return std::log(value / axis.low) / std::log(axis.high / axis.low);
  }
  // Far outside is as good as just outside: no coordinate grows beyond what a renderer can hold.
  [[nodiscard]] double x(double value) const {
    return margin_left + std::clamp(fraction(plot_.x, value), -1.0, 2.0) * (right_ - margin_left);
  }
  [[nodiscard]] double y(double value) const {
    return bottom_ - std::clamp(fraction(plot_.y, value), -1.0, 2.0) * (bottom_ - margin_top);
  }
  static bool inside(const PlotAxis& axis, double value) {
    const double place = fraction(axis, value);
    return place >= -1e-9 && place <= 1 + 1e-9;
  }
  [[nodiscard]] bool inside_x(double value) const { return inside(plot_.x, value); }
  [[nodiscard]] bool inside_y(double value) const { return inside(plot_.y, value); }
  [[nodiscard]] std::vector<Tick> x_ticks() const {
    return axis_ticks(plot_.x, static_cast<int>((right_ - margin_left) / x_label_spacing));
  }
  [[nodiscard]] std::vector<Tick> y_ticks() const {
    return axis_ticks(plot_.y, static_cast<int>((bottom_ - margin_top) / y_label_spacing));
  }

  [[nodiscard]] Markup draw_frame() const {
    const std::string box = number_attribute("x", margin_left) + number_attribute("y", margin_top) +
                            number_attribute("width", right_ - margin_left) +
                            number_attribute("height", bottom_ - margin_top);
    return element("defs", element("clipPath", empty_element("rect", box), "id=\"" + plot_.id + "-clip\"")) +
           empty_element("rect", " class=\"frame\"" + box);
  }

  [[nodiscard]] Markup draw_grid() const {
    Markup grid;
    for (const Tick& tick : x_ticks())
      if (!tick.label.empty()) grid += line_element("grid", x(tick.value), margin_top, x(tick.value), bottom_);
    for (const Tick& tick : y_ticks())
      if (!tick.label.empty()) grid += line_element("grid", margin_left, y(tick.value), right_, y(tick.value));
    return grid;
  }

  [[nodiscard]] Markup draw_ticks() const {
    Markup ticks;
    for (const Tick& tick : x_ticks()) {
      const double length = tick.label.empty() ? 3 : 6;
      ticks += line_element("axis", x(tick.value), bottom_, x(tick.value), bottom_ + length);
      if (!tick.label.empty()) ticks += text_element("x-tick", x(tick.value), bottom_ + 20, tick.label);
    }
    for (const Tick& tick : y_ticks()) {
      const double length = tick.label.empty() ? 3 : 6;
      ticks += line_element("axis", margin_left - length, y(tick.value), margin_left, y(tick.value));
      if (!tick.label.empty()) ticks += text_element("y-tick", margin_left - 9, y(tick.value) + 4.5, tick.label);
    }
    ticks += text_element("axis-label", (margin_left + right_) / 2, bottom_ + 40, plot_.x.label);
    const double middle = (margin_top + bottom_) / 2;
    return ticks + element("text", escaped(plot_.y.label),
                           "class=\"axis-label\" transform=\"translate(16 " + at(middle) + ") rotate(-90)\"");
  }

  [[nodiscard]] Markup draw_band(const PlotBand& band) const {
    if (!band.x.low && !band.x.high) return {};
    const double from = band.x.low ? std::max(x(*band.x.low), margin_left) : margin_left;
    const double to = band.x.high ? std::min(x(*band.x.high), right_) : right_;
    if (!(to > from)) return {};
    return empty_element("rect", " class=\"band " + std::string(tone_class(band.tone)) + "\"" +
                                     number_attribute("x", from) + number_attribute("y", margin_top) +
                                     number_attribute("width", to - from) +
                                     number_attribute("height", bottom_ - margin_top));
  }

  [[nodiscard]] Markup draw_line(const PlotSeries& series) const {
    if (series.line == PlotLine::none) return {};
    std::string path;
    bool pen_down = false;
    for (const PlotPoint& point : series.points) {
      if (!point.x || !point.y || !std::isfinite(*point.x) || !std::isfinite(*point.y)) {
        pen_down = false;
        continue;
      }
      path += joined({pen_down ? "L" : "M", at(x(*point.x)), " ", at(y(*point.y) + series.dodge_px)});
      pen_down = true;
    }
    if (path.empty()) return {};
    return empty_element("path", " class=\"" + std::string(line_class(series.line)) + " " +
                                     std::string(tone_class(series.tone)) + "\" d=\"" + path + "\"");
  }

  [[nodiscard]] Markup draw_points(const PlotSeries& series) const {
    Markup shapes;
    for (const PlotPoint& point : series.points) {
      if (point.y && inside_y(*point.y)) shapes += draw_x_interval(point, series);
      if (point.x && inside_x(*point.x)) shapes += draw_y_interval(point, series);
    }
    for (const PlotPoint& point : series.points)
      if (point.x && point.y && inside_x(*point.x) && inside_y(*point.y))
        shapes += draw_marker(series.marker, x(*point.x), y(*point.y) + series.dodge_px);
    if (shapes.empty()) return {};
    return element("g", shapes, "class=\"" + std::string(tone_class(series.tone)) + "\"") + literal("\n");
  }

  /// An end of an interval: a cap where it is inside, an arrow where it is open or beyond the edge. `outward` is -1 or
  /// +1.
  static Markup interval_end(double along, double across, double outward, bool bounded, bool horizontal) {
    const auto place = [&](double a, double b) {
      return horizontal ? joined({at(a), " ", at(b)}) : joined({at(b), " ", at(a)});
    };
    const std::string cap_path = joined({"M", place(along, across - cap), "L", place(along, across + cap)});
    const double tail = along - outward * arrow;
    const std::string arrow_path =
        joined({"M", place(tail, across - cap), "L", place(along, across), "L", place(tail, across + cap)});
    const std::string& path = bounded ? cap_path : arrow_path;
    return empty_element("path", " class=\"bar\" d=\"" + path + "\"");
  }

  [[nodiscard]] Markup draw_x_interval(const PlotPoint& point, const PlotSeries& series) const {
    const Interval& interval = point.x_interval;
    if (!interval.low && !interval.high) return {};
    const bool low = interval.low && inside_x(*interval.low);
    const bool high = interval.high && inside_x(*interval.high);
    const double from = low ? x(*interval.low) : margin_left;
    const double to = high ? x(*interval.high) : right_;
    const double height = y(*point.y) + series.dodge_px;
    return line_element("bar", from, height, to, height) + interval_end(from, height, -1, low, true) +
           interval_end(to, height, 1, high, true);
  }

  [[nodiscard]] Markup draw_y_interval(const PlotPoint& point, const PlotSeries& series) const {
    const Interval& interval = point.y_interval;
    if (!interval.low && !interval.high) return {};
    const bool low = interval.low && inside_y(*interval.low);
    const bool high = interval.high && inside_y(*interval.high);
    const double from = (low ? y(*interval.low) : bottom_) + series.dodge_px;
    const double to = (high ? y(*interval.high) : margin_top) + series.dodge_px;
    const double across = x(*point.x);
    return line_element("bar", across, from, across, to) + interval_end(from, across, 1, low, false) +
           interval_end(to, across, -1, high, false);
  }

  static Markup draw_marker(PlotMarker marker, double cx, double cy) {
    const double r = marker_radius;
    switch (marker) {
      case PlotMarker::none:
        break;
      case PlotMarker::disc:
        return empty_element("circle", " class=\"marker\"" + number_attribute("cx", cx) + number_attribute("cy", cy) +
                                           number_attribute("r", r));
      case PlotMarker::square:
        return empty_element("rect", " class=\"marker hollow\"" + number_attribute("x", cx - r) +
                                         number_attribute("y", cy - r) + number_attribute("width", 2 * r) +
                                         number_attribute("height", 2 * r));
      case PlotMarker::bar:
        return line_element("limit", cx, cy - 11, cx, cy + 11);
    }
    return {};
  }

  [[nodiscard]] Markup draw_legend() const {
    Markup legend;
    for (const LegendEntry& entry : legend_) {
      const double height = bottom_ + below_axis + 12 + entry.row * legend_row;
      const double middle = entry.x + legend_swatch / 2;
      Markup swatch;
      if (entry.series == nullptr) {
        swatch = empty_element("rect", " class=\"band\"" + number_attribute("x", entry.x) +
                                           number_attribute("y", height - 7) +
                                           number_attribute("width", legend_swatch) + number_attribute("height", 14));
      } else {
        const PlotLine line = entry.series->line != PlotLine::none ? entry.series->line : entry.series->legend_line;
        if (line != PlotLine::none)
          swatch += line_element(line_class(line), entry.x, height, entry.x + legend_swatch, height);
        swatch += draw_marker(entry.series->marker, middle, height);
      }
      legend += element("g", swatch, "class=\"" + std::string(tone_class(entry.tone)) + "\"");
      legend += text_element("legend", entry.x + legend_swatch + 6, height + 4.5, entry.label);
    }
    return legend;
  }

  const Plot& plot_;
  std::vector<LegendEntry> legend_;
  double bottom_ = 0, right_ = 0;
};

}  // namespace

Result<Markup> svg_plot(const Plot& plot) {
  for (const PlotAxis* axis : {&plot.x, &plot.y})
    if (const Result<void> valid = validate(*axis); !valid)
      return fail("drawing \"" + plot.title + "\"", valid.error());
  const Markup words = element("title", escaped(plot.title), "id=\"" + plot.id + "-title\"") +
                       element("desc", escaped(plot.description), "id=\"" + plot.id + "-desc\"") + literal("\n");
  const std::string attributes = "class=\"plot\" xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" aria-labelledby=\"" +
                                 plot.id + "-title " + plot.id + "-desc\" viewBox=\"0 0 " + at(plot.width) + " " +
                                 at(plot.height) + "\"";
  return element("svg", words + Canvas(plot).draw(), attributes) + literal("\n");
}

std::string plot_style() {
  // Contrast of every text and line against its ground is at least 4.5 and 3 to 1 (WCAG 2.1), except the grid, which is
  // decoration.
  return R"(.plot{--a:#0072b2;--b:#c14e00;--c:#00795a;--m:#595959;--ink:#1a1a1a;--ground:#ffffff;--grid:#e3e3e3;
display:block;width:100%;height:auto;font:13px system-ui,"DejaVu Sans",Arial,sans-serif}
@media screen and (prefers-color-scheme:dark){.plot{--a:#56b4e9;--b:#f0a050;--c:#2cc79a;--m:#b0b0b0;--ink:#ececec;--ground:#16191d;
--grid:#33383f}}
.plot text{fill:var(--ink)}
.plot .frame{fill:var(--ground);stroke:var(--ink);stroke-width:1}
.plot .grid{stroke:var(--grid);stroke-width:1}
.plot .axis{stroke:var(--ink);stroke-width:1}
.plot .x-tick,.plot .axis-label{text-anchor:middle}
.plot .y-tick,.plot .note{text-anchor:end}
.plot .note{fill:var(--m);font-size:12px;paint-order:stroke;stroke:var(--ground);stroke-width:4px;stroke-linejoin:round}
.plot .reference{stroke:var(--m);stroke-width:1.2;stroke-dasharray:6 4}
.plot .tone-a{--t:var(--a)}.plot .tone-b{--t:var(--b)}.plot .tone-c{--t:var(--c)}.plot .tone-m{--t:var(--m)}
.plot .curve{fill:none;stroke:var(--t);stroke-width:2;stroke-linejoin:round}
.plot .dashed{stroke-dasharray:8 5}.plot .dotted{stroke-dasharray:2 4}
.plot .bar{fill:none;stroke:var(--t);stroke-width:1.5}
.plot .marker{fill:var(--t);stroke:var(--t);stroke-width:1.5}
.plot .hollow{fill:var(--ground)}
.plot .limit{stroke:var(--t);stroke-width:4}
.plot .band{fill:var(--t);fill-opacity:.18}
)";
}

namespace {

/// plot_style() in its light shades without variables, which viewers of files do not know.
std::string document_style() {
  std::string style = R"(svg{font:13px system-ui,"DejaVu Sans",Arial,sans-serif;background:#ffffff}
text{fill:#1a1a1a}
.frame{fill:#ffffff;stroke:#1a1a1a;stroke-width:1}
.grid{stroke:#e3e3e3;stroke-width:1}
.axis{stroke:#1a1a1a;stroke-width:1}
.x-tick,.axis-label{text-anchor:middle}
.y-tick,.note{text-anchor:end}
.note{fill:#595959;font-size:12px;paint-order:stroke;stroke:#ffffff;stroke-width:4px;stroke-linejoin:round}
.reference{stroke:#595959;stroke-width:1.2;stroke-dasharray:6 4}
.curve{fill:none;stroke-width:2;stroke-linejoin:round}
.dashed{stroke-dasharray:8 5}.dotted{stroke-dasharray:2 4}
.bar{fill:none;stroke-width:1.5}
.marker{stroke-width:1.5}
.limit{stroke-width:4}
.band{fill-opacity:.18}
)";
  constexpr std::array<std::pair<std::string_view, std::string_view>, 4> tones{
      {{".tone-a", "#0072b2"}, {".tone-b", "#c14e00"}, {".tone-c", "#00795a"}, {".tone-m", "#595959"}}};
  for (const auto& [tone, colour] : tones) {
    style += joined({tone, ".curve,",         tone,   " .curve,", tone, " .bar,",    tone, " .marker,",
                     tone, " .limit{stroke:", colour, "}\n",      tone, " .marker,", tone, ".band,",
                     tone, " .band{fill:",    colour, "}\n"});
  }
  return style + ".marker.hollow{fill:#ffffff}\n";
}

}  // namespace

Result<std::string> svg_document(std::span<const Plot> plots) {
  constexpr double gap = 12;
  double width = 0, height = 0;
  std::string pictures;
  for (const Plot& plot : plots) {
    const Result<Markup> picture = svg_plot(plot);
    if (!picture) return tl::unexpected(picture.error());
    std::string text = picture->text;
    text.insert(text.find("<svg ") + 5, joined({"x=\"0\" y=\"", at(height), "\" width=\"", at(plot.width),
                                                "\" height=\"", at(plot.height), "\" "}));
    pictures += text;
    width = std::max(width, plot.width);
    height += plot.height + gap;
  }
  return joined({"<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"",
                 at(width), "\" height=\"", at(height), "\" viewBox=\"0 0 ", at(width), " ", at(height), "\">\n<style>",
                 document_style(), "</style>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n", pictures,
                 "</svg>\n"});
}

}  // namespace todbench
