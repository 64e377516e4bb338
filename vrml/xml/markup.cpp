#include "vrml/xml/markup.h"

#include <algorithm>
#include <utility>

namespace gs::vrml::xml {
namespace {

// Minimum length of a value that the XML parser does not see.
constexpr std::size_t kLongValue = 128;

constexpr std::size_t kNone = std::string_view::npos;

// Returns the size of the part that ends with `mark`; 0 if it is incomplete.
std::size_t size_until(std::string_view text, std::size_t from, std::string_view mark) {
  const std::size_t at = text.find(mark, from);
  return at == kNone ? 0 : at + mark.size();
}

// Returns the size of a document type declaration with its internal subset; 0 if it is incomplete.
std::size_t doctype_size(std::string_view text) {
  bool in_subset = false;
  for (std::size_t i = 2; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"' || c == '\'') {
      i = text.find(c, i + 1);
    } else if (text.compare(i, 4, "<!--") == 0) {
      i = text.find("-->", i + 4);
    } else if (text.compare(i, 2, "<?") == 0) {
      i = text.find("?>", i + 2);
    } else if (c == '[' || c == ']') {
      in_subset = c == '[';
    } else if (c == '>' && !in_subset) {
      return i + 1;
    }
    if (i == kNone) return 0;
  }
  return 0;
}

}  // namespace

// Returns the size of a tag, and finds its attributes. Returns 0 if the tag is incomplete; the next call then continues
// in the value that was open.
std::size_t MarkupScanner::tag_size(std::string_view text) {
  std::size_t i = std::exchange(open_value_, 0);
  const std::size_t searched = std::exchange(searched_, 0);
  if (i == 0) {
    attributes_.clear();
    has_long_values_ = false;
    if (text[1] == '/') return text.find('>') + 1;
    i = 1;
  }
  while (i < text.size()) {
    const char c = text[i];
    if (c == '>') return i + 1;
    if (c != '"' && c != '\'') {
      ++i;
      continue;
    }
    const std::size_t end = text.find(c, std::max(i + 1, searched));
    if (end == kNone) {
      open_value_ = i;
      searched_ = text.size();
      return 0;
    }
    AttributeSpan span{i + 1, end, false};
    if (end - i > kLongValue) {
      const std::string_view value = text.substr(span.begin, end - span.begin);
      span.is_long = value.find('&') == kNone && value.find('<') == kNone;
      has_long_values_ |= span.is_long;
    }
    attributes_.push_back(span);
    i = end + 1;
  }
  return 0;
}

void MarkupScanner::append_skeleton(std::string_view tag, std::string& out) const {
  std::size_t from = 0;
  for (const AttributeSpan& span : attributes_) {
    if (!span.is_long) continue;
    out += tag.substr(from, span.begin - from);
    from = span.end;
  }
  out += tag.substr(from);
}

Markup MarkupScanner::next(std::string_view text) {
  Markup markup;
  const auto found = [&](MarkupKind kind, std::size_t size) {
    markup.kind = size == 0 ? MarkupKind::need_more : kind;
    markup.text = text.substr(0, size);
    return markup;
  };
  if (text.front() != '<') {
    const std::size_t end = text.find('<');
    return found(MarkupKind::text, end == kNone ? 0 : end);
  }
  if (text.size() < 2) return markup;
  if (text[1] == '?') return found(MarkupKind::other, size_until(text, 2, "?>"));
  if (text[1] != '!') return found(MarkupKind::tag, tag_size(text));
  constexpr std::string_view kComment = "<!--", kCdata = "<![CDATA[";
  if (text.starts_with(kComment)) return found(MarkupKind::other, size_until(text, kComment.size(), "-->"));
  if (text.starts_with(kCdata)) {
    const std::size_t size = size_until(text, kCdata.size(), "]]>");
    if (size > 0) markup.content = text.substr(kCdata.size(), size - kCdata.size() - 3);
    return found(MarkupKind::cdata, size);
  }
  if (kCdata.starts_with(text) || kComment.starts_with(text)) return markup;
  return found(MarkupKind::doctype, doctype_size(text));
}

}  // namespace gs::vrml::xml
