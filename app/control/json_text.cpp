#include "app/control/json_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

namespace gs::app {
namespace {

constexpr std::size_t kDeepest = 64;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Parses the four digits of an escape such as "\u12AB". Returns -1 unless there are four hexadecimal digits.
int code_unit(const char* at, const char* end) {
  if (end - at < 4) return -1;
  unsigned value = 0;
  const auto result = std::from_chars(at, at + 4, value, 16);
  return result.ec == std::errc() && result.ptr == at + 4 ? static_cast<int>(value) : -1;
}

void append_utf8(std::string& out, unsigned code) {
  if (code < 0x80) {
    out += static_cast<char>(code);
    return;
  }
  const int more = code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;
  constexpr unsigned kLead[] = {0, 0xc0, 0xe0, 0xf0};
  out += static_cast<char>(kLead[more] | code >> (6 * more));
  for (int i = more - 1; i >= 0; --i) out += static_cast<char>(0x80 | (code >> (6 * i) & 0x3f));
}

/// Checker that reads the text once. Stores one bit per nesting level.
class Checker {
 public:
  explicit Checker(std::string_view text) : begin_(text.data()), at_(begin_), end_(begin_ + text.size()) {}

  std::optional<JsonProblem> check() {
    bool good = value();
    while (good && depth_ > 0) good = go_on();
    if (!good) return problem_;
    blanks();
    if (at_ != end_) (void)fail("trailing characters after the value");
    return problem_;
  }

 private:
  bool fail(const char* why) {
    problem_ = JsonProblem{static_cast<std::size_t>(at_ - begin_), why};
    return false;
  }
  void blanks() {
    while (at_ != end_ && is_blank(*at_)) ++at_;
  }
  [[nodiscard]] bool is(char c) const { return at_ != end_ && *at_ == c; }

  // Checks a complete value, or only the start of a list or object.
  bool value() {
    blanks();
    if (at_ == end_) return fail("the text ends before a value");
    switch (*at_) {
      case '[':
      case '{': {
        if (depth_ == kDeepest) return fail("lists and objects are nested too deeply");
        is_object_[depth_++] = *at_ == '{';
        first_ = true;
        ++at_;
        return true;
      }
      case '"':
        return string();
      case 't':
        return word("true");
      case 'f':
        return word("false");
      case 'n':
        return word("null");
      default:
        return number();
    }
  }
  // Continues in the innermost list or object. Checks its next value, or its end.
  bool go_on() {
    const bool object = is_object_[depth_ - 1];
    blanks();
    const bool first = first_;
    first_ = false;
    if (is(object ? '}' : ']')) {
      ++at_;
      --depth_;
      return true;
    }
    if (!first) {
      if (!is(',')) return fail(object ? "expected , or }" : "expected , or ]");
      ++at_;
      blanks();
    }
    if (!object) return value();
    if (!is('"')) return fail("expected the name of a member");
    if (!string()) return false;
    blanks();
    if (!is(':')) return fail("expected :");
    ++at_;
    return value();
  }
  bool word(std::string_view expected) {
    if (!std::string_view(at_, static_cast<std::size_t>(end_ - at_)).starts_with(expected))
      return fail("expected a value");
    at_ += expected.size();
    return true;
  }
  bool digits() {
    if (at_ == end_ || !is_digit(*at_)) return fail("expected a digit");
    while (at_ != end_ && is_digit(*at_)) ++at_;
    return true;
  }
  bool number() {
    if (is('-')) {
      ++at_;
    } else if (!is_digit(*at_)) {
      return fail("expected a value");
    }
    if (is('0')) {
      ++at_;
      if (at_ != end_ && is_digit(*at_)) return fail("a number starts with 0");
    } else if (!digits()) {
      return false;
    }
    if (is('.')) {
      ++at_;
      if (!digits()) return false;
    }
    if (is('e') || is('E')) {
      ++at_;
      if (is('+') || is('-')) ++at_;
      return digits();
    }
    return true;
  }
  bool string() {
    for (++at_; at_ != end_; ++at_) {
      const auto c = static_cast<unsigned char>(*at_);
      if (c == '"') {
        ++at_;
        return true;
      }
      if (c < 0x20) return fail("a string contains a control character");
      if (c != '\\') continue;
      ++at_;
      if (at_ == end_) break;
      if (*at_ == 'u') {
        if (code_unit(at_ + 1, end_) < 0) return fail("expected four hexadecimal digits");
        at_ += 4;
      } else if (std::strchr("\"\\/bfnrt", *at_) == nullptr) {
        return fail("unknown escape sequence");
      }
    }
    return fail("the text ends inside a string");
  }

