// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plate_drawing/sheet_files.h"

#include <fmt/format.h>

#include <array>
#include <utility>

namespace todbench {
namespace {

constexpr double line_mm = 0.25, cut_line_mm = 0.35;
constexpr double em_of_capital = 1 / 0.716;  // Helvetica: capitals are 0.716 of the size of the font
constexpr double points_per_mm = 72 / 25.4;

/// Nine decimals: files are read again to 1e-6 mm.
std::string number(double value) {
  return fmt::format("{:.9f}", value == 0 ? 0.0 : value);
}

double pen_mm(SheetLayer layer) {
  return layer == SheetLayer::cut ? cut_line_mm : line_mm;
}

std::string replaced(std::string text, const std::vector<std::pair<std::string_view, std::string_view>>& pairs) {
  for (const auto& [from, to] : pairs) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
  }
  return text;
}

std::string xml_text(const std::string& text) {
  return replaced(text, {{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}});
}

/// Group code and value.
std::string group(int code, std::string_view value) {
  return fmt::format("{:3}\n{}\n", code, value);
}

std::string dxf_point(cv::Point2d at) {
  return group(10, number(at.x)) + group(20, number(-at.y)) + group(30, "0.0");
}

/// Escapes a text for a string of PDF in WinAnsiEncoding, whose bytes for U+00A0 to U+00FF are their code points. Other
/// characters outside of ASCII become '?'.
std::string pdf_text(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if (byte < 0x80) {
      if (byte == '(' || byte == ')' || byte == '\\') out += '\\';
      out += byte < 0x20 ? ' ' : text[i];
      continue;
    }
    const bool latin = (byte == 0xC2 || byte == 0xC3) && i + 1 < text.size();
    if (latin) {
      const unsigned code = ((byte & 3U) << 6U) | (static_cast<unsigned char>(text[i + 1]) & 0x3FU);
      out += fmt::format("\\{:03o}", code);
    } else {
      out += '?';
    }
    while (i + 1 < text.size() && (static_cast<unsigned char>(text[i + 1]) & 0xC0U) == 0x80U) ++i;
  }
  return out;
}

/// The page: lines and text in points from the lower left corner.
std::string pdf_content(const PlateSheet& sheet) {
  const auto place = [&](cv::Point2d at) {
    return number((at.x - sheet.left_mm) * points_per_mm) + " " +
           number((sheet.top_mm + sheet.height_mm - at.y) * points_per_mm);
  };
  std::string out = "1 J 1 j\n";
  for (const SheetLine& line : sheet.lines) {
    out += number(pen_mm(line.layer) * points_per_mm) + " w\n";
    for (std::size_t i = 0; i < line.points_mm.size(); ++i)
      out += place(line.points_mm[i]) + (i == 0 ? " m\n" : " l\n");
    out += line.closed ? "s\n" : "S\n";
  }
  for (const SheetText& text : sheet.texts) {
    out += "BT /F1 " + number(text.height_mm * em_of_capital * points_per_mm) + " Tf " + place(text.at_mm) + " Td (" +
           pdf_text(text.text) + ") Tj ET\n";
  }
  return out;
}

}  // namespace

