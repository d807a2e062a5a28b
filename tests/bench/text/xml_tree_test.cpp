// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/text/xml_tree.h"

#include <gmock/gmock.h>

namespace todbench {
namespace {

using ::testing::HasSubstr;

TEST(XmlTree, ReadsElementsAttributesTextAndItsFiveEntities) {
  const auto root = parse_xml(
      "\xef\xbb\xbf<?xml version=\"1.0\"?>\n<!-- a -->\n<p:a xmlns:p='u' k=\"1 &lt; 2\">\n <b>x &amp; "
      "&#176;&#x20AC;</b>"
      "<c/><b>second</b><![CDATA[<raw>]]>\n</p:a>\n<!-- end -->\n");

  ASSERT_TRUE(root) << root.error().message;
  EXPECT_EQ(root->name, "a");
  EXPECT_EQ(root->attributes.at(1), (std::pair<std::string, std::string>("k", "1 < 2")));
  EXPECT_EQ(root->text_of("b"), "x & °€");
  EXPECT_EQ(root->children.size(), 3u);
  EXPECT_EQ(root->text, "<raw>");
  EXPECT_NE(root->child("c"), nullptr);
  EXPECT_EQ(root->child("d"), nullptr);
}

struct HostileXml {
  const char* name;
  std::string text, sentence;
};
void PrintTo(const HostileXml& hostile, std::ostream* out) {
  *out << hostile.name;
}

class XmlTreeRejects : public ::testing::TestWithParam<HostileXml> {};

TEST_P(XmlTreeRejects, WithASentence) {
  const auto root = parse_xml(GetParam().text);

  ASSERT_FALSE(root);
  EXPECT_EQ(root.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(root.error().message, HasSubstr(GetParam().sentence));
  EXPECT_LT(root.error().message.size(), 300u);
}

std::string repeated(std::string_view text, int times) {
  std::string out;
  for (int i = 0; i < times; ++i) out += text;
  return out;
}

INSTANTIATE_TEST_SUITE_P(
    Hostile, XmlTreeRejects,
    ::testing::Values(
        HostileXml{"EntityBomb", "<!DOCTYPE l [<!ENTITY a \"ha\"><!ENTITY b \"&a;&a;&a;&a;\">]><l>&b;</l>",
                   "document type declaration"},
        HostileXml{"ExternalEntity", "<?xml version=\"1.0\"?>\n<!DOCTYPE l SYSTEM \"file:///etc/passwd\"><l/>",
                   "line 2: a document type declaration"},
        HostileXml{"UnknownEntity", "<l>&bomb;</l>", "an entity that XML does not define"},
        HostileXml{"DeepNesting", repeated("<a>", 100000), "nested more than 64 deep"},
        HostileXml{"ManyElements", "<a>" + repeated("<b/>", 200000) + "</a>", "more than 100000 elements"},
        HostileXml{"LargeText", "<a>" + std::string(9u << 20, 'x') + "</a>", "larger than 8 MiB"},
        HostileXml{"ForbiddenCharacter", "<a>&#0;</a>", "an entity that XML does not define"},
        HostileXml{"WrongEnd", "<a><b></a></b>", "expected </b>, found </a>"},
        HostileXml{"NoEnd", "<a>\n<b>", "line 2: <b> has no end"},
        HostileXml{"TwoRoots", "<a/><b/>", "something follows the root element"},
        HostileXml{"NoQuote", "<a k=1/>", "expected a quoted value of k"},
        HostileXml{"Empty", "", "expected an element"},
        HostileXml{"Binary", std::string("<a>\0</a>", 8), "not a text in UTF-8"}),
    [](const auto& row) { return std::string(row.param.name); });

}  // namespace
}  // namespace todbench
