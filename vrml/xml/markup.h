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
  std::size_t begin = 0, end = 0;            // offsets in the tag, without the quotes
  std::size_t name_begin = 0, name_end = 0;  // offsets of the name; only in plain tags
  bool is_long = false;                      // a long value without markup, which the reader parses itself
  std::size_t line_start = 0;                // long value: offset after its last line feed
  std::uint32_t lines = 0;                   // long value: number of line feeds
  bool has_breaks = false;                   // a short value with tabs or line breaks, which XML replaces by blanks
};

/// Part of an XML text. It refers to the text.
struct Markup {
  MarkupKind kind = MarkupKind::need_more;
  std::string_view text;     // all bytes of the part
  std::string_view content;  // for cdata: the characters in the section
};

/// Splitter of UTF-8 text into markup. It does not check whether the text is well-formed, except for plain tags.
///
/// A plain tag is well-formed (XML 1.0, productions 40 to 44), as far as one tag can show. It has only ASCII characters
/// outside of its long values, no references, and no attribute twice. Most tags of scenes are plain. One thread.
class MarkupScanner {
 public:
  /// Returns the part at the start of `text`, which must not be empty. After need_more, the next text must begin with
  /// the same bytes.
  [[nodiscard]] Markup next(std::string_view text);

  /// Reports whether the last tag is plain. The next functions may be called only for plain tags.
  [[nodiscard]] bool is_plain() const { return is_plain_; }
  [[nodiscard]] std::string_view name(std::string_view tag) const { return tag.substr(name_begin_, name_size_); }
  [[nodiscard]] static bool is_end_tag(std::string_view tag) { return tag[1] == '/'; }
  [[nodiscard]] static bool is_empty_element(std::string_view tag) { return tag[tag.size() - 2] == '/'; }

  /// Returns the values of the attributes in the last tag, in order.
  [[nodiscard]] const std::vector<AttributeSpan>& attributes() const { return attributes_; }
  /// Reports whether the last tag has a long value.
  [[nodiscard]] bool has_long_values() const { return has_long_values_; }
  /// Returns a tag without its long values.
  void append_skeleton(std::string_view tag, std::string& out) const;

 private:
  [[nodiscard]] std::size_t tag_size(std::string_view text);
  [[nodiscard]] std::size_t end_tag_size(std::string_view text);
  void read_name(std::string_view text, std::size_t begin);
  [[nodiscard]] bool pass_plain(std::string_view text, std::size_t& at);
  [[nodiscard]] bool pass_value(std::string_view text, std::size_t& at);
  [[nodiscard]] std::size_t end_of_long_value(std::string_view text, std::size_t from, char quote);
  void check_names(std::string_view tag);

  std::vector<AttributeSpan> attributes_;
  AttributeSpan attribute_;                     // name of the attribute that is read
  std::size_t name_begin_ = 0, name_size_ = 0;  // name of the element
  bool is_plain_ = false;
  bool has_long_values_ = false;
  std::size_t open_value_ = 0;  // incomplete tag: offset of the quote of its open value; 0 if there is none
  std::size_t searched_ = 0;    // incomplete tag: bytes without the end of that value
};

}  // namespace gs::vrml::xml
