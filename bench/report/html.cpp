// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/html.h"

#include <fmt/format.h>

#include "bench/report/html_style.h"
#include "bench/report/markup.h"
#include "bench/report/svg.h"
#include "bench/text/base64.h"

namespace todbench {
namespace {

// Tables with up to this many rows are kept on one page.
constexpr std::size_t rows_kept_together = 14;

Markup html(const Phrase& phrase) {
  const Markup text = escaped(phrase.text);
  switch (phrase.meaning) {
    case Meaning::plain:
      return text;
    case Meaning::strong:
      return element("b", text);
    case Meaning::reason:
      return element("span", text, "class=\"why\"");
    case Meaning::unbroken:
      return element("span", text, "class=\"unbroken\"");
    case Meaning::good:
      return element("strong", text, "class=\"badge good\"");
    case Meaning::bad:
      return element("strong", text, "class=\"badge bad\"");
    case Meaning::open:
      return element("strong", text, "class=\"badge open\"");
  }
  return text;
}

Markup html(const RichText& text) {
  Markup result;
  for (const Phrase& phrase : text.phrases) result += html(phrase);
  return result;
}

Markup line(std::string_view tag, const Markup& content, std::string_view attributes = "") {
  return element(tag, content, attributes) + literal("\n");
}

Markup caption_of(const std::string& caption) {
  return caption.empty() ? Markup{} : element("caption", escaped(caption));
}

/// Markup of one block of a document.
struct BlockMarkup {
  Markup operator()(const Paragraph& paragraph) const {
    return line("p", html(paragraph.text), paragraph.role == Paragraph::Role::note ? "class=\"note\"" : "");
  }

  Markup operator()(const List& list) const {
    Markup items;
    for (const RichText& item : list.items) items += line("li", html(item));
    return element("ul", items);
  }

  Markup operator()(const Table& table) const {
    Markup head;
    for (const std::string& name : table.header) head += element("th", escaped(name), "scope=\"col\"");
    Markup body;
    for (const auto& row : table.rows) {
      Markup cells;
      for (std::size_t i = 0; i < row.size(); ++i)
        cells += i == 0 ? element("th", html(row[i]), "scope=\"row\"") : element("td", html(row[i]));
      body += line("tr", cells);
    }
    return line("div",
                element("table", caption_of(table.caption) + element("thead", element("tr", head)) + literal("\n") +
                                     element("tbody", body)),
                table.rows.size() <= rows_kept_together ? "class=\"wide short\"" : "class=\"wide\"");
  }

  Markup operator()(const ValueTable& table) const {
    Markup body;
    for (const NamedValue& entry : table.values)
      body += line("tr", element("th", escaped(entry.name), "scope=\"row\"") + element("td", html(entry.value)));
    return line("table", caption_of(table.caption) + element("tbody", body), "class=\"values\"");
  }

  Markup operator()(const Figure& figure) const {
    const Markup content = figure.drawing ? svg_element(*figure.drawing)
                                          : (*this)(Paragraph{missing("no figure: " + figure.drawing.error().message)});
    return line("figure", content + element("figcaption", escaped(figure.caption)));
  }

  Markup operator()(const FigurePairs& pairs) const {
    Markup figures;
    for (const Figure& figure : pairs.figures) figures += (*this)(figure);
    return element("div", figures, "class=\"pairs\"");
  }

  Markup operator()(const TablePairs& pairs) const {
    Markup tables;
    for (const auto& table : pairs.tables) tables += std::visit(*this, table);
    return element("div", tables, "class=\"pairs\"");
  }

  Markup operator()(const VerdictBox& box) const {
    Markup content = line("p", escaped(box.word), "class=\"word\"");
    for (const RichText& paragraph : box.paragraphs) content += line("p", html(paragraph));
    const char* css = box.mood == Mood::good  ? "class=\"verdict good\" role=\"status\""
                      : box.mood == Mood::bad ? "class=\"verdict bad\" role=\"status\""
                                              : "class=\"verdict open\" role=\"status\"";
    return line("div", content, css);
  }

  Markup operator()(const Imprint& imprint) const {
    Markup content;
    if (!imprint.png.empty()) {
      content += literal(fmt::format("<img style=\"height:{:.1f}mm\" alt=\"", imprint.height_mm)) +
                 escaped(imprint.png_text) + literal("\" src=\"data:image/png;base64," + base64(imprint.png) + "\"/>");
    }
    Markup lines;
    for (const std::string& text : imprint.lines) lines += line("div", escaped(text));
    return line("div", content + element("div", lines), "class=\"imprint\"");
  }

  Markup operator()(const Signatures& signatures) const {
    Markup columns;
    for (const auto& [role, name] : signatures.signatories) {
      columns +=
          element("div", element("div", escaped(role), "class=\"role\"") +
                             element("div", escaped(name.empty() ? "Name:" : "Name: " + name), "class=\"line\"") +
                             element("div", literal("Date:"), "class=\"line\"") +
                             element("div", literal("Signature:"), "class=\"line tall\""));
    }
    return element("div", columns, "class=\"signatures\"");
  }
};

Markup html(const std::vector<Block>& blocks) {
  Markup result;
  for (const Block& block : blocks) result += std::visit(BlockMarkup{}, block);
  return result;
}

}  // namespace

std::string render_html(const Document& document) {
  const Markup head =
      literal(
          "<meta charset=\"utf-8\"/>\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n") +
      line("title", escaped(document.title)) +
      line("style", literal(page_style(document.page_label) + drawing_style()));
  Markup body = line("header", html(document.before_heading) + line("h1", escaped(document.heading)) +
                                   line("p", escaped(document.subtitle), "class=\"subtitle\""));
  body += html(document.opening);
  for (const Section& section : document.sections)
    body += line("section", line("h2", escaped(section.title)) + html(section.blocks));
  return "<!DOCTYPE html>\n" +
         element("html", element("head", head) + literal("\n") + element("body", element("main", body)),
                 "lang=\"en\" xmlns=\"http://www.w3.org/1999/xhtml\"")
             .text +
         "\n";
}

}  // namespace todbench
