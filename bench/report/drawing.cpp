// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/drawing.h"

namespace todbench {

PenStyle style_of(Pen pen) {
  switch (pen) {
    case Pen::frame:
      return {.name = "frame", .stroke = Ink::ink, .width = 1, .fill = Ink::ground};
    case Pen::grid:
      return {.name = "grid", .stroke = Ink::grid, .width = 1};
    case Pen::axis:
      return {.name = "axis", .stroke = Ink::ink, .width = 1};
    case Pen::reference:
      return {.name = "reference", .stroke = Ink::muted, .width = 1.2, .dash = {6, 4}};
    case Pen::curve:
      return {.name = "curve", .stroke = Ink::tone, .width = 2};
    case Pen::dashed:
      return {.name = "dashed", .stroke = Ink::tone, .width = 2, .dash = {8, 5}};
    case Pen::dotted:
      return {.name = "dotted", .stroke = Ink::tone, .width = 2, .dash = {2, 4}};
    case Pen::bar:
      return {.name = "bar", .stroke = Ink::tone, .width = 1.5};
    case Pen::marker:
      return {.name = "marker", .stroke = Ink::tone, .width = 1.5, .fill = Ink::tone};
    case Pen::hollow:
      return {.name = "hollow", .stroke = Ink::tone, .width = 1.5, .fill = Ink::ground};
    case Pen::limit:
      return {.name = "limit", .stroke = Ink::tone, .width = 4};
    case Pen::band:
      return {.name = "band", .fill = Ink::tone, .fill_opacity = 0.18};
  }
  return {.name = "axis", .stroke = Ink::ink, .width = 1};
}

LabelStyle style_of(LabelRole role) {
  switch (role) {
    case LabelRole::x_tick:
      return {.name = "x-tick", .anchor = Anchor::middle};
    case LabelRole::y_tick:
      return {.name = "y-tick", .anchor = Anchor::end};
    case LabelRole::x_axis:
      return {.name = "x-axis", .anchor = Anchor::middle};
    case LabelRole::y_axis:
      return {.name = "y-axis", .anchor = Anchor::middle};
    case LabelRole::note:
      return {.name = "note", .anchor = Anchor::end, .size = 12, .ink = Ink::muted, .halo = 4};
    case LabelRole::legend:
      return {.name = "legend"};
  }
  return {.name = "legend"};
}

std::string_view DrawingPalette::of(Ink which, PlotTone tone) const {
  switch (which) {
    case Ink::none:
      return {};
    case Ink::ground:
      return ground;
    case Ink::ink:
      return ink;
    case Ink::grid:
      return grid;
    case Ink::muted:
      return muted;
    case Ink::tone:
      return tones[static_cast<std::size_t>(tone)];
  }
  return {};
}

DrawingPalette light_palette() {
  return {.ground = "#ffffff",
          .ink = "#1a1a1a",
          .grid = "#e3e3e3",
          .muted = "#595959",
          .tones = {"#0072b2", "#c14e00", "#00795a", "#595959"}};
}

DrawingPalette dark_palette() {
  return {.ground = "#16191d",
          .ink = "#ececec",
          .grid = "#33383f",
          .muted = "#b0b0b0",
          .tones = {"#56b4e9", "#f0a050", "#2cc79a", "#b0b0b0"}};
}

}  // namespace todbench
