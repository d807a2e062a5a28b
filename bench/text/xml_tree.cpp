// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/text/xml_tree.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include "acquisition/base/safe_text.h"
#include "acquisition/base/try.h"

namespace todbench {
namespace {

constexpr std::string_view blanks = " \t\r\n";

bool is_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
         c == '.' || c == ':' || static_cast<unsigned char>(c) >= 0x80;
}

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(blanks) - first + 1));
}

void append_utf8(std::string& out, unsigned code) {
  const auto byte = [&out](unsigned value) { out.push_back(static_cast<char>(value)); };
  if (code < 0x80) return byte(code);
  if (code < 0x800) {
    byte(0xc0 | (code >> 6));
  } else if (code < 0x10000) {
    byte(0xe0 | (code >> 12));
    byte(0x80 | ((code >> 6) & 0x3f));
  } else {
    byte(0xf0 | (code >> 18));
    byte(0x80 | ((code >> 12) & 0x3f));
    byte(0x80 | ((code >> 6) & 0x3f));
  }
  byte(0x80 | (code & 0x3f));
}

/// The five entities of XML and characters by number. Others need a declaration.
std::optional<std::string> entity(std::string_view name) {
  if (name == "amp") return "&";
  if (name == "lt") return "<";
  if (name == "gt") return ">";
  if (name == "quot") return "\"";
  if (name == "apos") return "'";
  if (!name.starts_with('#')) return std::nullopt;
  const bool hex = name.starts_with("#x");
  name.remove_prefix(hex ? 2 : 1);
  unsigned code = 0;
  const auto [end, problem] = std::from_chars(name.data(), name.data() + name.size(), code, hex ? 16 : 10);
  if (problem != std::errc() || end != name.data() + name.size()) return std::nullopt;
  const bool possible = code >= 0x20 || code == '\t' || code == '\n' || code == '\r';
  if (!possible || code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) return std::nullopt;
  std::string out;
  append_utf8(out, code);
  return out;
}

class XmlParser {
 public:
  XmlParser(std::string_view text, const XmlLimits& limits) : text_(text), limits_(limits) {}

  Result<XmlElement> document() {
    if (text_.starts_with("\xef\xbb\xbf")) at_ = 3;
    TODBENCH_TRY_VOID(skip_between());
    if (!next_is("<")) return wrong("expected an element");
    TODBENCH_TRY(XmlElement root, element(1));
    TODBENCH_TRY_VOID(skip_between());
    if (at_ != text_.size()) return wrong("something follows the root element");
    return root;
  }

