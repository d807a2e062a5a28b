// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "bench/report/number_format.h"

namespace todbench {
namespace {

constexpr std::array all_tones{PlotTone::first, PlotTone::second, PlotTone::third, PlotTone::muted};

std::string at(double coordinate) {
  return fixed(coordinate, 2);
}

std::string_view tone_class(PlotTone tone) {
  constexpr std::array<std::string_view, 4> names{"tone-a", "tone-b", "tone-c", "tone-m"};
  return names[static_cast<std::size_t>(tone)];
}

bool has_tone(const PenStyle& style) {
  return style.stroke == Ink::tone || style.fill == Ink::tone;
}

std::string box_attributes(const Box& box) {
  return fmt::format(R"(x="{}" y="{}" width="{}" height="{}")", at(box.x), at(box.y), at(box.width), at(box.height));
}

/// SVG element of a shape.
struct ShapeElement {
  std::string css;

  std::string operator()(const Segment& line) const {
    return fmt::format(R"(<line class="{}" x1="{}" y1="{}" x2="{}" y2="{}"/>)", css, at(line.from.x), at(line.from.y),
                       at(line.to.x), at(line.to.y));
  }
  std::string operator()(const Polyline& line) const {
    std::string path;
    for (const auto& run : line.runs)
      for (std::size_t i = 0; i < run.size(); ++i)
        path += fmt::format("{}{} {}", i == 0 ? "M" : "L", at(run[i].x), at(run[i].y));
    return fmt::format(R"(<path class="{}" d="{}"/>)", css, path);
  }
  std::string operator()(const Box& box) const {
    return fmt::format(R"(<rect class="{}" {}/>)", css, box_attributes(box));
  }
  std::string operator()(const Disc& disc) const {
    return fmt::format(R"(<circle class="{}" cx="{}" cy="{}" r="{}"/>)", css, at(disc.centre.x), at(disc.centre.y),
                       at(disc.radius));
  }
  std::string operator()(const Raster& raster) const {
    return fmt::format(R"(<image style="image-rendering:pixelated" preserveAspectRatio="none" {} )"
                       R"(href="data:image/png;base64,{}"/>)",
                       box_attributes(raster.place), raster.png_base64);
  }
};

Markup mark_element(const Mark& mark) {
  const PenStyle style = style_of(mark.pen);
  const std::string css =
      has_tone(style) ? fmt::format("{} {}", style.name, tone_class(mark.tone)) : std::string(style.name);
  return literal(std::visit(ShapeElement{css}, mark.shape) + "\n");
}

Markup label_element(const Label& label) {
  const std::string place =
      label.role == LabelRole::y_axis
          ? fmt::format(R"x(transform="translate({} {}) rotate(-90)")x", at(label.at.x), at(label.at.y))
          : fmt::format(R"(x="{}" y="{}")", at(label.at.x), at(label.at.y));
  return element("text", escaped(label.text), fmt::format(R"(class="{}" {})", style_of(label.role).name, place)) +
         literal("\n");
}

Markup contents(const Drawing& drawing) {
  Markup inside;
  for (const Mark& mark : drawing.inside) inside += mark_element(mark);
  Markup picture =
      element("defs", element("clipPath", literal(fmt::format("<rect {}/>", box_attributes(drawing.frame))),
                              fmt::format(R"(id="{}-clip")", drawing.id))) +
      mark_element({drawing.frame, Pen::frame}) +
      element("g", inside, fmt::format(R"x(clip-path="url(#{}-clip)")x", drawing.id)) + literal("\n");
  for (const Mark& mark : drawing.marks) picture += mark_element(mark);
  for (const Label& label : drawing.labels) picture += label_element(label);
  return picture;
}

/// `placement` precedes the attributes that every drawing has.
Markup svg(const Drawing& drawing, std::string_view placement) {
  const Markup words = element("title", escaped(drawing.title), fmt::format(R"(id="{}-title")", drawing.id)) +
                       element("desc", escaped(drawing.description), fmt::format(R"(id="{}-desc")", drawing.id)) +
                       literal("\n");
  return element("svg", words + contents(drawing),
                 fmt::format(R"({}class="plot" xmlns="http://www.w3.org/2000/svg" role="img" )"
                             R"(aria-labelledby="{}-title {}-desc" viewBox="0 0 {} {}")",
                             placement, drawing.id, drawing.id, at(drawing.width), at(drawing.height))) +
         literal("\n");
}

using ColourText = std::function<std::string(Ink)>;

std::string_view anchor_text(Anchor anchor) {
  return anchor == Anchor::middle ? "middle" : anchor == Anchor::end ? "end" : "start";
}

std::string pen_rule(const std::string& selector, const PenStyle& style, const ColourText& colour) {
  std::string rule = fmt::format("{}{{fill:{}", selector, style.fill == Ink::none ? "none" : colour(style.fill));
  if (style.fill_opacity < 1) rule += fmt::format(";fill-opacity:{}", style.fill_opacity);
  if (style.stroke != Ink::none)
    rule += fmt::format(";stroke:{};stroke-width:{};stroke-linejoin:round", colour(style.stroke), style.width);
  if (style.dash[0] > 0) rule += fmt::format(";stroke-dasharray:{} {}", style.dash[0], style.dash[1]);
  return rule + "}\n";
}

std::string label_rules(const std::string& scope, const ColourText& colour) {
  std::string rules;
  for (const LabelRole role : all_label_roles) {
    const LabelStyle style = style_of(role);
    rules += fmt::format("{}.{}{{fill:{};font-size:{}px;text-anchor:{}", scope, style.name, colour(style.ink),
                         style.size, anchor_text(style.anchor));
    if (style.halo > 0)
      rules += fmt::format(";paint-order:stroke;stroke:{};stroke-width:{}px;stroke-linejoin:round", colour(Ink::ground),
                           style.halo);
    rules += "}\n";
  }
  return rules;
}

std::string variables(const DrawingPalette& palette) {
  return fmt::format("--a:{};--b:{};--c:{};--m:{};--ink:{};--ground:{};--grid:{}", palette.tones[0], palette.tones[1],
                     palette.tones[2], palette.muted, palette.ink, palette.ground, palette.grid);
}

std::string variable_of(Ink ink) {
  switch (ink) {
    case Ink::none:
      return "none";
    case Ink::ground:
      return "var(--ground)";
    case Ink::ink:
      return "var(--ink)";
    case Ink::grid:
      return "var(--grid)";
    case Ink::muted:
      return "var(--m)";
    case Ink::tone:
      return "var(--t)";
  }
  return "none";
}

/// Returns drawing_style() in light shades without CSS variables, which file viewers do not support.
std::string document_style() {
  const DrawingPalette palette = light_palette();
  const auto of_tone = [&](PlotTone tone) {
    return [&palette, tone](Ink ink) { return std::string(palette.of(ink, tone)); };
  };
  std::string style =
      fmt::format("svg{{font:13px system-ui,\"DejaVu Sans\",Arial,sans-serif;background:{}}}\n", palette.ground);
  for (const Pen pen : all_pens) {
    const PenStyle pen_style = style_of(pen);
    if (!has_tone(pen_style)) style += pen_rule(fmt::format(".{}", pen_style.name), pen_style, of_tone({}));
    for (const PlotTone tone : all_tones)
      if (has_tone(pen_style))
        style += pen_rule(fmt::format(".{}.{}", pen_style.name, tone_class(tone)), pen_style, of_tone(tone));
  }
  return style + label_rules("", of_tone({}));
}

}  // namespace

Markup svg_element(const Drawing& drawing) {
  return svg(drawing, "");
}

std::string drawing_style() {
  std::string style = fmt::format(
      ".plot{{{};\ndisplay:block;width:100%;height:auto;font:13px system-ui,\"DejaVu Sans\",Arial,sans-serif}}\n"
      "@media screen and (prefers-color-scheme:dark){{.plot{{{}}}}}\n"
      ".plot .tone-a{{--t:var(--a)}}.plot .tone-b{{--t:var(--b)}}.plot .tone-c{{--t:var(--c)}}.plot "
      ".tone-m{{--t:var(--m)}}"
      "\n",
      variables(light_palette()), variables(dark_palette()));
  for (const Pen pen : all_pens)
    style += pen_rule(fmt::format(".plot .{}", style_of(pen).name), style_of(pen), variable_of);
  return style + label_rules(".plot ", variable_of);
}

std::string svg_document(std::span<const Drawing> drawings) {
  constexpr double gap = 12;
  double width = 0, height = 0;
  std::string pictures;
  for (const Drawing& drawing : drawings) {
    pictures += svg(drawing, fmt::format(R"(x="0" y="{}" width="{}" height="{}" )", at(height), at(drawing.width),
                                         at(drawing.height)))
                    .text;
    width = std::max(width, drawing.width);
    height += drawing.height + gap;
  }
  return fmt::format(
      R"(<?xml version="1.0" encoding="UTF-8"?>
<svg xmlns="http://www.w3.org/2000/svg" width="{0}" height="{1}" viewBox="0 0 {0} {1}">
<style>{2}</style>
<rect width="100%" height="100%" fill="#ffffff"/>
{3}</svg>
)",
      at(width), at(height), document_style(), pictures);
}

}  // namespace todbench
