// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/plot.h"

#include <algorithm>
#include <cmath>

namespace todbench {
namespace {

// Lengths in units of the drawing. Text is 13 units high; in the fonts of the style a character is on average at most
// 0.62 of that wide.
constexpr double character_width = 0.58 * 13;
constexpr double margin_top = 14, margin_right = 18, margin_left = 66;
constexpr double below_axis = 50;  // tick labels and axis label
constexpr double legend_row = 22, legend_swatch = 34, legend_gap = 22;
constexpr double marker_radius = 4.2, cap = 5, arrow = 7, limit_height = 22;
constexpr double x_label_spacing = 62, y_label_spacing = 34;

Pen pen_of(PlotLine line) {
  return line == PlotLine::dashed ? Pen::dashed : line == PlotLine::dotted ? Pen::dotted : Pen::curve;
}

/// Width by characters, not bytes.
double text_width(std::string_view text) {
  return character_width * static_cast<double>(std::count_if(text.begin(), text.end(), [](char byte) {
           return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U;
         }));
}

struct LegendEntry {
  std::string label;
  const PlotSeries* series = nullptr;  ///< null: the entry is a band
  PlotTone tone = PlotTone::first;
  double x = 0;
  int row = 0;
};

/// Places entries side by side and starts a new row if the next entry would leave the picture.
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
    out_.id = plot.id;
    out_.title = plot.title;
    out_.description = plot.description;
    out_.width = plot.width;
    out_.height = plot.height;
    out_.frame = {margin_left, margin_top, right_ - margin_left, bottom_ - margin_top};
  }

  [[nodiscard]] Drawing draw() && {
    for (const PlotBand& band : plot_.bands) draw_band(band);
    draw_grid();
    for (const PlotReference& reference : plot_.references)
      out_.inside.push_back({Segment{{margin_left, y(reference.y)}, {right_, y(reference.y)}}, Pen::reference});
    for (const PlotSeries& series : plot_.series) draw_line(series);
    for (const PlotSeries& series : plot_.series) draw_points(series);
    for (const PlotReference& reference : plot_.references)
      if (inside_y(reference.y)) write({right_ - 5, y(reference.y) - 5}, reference.label, LabelRole::note);
    draw_ticks();
    draw_legend();
    return std::move(out_);
  }

 private:
  static double fraction(const PlotAxis& axis, double value) {
    if (axis.scale != AxisScale::logarithmic) return (value - axis.low) / (axis.high - axis.low);
    if (value <= 0) return -1;
    return std::log(value / axis.low) / std::log(axis.high / axis.low);
  }
  // Limits positions to slightly outside the plot, so that no coordinate exceeds the range of renderers.
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

  void write(Place at, const std::string& text, LabelRole role) { out_.labels.push_back({at, text, role}); }
  void draw(Mark mark) { out_.marks.push_back(std::move(mark)); }

  void draw_grid() {
    for (const Tick& tick : x_ticks())
      if (!tick.label.empty())
        out_.inside.push_back({Segment{{x(tick.value), margin_top}, {x(tick.value), bottom_}}, Pen::grid});
    for (const Tick& tick : y_ticks())
      if (!tick.label.empty())
        out_.inside.push_back({Segment{{margin_left, y(tick.value)}, {right_, y(tick.value)}}, Pen::grid});
  }

  void draw_ticks() {
    for (const Tick& tick : x_ticks()) {
      const double length = tick.label.empty() ? 3 : 6;
      draw({Segment{{x(tick.value), bottom_}, {x(tick.value), bottom_ + length}}, Pen::axis});
      if (!tick.label.empty()) write({x(tick.value), bottom_ + 20}, tick.label, LabelRole::x_tick);
    }
    for (const Tick& tick : y_ticks()) {
      const double length = tick.label.empty() ? 3 : 6;
      draw({Segment{{margin_left - length, y(tick.value)}, {margin_left, y(tick.value)}}, Pen::axis});
      if (!tick.label.empty()) write({margin_left - 9, y(tick.value) + 4.5}, tick.label, LabelRole::y_tick);
    }
    write({(margin_left + right_) / 2, bottom_ + 40}, plot_.x.label, LabelRole::x_axis);
    write({16, (margin_top + bottom_) / 2}, plot_.y.label, LabelRole::y_axis);
  }

  void draw_band(const PlotBand& band) {
    if (!band.x.low && !band.x.high) return;
    const double from = band.x.low ? std::max(x(*band.x.low), margin_left) : margin_left;
    const double to = band.x.high ? std::min(x(*band.x.high), right_) : right_;
    if (!(to > from)) return;
    out_.inside.push_back({Box{from, margin_top, to - from, bottom_ - margin_top}, Pen::band, band.tone});
  }

  void draw_line(const PlotSeries& series) {
    if (series.line == PlotLine::none) return;
    Polyline path;
    bool pen_down = false;
    for (const PlotPoint& point : series.points) {
      if (!point.x || !point.y || !std::isfinite(*point.x) || !std::isfinite(*point.y)) {
        pen_down = false;
        continue;
      }
      if (!pen_down) path.runs.emplace_back();
      path.runs.back().push_back({x(*point.x), y(*point.y) + series.dodge_px});
      pen_down = true;
    }
    if (!path.runs.empty()) out_.inside.push_back({std::move(path), pen_of(series.line), series.tone});
  }

