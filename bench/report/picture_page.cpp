#include "bench/report/picture_page.h"

#include <fmt/format.h>

#include "bench/report/html.h"
#include "bench/report/markup.h"

namespace todbench {
namespace {

/// RFC 4648, with padding.
std::string base64(std::string_view bytes) {
  constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8U | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : letters[group >> (18 - 6 * k) & 63U];
  }
  return text;
}

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
  // Text is escaped, so the tags stand where the document ends its header and itself.
  const std::string end = place == PicturePlace::first ? "</header>" : "</main>";
  const auto at = page.find(end);
  return page.insert(place == PicturePlace::first ? at + end.size() : at, "\n" + section.text + "\n");
}

}  // namespace todbench