  const char *begin_, *at_, *end_;
  bool is_object_[kDeepest] = {};
  std::size_t depth_ = 0;
  bool first_ = false;  // true if the innermost list or object has no value yet
  std::optional<JsonProblem> problem_;
};

}  // namespace

std::optional<JsonProblem> check_json(std::string_view text) { return Checker(text).check(); }

void JsonCursor::skip_blanks() {
  while (at_ != end_ && is_blank(*at_)) ++at_;
}

JsonKind JsonCursor::kind() {
  skip_blanks();
  switch (*at_) {
    case '{':
      return JsonKind::object;
    case '[':
      return JsonKind::list;
    case '"':
      return JsonKind::string;
    case 't':
    case 'f':
      return JsonKind::boolean;
    case 'n':
      return JsonKind::null;
    default:
      return JsonKind::number;
  }
}

bool JsonCursor::boolean() {
  skip_blanks();
  const bool value = *at_ == 't';
  at_ += value ? 4 : 5;
  return value;
}

double JsonCursor::number() {
  skip_blanks();
  double value = 0;
  const auto result = std::from_chars(at_, end_, value);
  if (result.ec == std::errc::result_out_of_range) {
    // The number is out of range. It is too small if its exponent is negative; without exponent, if it begins with
    // "0.". Otherwise it is too large.
    const std::string_view text(at_, static_cast<std::size_t>(result.ptr - at_));
    const std::size_t exponent = text.find_first_of("eE");
    const bool small = exponent != std::string_view::npos ? text.substr(exponent + 1).starts_with('-')
                                                          : text.starts_with("0.") || text.starts_with("-0.");
    value = small ? 0 : text.starts_with('-') ? -HUGE_VAL : HUGE_VAL;
  }
  at_ = result.ptr;
  return value;
}

std::string_view JsonCursor::string(std::string& made) {
  skip_blanks();
  const char* const first = ++at_;
  while (*at_ != '"' && *at_ != '\\') ++at_;
  if (*at_ == '"') return {first, static_cast<std::size_t>(at_++ - first)};
  made.assign(first, at_);
  for (; *at_ != '"'; ++at_) {
    if (*at_ != '\\') {
      made += *at_;
      continue;
    }
    ++at_;
    if (*at_ == 'u') {
      auto code = static_cast<unsigned>(code_unit(at_ + 1, end_));
      at_ += 4;
      if (code >= 0xd800 && code < 0xdc00 && at_[1] == '\\' && at_[2] == 'u') {
        const auto low = static_cast<unsigned>(code_unit(at_ + 3, end_));
        if (low >= 0xdc00 && low < 0xe000) {
          code = 0x10000 + ((code - 0xd800) << 10) + (low - 0xdc00);
          at_ += 6;
        }
      }
      /// Half of a surrogate pair is no character and becomes U+FFFD.
      append_utf8(made, code >= 0xd800 && code < 0xe000 ? 0xfffd : code);
    } else {
      constexpr std::string_view kEscapes = "bfnrt", kMeant = "\b\f\n\r\t";
      const std::size_t known = kEscapes.find(*at_);
      made += known == std::string_view::npos ? *at_ : kMeant[known];
    }
  }
  ++at_;
  return made;
}

void JsonCursor::open() {
  skip_blanks();
  ++at_;
}

bool JsonCursor::more() {
  skip_blanks();
  if (*at_ == ',') ++at_;
  skip_blanks();
  if (*at_ != ']' && *at_ != '}') return true;
  ++at_;
  return false;
}

std::string_view JsonCursor::name(std::string& made) {
  const std::string_view text = string(made);
  skip_blanks();
  ++at_;  // skip the colon
  return text;
}

std::string_view JsonCursor::skip() {
  skip_blanks();
  const char* const first = at_;
  std::size_t depth = 0;
  do {
    const char c = *at_++;
    if (c == '"') {
      for (; *at_ != '"'; ++at_)
        if (*at_ == '\\') ++at_;
      ++at_;
    } else if (c == '[' || c == '{') {
      ++depth;
    } else if (c == ']' || c == '}') {
      --depth;
    } else if (depth == 0) {
      while (at_ != end_ && !is_blank(*at_) && *at_ != ',' && *at_ != ']' && *at_ != '}') ++at_;
    }
  } while (depth > 0);
  return {first, static_cast<std::size_t>(at_ - first)};
}

void append_json_string(std::string& out, std::string_view text) {
  out += '"';
  for (std::size_t i = 0; i < text.size();) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (c >= 0x20 && c < 0x7f) {
      if (c == '"' || c == '\\') out += '\\';
      out += static_cast<char>(c);
      ++i;
    } else if (c < 0x80) {
      constexpr char kDigits[] = "0123456789abcdef";
      out += "\\u00";
      out += kDigits[c >> 4];
      out += kDigits[c & 15];
      ++i;
    } else {
      // Length of the UTF-8 character that this byte begins, or 0 (RFC 3629). Invalid bytes may follow.
      const std::size_t size = c >= 0xc2 && c <= 0xdf ? 2 : c >= 0xe0 && c <= 0xef ? 3 : c >= 0xf0 && c <= 0xf4 ? 4 : 0;
      bool good = size != 0 && i + size <= text.size();
      for (std::size_t j = 1; good && j < size; ++j) good = (static_cast<unsigned char>(text[i + j]) & 0xc0) == 0x80;
      if (good && size > 2) {
        const auto next = static_cast<unsigned char>(text[i + 1]);
        good = !(c == 0xe0 && next < 0xa0) && !(c == 0xed && next > 0x9f) && !(c == 0xf0 && next < 0x90) &&
               !(c == 0xf4 && next > 0x8f);
      }
      if (good) {
        out += text.substr(i, size);
        i += size;
      } else {
        append_utf8(out, 0xfffd);
        ++i;
      }
    }
  }
  out += '"';
}

namespace {

template <class Number>
void append_shortest(std::string& out, Number number) {
  if (!std::isfinite(number)) {
    out += std::isnan(number) ? "\"NaN\"" : number > 0 ? "\"Infinity\"" : "\"-Infinity\"";
    return;
  }
  char digits[64];
  out.append(digits, std::to_chars(digits, digits + sizeof digits, number).ptr);
}

}  // namespace

void append_json_number(std::string& out, double number) { append_shortest(out, number); }
void append_json_number(std::string& out, float number) { append_shortest(out, number); }

}  // namespace gs::app