  void draw_points(const PlotSeries& series) {
    for (const PlotPoint& point : series.points) {
      if (point.y && inside_y(*point.y)) draw_x_interval(point, series);
      if (point.x && inside_x(*point.x)) draw_y_interval(point, series);
    }
    for (const PlotPoint& point : series.points)
      if (point.x && point.y && inside_x(*point.x) && inside_y(*point.y))
        draw_marker(series.marker, {x(*point.x), y(*point.y) + series.dodge_px}, series.tone);
  }

  enum class IntervalEnd { with_cap, with_arrow };

  /// Draws an end of an interval: a cap if it is inside, an arrow if it is open or beyond the edge. `outward`: unit
  /// vector in the direction of the interval.
  void draw_end(Place end, Place outward, IntervalEnd kind, PlotTone tone) {
    const Place across{cap * std::abs(outward.y), cap * std::abs(outward.x)};
    const bool bounded = kind == IntervalEnd::with_cap;
    const double back = bounded ? 0 : arrow;
    const Place tail{end.x - back * outward.x, end.y - back * outward.y};
    const Place one{tail.x - across.x, tail.y - across.y}, other{tail.x + across.x, tail.y + across.y};
    Polyline path;
    path.runs.push_back(bounded ? std::vector{one, other} : std::vector{one, end, other});
    draw({std::move(path), Pen::bar, tone});
  }

  void draw_x_interval(const PlotPoint& point, const PlotSeries& series) {
    const Interval& interval = point.x_interval;
    if (!interval.low && !interval.high) return;
    const bool low = interval.low && inside_x(*interval.low);
    const bool high = interval.high && inside_x(*interval.high);
    const double height = y(*point.y) + series.dodge_px;
    const Place from{low ? x(*interval.low) : margin_left, height}, to{high ? x(*interval.high) : right_, height};
    draw({Segment{from, to}, Pen::bar, series.tone});
    draw_end(from, {-1, 0}, low ? IntervalEnd::with_cap : IntervalEnd::with_arrow, series.tone);
    draw_end(to, {1, 0}, high ? IntervalEnd::with_cap : IntervalEnd::with_arrow, series.tone);
  }

  void draw_y_interval(const PlotPoint& point, const PlotSeries& series) {
    const Interval& interval = point.y_interval;
    if (!interval.low && !interval.high) return;
    const bool low = interval.low && inside_y(*interval.low);
    const bool high = interval.high && inside_y(*interval.high);
    const double across = x(*point.x);
    const Place from{across, (low ? y(*interval.low) : bottom_) + series.dodge_px};
    const Place to{across, (high ? y(*interval.high) : margin_top) + series.dodge_px};
    draw({Segment{from, to}, Pen::bar, series.tone});
    draw_end(from, {0, 1}, low ? IntervalEnd::with_cap : IntervalEnd::with_arrow, series.tone);
    draw_end(to, {0, -1}, high ? IntervalEnd::with_cap : IntervalEnd::with_arrow, series.tone);
  }

  void draw_marker(PlotMarker marker, Place at, PlotTone tone) {
    const double r = marker_radius;
    switch (marker) {
      case PlotMarker::none:
        break;
      case PlotMarker::disc:
        return draw({Disc{at, r}, Pen::marker, tone});
      case PlotMarker::square:
        return draw({Box{at.x - r, at.y - r, 2 * r, 2 * r}, Pen::hollow, tone});
      case PlotMarker::bar:
        return draw({Segment{{at.x, at.y - limit_height / 2}, {at.x, at.y + limit_height / 2}}, Pen::limit, tone});
    }
  }

  void draw_legend() {
    for (const LegendEntry& entry : legend_) {
      const double height = bottom_ + below_axis + 12 + entry.row * legend_row;
      if (entry.series == nullptr) {
        draw({Box{entry.x, height - 7, legend_swatch, 14}, Pen::band, entry.tone});
      } else {
        const PlotLine line = entry.series->line != PlotLine::none ? entry.series->line : entry.series->legend_line;
        if (line != PlotLine::none)
          draw({Segment{{entry.x, height}, {entry.x + legend_swatch, height}}, pen_of(line), entry.tone});
        draw_marker(entry.series->marker, {entry.x + legend_swatch / 2, height}, entry.tone);
      }
      write({entry.x + legend_swatch + 6, height + 4.5}, entry.label, LabelRole::legend);
    }
  }

  const Plot& plot_;
  std::vector<LegendEntry> legend_;
  double bottom_ = 0, right_ = 0;
  Drawing out_;
};

}  // namespace

Result<Drawing> drawn(const Plot& plot) {
  for (const PlotAxis* axis : {&plot.x, &plot.y})
    if (const Result<void> valid = validate(*axis); !valid)
      return fail("drawing \"" + plot.title + "\"", valid.error());
  return Canvas(plot).draw();
}

}  // namespace todbench