 private:
  [[nodiscard]] bool next_is(std::string_view word) const { return text_.substr(at_).starts_with(word); }
  [[nodiscard]] tl::unexpected<Error> wrong(const std::string& why) const {
    const auto line = 1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(at_), '\n');
    return fail(ErrorCode::invalid_input, "line " + std::to_string(line) + ": " + why);
  }
  void skip_blanks() { at_ = std::min(text_.find_first_not_of(blanks, at_), text_.size()); }

  Result<void> skip_past(std::string_view end) {
    const auto found = text_.find(end, at_);
    if (found == std::string_view::npos) return wrong("expected " + std::string(end));
    at_ = found + end.size();
    return {};
  }

  /// Skips a comment or a processing instruction; false: another thing stands here.
  Result<bool> skip_remark() {
    if (!next_is("<!--") && !next_is("<?")) return false;
    const bool comment = next_is("<!--");
    at_ += comment ? 4 : 2;
    TODBENCH_TRY_VOID(skip_past(comment ? "-->" : "?>"));
    return true;
  }

  /// Skips blanks and remarks outside the root element.
  Result<void> skip_between() {
    for (;;) {
      skip_blanks();
      if (next_is("<!DOCTYPE")) return wrong("a document type declaration is not read: it can define entities");
      TODBENCH_TRY(const auto skipped, skip_remark());
      if (!skipped) return {};
    }
  }

  Result<std::string> name() {
    const std::size_t first = at_;
    while (at_ < text_.size() && is_name(text_[at_])) ++at_;
    if (at_ == first) return wrong("expected a name");
    return std::string(text_.substr(first, at_ - first));
  }

  Result<std::string> decoded(std::string_view raw) {
    std::string out;
    for (std::size_t i = 0; i < raw.size(); ++i) {
      if (raw[i] != '&') {
        out.push_back(raw[i]);
        continue;
      }
      const auto end = raw.find(';', i);
      const auto character = end == std::string_view::npos ? std::nullopt : entity(raw.substr(i + 1, end - i - 1));
      if (!character) return wrong("an entity that XML does not define: " + one_line(raw.substr(i, 20)));
      out += *character;
      i = end;
    }
    return out;
  }

  Result<void> attributes(XmlElement& element) {
    for (;;) {
      skip_blanks();
      if (next_is(">") || next_is("/>")) return {};
      TODBENCH_TRY(const std::string key, name());
      skip_blanks();
      if (!next_is("=")) return wrong("expected = after " + one_line(key));
      ++at_;
      skip_blanks();
      if (!next_is("\"") && !next_is("'")) return wrong("expected a quoted value of " + one_line(key));
      const char quote = text_[at_++];
      const auto end = text_.find(quote, at_);
      if (end == std::string_view::npos) return wrong("the value of " + one_line(key) + " has no end");
      TODBENCH_TRY(std::string value, decoded(text_.substr(at_, end - at_)));
      at_ = end + 1;
      if (++elements_ > limits_.elements) return too_many();
      element.attributes.emplace_back(key, std::move(value));
    }
  }

  [[nodiscard]] tl::unexpected<Error> too_many() const {
    return wrong("more than " + std::to_string(limits_.elements) + " elements and attributes");
  }

  Result<XmlElement> element(int depth) {
    if (depth > limits_.depth) return wrong("elements are nested more than " + std::to_string(limits_.depth) + " deep");
    if (++elements_ > limits_.elements) return too_many();
    ++at_;  // <
    TODBENCH_TRY(const std::string tag, name());
    XmlElement out;
    out.name = tag.substr(tag.find(':') + 1);  // npos + 1 is 0
    TODBENCH_TRY_VOID(attributes(out));
    if (next_is("/>")) {
      at_ += 2;
      return out;
    }
    ++at_;  // >
    TODBENCH_TRY_VOID(content(out, tag, depth));
    out.text = trimmed(out.text);
    return out;
  }

  Result<void> content(XmlElement& out, const std::string& tag, int depth) {
    for (;;) {
      const auto mark = text_.find('<', at_);
      if (mark == std::string_view::npos) return wrong("<" + one_line(tag) + "> has no end");
      TODBENCH_TRY(const std::string between, decoded(text_.substr(at_, mark - at_)));
      out.text += between;
      at_ = mark;
      if (next_is("</")) return end_of(tag);
      if (next_is("<![CDATA[")) {
        const std::size_t first = at_ + 9;
        TODBENCH_TRY_VOID(skip_past("]]>"));
        out.text += text_.substr(first, at_ - 3 - first);
        continue;
      }
      TODBENCH_TRY(const bool remark, skip_remark());
      if (remark) continue;
      TODBENCH_TRY(XmlElement inner, element(depth + 1));
      out.children.push_back(std::move(inner));
    }
  }

  Result<void> end_of(const std::string& tag) {
    at_ += 2;
    TODBENCH_TRY(const std::string closed, name());
    skip_blanks();
    if (closed != tag || !next_is(">"))
      return wrong("expected </" + one_line(tag) + ">, found </" + one_line(closed) + ">");
    ++at_;
    return {};
  }

  std::string_view text_;
  XmlLimits limits_;
  std::size_t at_ = 0, elements_ = 0;
};

}  // namespace

const XmlElement* XmlElement::child(std::string_view wanted) const {
  const auto found =
      std::find_if(children.begin(), children.end(), [&](const XmlElement& one) { return one.name == wanted; });
  return found == children.end() ? nullptr : &*found;
}

std::string XmlElement::text_of(std::string_view wanted) const {
  const XmlElement* found = child(wanted);
  return found == nullptr ? std::string() : found->text;
}

Result<XmlElement> parse_xml(std::string_view text, const XmlLimits& limits) {
  if (text.size() > limits.bytes)
    return fail(ErrorCode::invalid_input, "larger than " + std::to_string(limits.bytes >> 20) + " MiB");
  if (text.find('\0') != std::string_view::npos) return fail(ErrorCode::invalid_input, "not a text in UTF-8");
  return XmlParser(text, limits).document();
}

}  // namespace todbench
