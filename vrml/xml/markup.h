#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace gs::vrml::xml {

/// Kind of a part of an XML text.
enum class MarkupKind : std::uint8_t {
  need_more,  // the part continues after the available bytes
  text,       // characters between markup
  tag,        // start tag, end tag or empty element
  cdata,      // CDATA section
  doctype,    // document type declaration
  other,      // comment, processing instruction or XML declaration
};

/// Value of an attribute in a tag.
struct AttributeSpan {
  std::size_t begin = 0, end = 0;  // offsets in the tag, without the quotes
  bool is_long = false;            // a long value without markup, which the reader parses itself
};

/// Part of an XML text. It refers to the text.
struct Markup {
  MarkupKind kind = MarkupKind::need_more;
  std::string_view text;     // all bytes of the part
  std::string_view content;  // for cdata: the characters in the section
};

/// Splitter of UTF-8 text into markup. It does not check whether the text is well-formed. One thread.
class MarkupScanner {
 public:
  /// Returns the part at the start of `text`, which must not be empty. After need_more, the next text must begin with
  /// the same bytes.
  [[nodiscard]] Markup next(std::string_view text);

  /// Returns the values of the attributes in the last tag, in order.
  [[nodiscard]] const std::vector<AttributeSpan>& attributes() const { return attributes_; }
  /// Reports whether the last tag has a long value.
  [[nodiscard]] bool has_long_values() const { return has_long_values_; }
  /// Returns a tag without its long values.
  void append_skeleton(std::string_view tag, std::string& out) const;

 private:
  [[nodiscard]] std::size_t tag_size(std::string_view text);

  std::vector<AttributeSpan> attributes_;
  bool has_long_values_ = false;
  std::size_t open_value_ = 0;  // incomplete tag: offset of the quote of its open value; 0 if there is none
  std::size_t searched_ = 0;    // incomplete tag: bytes without the end of that value
};

}  // namespace gs::vrml::xml
