// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/picture_page.h"

#include <fmt/format.h>

#include "bench/report/html.h"
#include "bench/report/markup.h"
#include "bench/text/base64.h"

namespace todbench {
namespace {

Markup figure(const PagePicture& picture) {
  const Markup image =
      literal(fmt::format(R"(<img style="width:100%;height:auto;image-rendering:pixelated" alt=")") +
              escaped(picture.title).text + R"(" src="data:image/png;base64,)" + base64(picture.png) + "\"/>");
  const Markup words = element("strong", escaped(picture.title)) + literal(" ") + escaped(picture.caption);
  return element("figure", image + element("figcaption", words), R"(style="margin:0")") + literal("\n");
}

}  // namespace

std::string page_with_pictures(const Document& document, std::string_view title, std::span<const PagePicture> pictures,
                               PicturePlace place) {
  Markup figures;
  for (const auto& picture : pictures) figures += figure(picture);
  const Markup section =
      element("section",
              element("h2", escaped(title)) +
                  element("div", figures,
                          R"(style="display:grid;grid-template-columns:repeat(auto-fit,minmax(18rem,1fr));gap:1rem")"));
  std::string page = render_html(document);
  // Text is escaped, so these tags occur only at the ends of header and document.
  const std::string end = place == PicturePlace::first ? "</header>" : "</main>";
  const auto at = page.find(end);
  return page.insert(place == PicturePlace::first ? at + end.size() : at, "\n" + section.text + "\n");
}

}  // namespace todbench