std::string sheet_svg(const PlateSheet& sheet) {
  std::string out = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:g}mm\" "
      "height=\"{1:g}mm\" viewBox=\"{2:g} {3:g} {0:g} {1:g}\">\n<title>Plate {4}</title>\n",
      sheet.width_mm, sheet.height_mm, sheet.left_mm, sheet.top_mm, xml_text(sheet.title));
  out += fmt::format("<rect x=\"{:g}\" y=\"{:g}\" width=\"{:g}\" height=\"{:g}\" fill=\"white\"/>\n", sheet.left_mm,
                     sheet.top_mm, sheet.width_mm, sheet.height_mm);
  for (const SheetLayer layer : {SheetLayer::cut, SheetLayer::dimension}) {
    out += fmt::format("<g id=\"{}\" fill=\"none\" stroke=\"black\" stroke-width=\"{:g}\">\n", to_string(layer),
                       pen_mm(layer));
    for (const SheetLine& line : sheet.lines) {
      if (line.layer != layer) continue;
      out += line.closed ? "<polygon points=\"" : "<polyline points=\"";
      for (const cv::Point2d& p : line.points_mm) out += number(p.x) + "," + number(p.y) + " ";
      out.back() = '"';
      out += "/>\n";
    }
    out += "</g>\n";
  }
  out += fmt::format("<g id=\"{}\" font-family=\"Helvetica, Arial, sans-serif\">\n", to_string(SheetLayer::text));
  for (const SheetText& text : sheet.texts) {
    out += fmt::format("<text x=\"{:g}\" y=\"{:g}\" font-size=\"{:.3f}\">{}</text>\n", text.at_mm.x, text.at_mm.y,
                       text.height_mm * em_of_capital, xml_text(text.text));
  }
  return out + "</g>\n</svg>\n";
}

std::string sheet_dxf(const PlateSheet& sheet) {
  constexpr std::array layers{SheetLayer::cut, SheetLayer::dimension, SheetLayer::text};
  std::string out = group(0, "SECTION") + group(2, "HEADER") + group(9, "$ACADVER") + group(1, "AC1009") +
                    group(9, "$MEASUREMENT") + group(70, "1") + group(0, "ENDSEC");
  out += group(0, "SECTION") + group(2, "TABLES") + group(0, "TABLE") + group(2, "LAYER") +
         group(70, std::to_string(layers.size()));
  for (const SheetLayer layer : layers) {
    out += group(0, "LAYER") + group(2, to_string(layer)) + group(70, "0") +
           group(62, layer == SheetLayer::cut ? "1" : "7") + group(6, "CONTINUOUS");
  }
  out += group(0, "ENDTAB") + group(0, "ENDSEC") + group(0, "SECTION") + group(2, "ENTITIES");
  for (const SheetLine& line : sheet.lines) {
    const auto layer = group(8, to_string(line.layer));
    out += group(0, "POLYLINE") + layer + group(66, "1") + dxf_point({0, 0}) + group(70, line.closed ? "1" : "0");
    for (const cv::Point2d& p : line.points_mm) out += group(0, "VERTEX") + layer + dxf_point(p);
    out += group(0, "SEQEND") + layer;
  }
  for (const SheetText& text : sheet.texts) {
    out += group(0, "TEXT") + group(8, to_string(SheetLayer::text)) + dxf_point(text.at_mm) +
           group(40, number(text.height_mm)) + group(1, replaced(text.text, {{"±", "%%p"}, {"°", "%%d"}}));
  }
  return out + group(0, "ENDSEC") + group(0, "EOF");
}

std::string sheet_pdf(const PlateSheet& sheet) {
  const std::string content = pdf_content(sheet);
  const std::array<std::string, 5> objects{
      "<< /Type /Catalog /Pages 2 0 R >>", "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
      fmt::format(
          "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {:.4f} {:.4f}] /Contents 5 0 R /Resources << /Font << /F1 "
          "4 0 R >> >> >>",
          sheet.width_mm * points_per_mm, sheet.height_mm * points_per_mm),
      "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica /Encoding /WinAnsiEncoding >>",
      fmt::format("<< /Length {} >>\nstream\n{}endstream", content.size(), content)};
  std::string out = "%PDF-1.4\n";
  std::string table = fmt::format("xref\n0 {}\n0000000000 65535 f \n", objects.size() + 1);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    table += fmt::format("{:010} 00000 n \n", out.size());
    out += fmt::format("{} 0 obj\n{}\nendobj\n", i + 1, objects[i]);
  }
  return out + table +
         fmt::format("trailer\n<< /Size {} /Root 1 0 R >>\nstartxref\n{}\n%%EOF\n", objects.size() + 1, out.size());
}

}  // namespace todbench
