#include "vrml/xml/markup.h"

#include "vrml/x3d/value_text.h"

#include <algorithm>
#include <array>
#include <utility>

namespace gs::vrml::xml {
namespace {

// Minimum length of a value that bypasses Expat.
constexpr std::size_t kLongValue = 128;

// Maximum length of the element's name, and maximum number of attributes, in a plain tag.
constexpr std::size_t kMaxPlainName = 256, kMaxPlainAttributes = 32;

constexpr std::size_t kNone = std::string_view::npos;

// Bits of characters in a tag.
enum TagClass : std::uint8_t { name_start = 1, name_part = 2, blank = 4, line_break = 8, not_plain = 16 };

constexpr std::array<std::uint8_t, 256> kTagClass = [] {
  std::array<std::uint8_t, 256> table{};
  for (int c = 0; c < 256; ++c)
    if (c < 0x20 || c >= 0x80) table[c] = not_plain;
  for (const char c : {'\t', '\n', '\r'}) table[static_cast<unsigned char>(c)] = blank | line_break;
  for (int c = 'A'; c <= 'Z'; ++c) table[c] = table[c - 'A' + 'a'] = name_start | name_part;
  for (int c = '0'; c <= '9'; ++c) table[c] = name_part;
  table['_'] = table[':'] = name_start | name_part;
  table['-'] = table['.'] = name_part;
  table['&'] = table['<'] = not_plain;
  table[' '] = blank;
  return table;
}();

unsigned tag_class(char c) { return kTagClass[static_cast<unsigned char>(c)]; }

// Returns the first position from `at` without a character of the class.
std::size_t pass_class(std::string_view text, std::size_t at, TagClass passed) {
  while (at < text.size() && (tag_class(text[at]) & passed) != 0) ++at;
  return at;
}

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

void MarkupScanner::read_name(std::string_view text, std::size_t begin) {
  name_begin_ = begin;
  name_size_ = pass_class(text, begin, name_part) - begin;
  is_plain_ = name_size_ > 0 && name_size_ <= kMaxPlainName && (tag_class(text[begin]) & name_start) != 0;
}

std::size_t MarkupScanner::end_tag_size(std::string_view text) {
  const std::size_t end = text.find('>');
  if (end == kNone) return 0;
  read_name(text, 2);
  is_plain_ = is_plain_ && pass_class(text, name_begin_ + name_size_, blank) == end;
  return end + 1;
}

// Returns the end of a long value; `from` is a position in it. Returns kNone if the end is missing. Examines a block of
// bytes several times while it is in the processor's cache.
std::size_t MarkupScanner::end_of_long_value(std::string_view text, std::size_t from, char quote) {
  constexpr std::size_t kBlock = 4096;
  for (std::size_t at = from; at < text.size(); at += kBlock) {
    std::string_view block = text.substr(at, kBlock);
    const std::size_t end = block.find(quote);
    block = block.substr(0, end);
    attribute_.is_long = attribute_.is_long && block.find('&') == kNone && block.find('<') == kNone;
    if (block.find('\n') != kNone) {
      attribute_.lines += x3d::count_lines(block);
      attribute_.line_start = at + block.rfind('\n') + 1;
    }
    if (end != kNone) return at + end;
  }
  return kNone;
}

// Passes the value behind the quote at `at`. Returns false if its end is missing; the next call of tag_size() then
// continues there.
bool MarkupScanner::pass_value(std::string_view text, std::size_t& at) {
  const char quote = text[at];
  const std::size_t begin = at + 1, short_end = std::min(text.size(), begin + kLongValue);
  std::size_t end = std::max(begin, std::exchange(searched_, 0));
  unsigned classes = 0;
  if (end == begin) {
    for (; end < short_end && text[end] != quote; ++end) classes |= tag_class(text[end]);
    if (end == begin + kLongValue) {
      attribute_.is_long = true;
      attribute_.lines = 0;
      end = end_of_long_value(text, begin, quote);
      if (end == kNone) searched_ = text.size();
    }
  } else {
    end = end_of_long_value(text, end, quote);
    if (end == kNone) searched_ = text.size();
  }
  if (end == kNone || end == text.size()) {
    open_value_ = at;
    return false;
  }
  AttributeSpan span = attribute_;
  span.begin = begin;
  span.end = end;
  if (end - begin >= kLongValue) {
    has_long_values_ |= span.is_long;
    is_plain_ &= span.is_long;
  } else {
    span.is_long = false;
    span.has_breaks = (classes & line_break) != 0;
    is_plain_ &= (classes & not_plain) == 0;
  }
  attributes_.push_back(span);
  at = end + 1;
  return true;
}

// Passes the blanks at `at`, and the next attribute or the slash of an empty element. Clears is_plain_ before other
// text. Returns false if the tag is incomplete.
bool MarkupScanner::pass_plain(std::string_view text, std::size_t& at) {
  const std::size_t begin = pass_class(text, at, blank);
  if (begin == text.size()) return false;
  if (text[begin] == '/' && begin + 1 == text.size()) return false;
  if (text[begin] == '>' || text[begin] == '/') {
    is_plain_ = text[begin] == '>' || text[begin + 1] == '>';
    at = begin + (text[begin] == '/');
    return true;
  }
  is_plain_ = begin > at && (tag_class(text[begin]) & name_start) != 0;
  if (!is_plain_) return true;
  attribute_.name_begin = begin;
  attribute_.name_end = pass_class(text, begin, name_part);
  at = pass_class(text, attribute_.name_end, blank);
  if (at == text.size()) return false;
  is_plain_ = text[at] == '=';
  if (!is_plain_) return true;
  at = pass_class(text, at + 1, blank);
  if (at == text.size()) return false;
  is_plain_ = text[at] == '"' || text[at] == '\'';
  if (!is_plain_) return true;
  return pass_value(text, at);
}

// Clears is_plain_ if two attributes may have the same name.
void MarkupScanner::check_names(std::string_view tag) {
  is_plain_ &= attributes_.size() <= kMaxPlainAttributes;
  std::uint64_t seen = 0;
  for (std::size_t i = 0; i < attributes_.size() && is_plain_; ++i) {
    const auto name_of = [&](std::size_t n) {
      return tag.substr(attributes_[n].name_begin, attributes_[n].name_end - attributes_[n].name_begin);
    };
    const std::string_view name = name_of(i);
    const auto digest = static_cast<unsigned>(name.size() * 7) ^ static_cast<unsigned char>(name.front());
    const std::uint64_t bit = std::uint64_t{1} << (digest & 63);
    for (std::size_t j = 0; (seen & bit) != 0 && j < i; ++j) is_plain_ &= name_of(j) != name;
    seen |= bit;
  }
}

// Returns the size of a tag, and finds its attributes. Returns 0 if the tag is incomplete; the next call then continues
// in the value that was open.
std::size_t MarkupScanner::tag_size(std::string_view text) {
  std::size_t i = std::exchange(open_value_, 0);
  if (i != 0) {
    if (!pass_value(text, i)) return 0;
  } else {
    attributes_.clear();
    has_long_values_ = false;
    searched_ = 0;
    attribute_ = {};
    if (text[1] == '/') return end_tag_size(text);
    read_name(text, 1);
    i = 1 + name_size_;
  }
  while (i < text.size()) {
    if (text[i] == '>') {
      if (is_plain_) check_names(text);
      return i + 1;
    }
    if (is_plain_) {
      if (!pass_plain(text, i)) return 0;
    } else if (text[i] == '"' || text[i] == '\'') {
      if (!pass_value(text, i)) return 0;
    } else {
      ++i;
    }
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
