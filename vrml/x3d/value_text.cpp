#include "vrml/x3d/value_text.h"

#include "vrml/scene/values/field_numbers.h"
#include "vrml/syntax/numbers/number.h"
#include "vrml/syntax/tokens/lexer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>
#include <variant>

namespace gs::vrml::x3d {
namespace {

// Numbers on the stack, so that memory for short lists is allocated once, with the exact size. Divisible by the counts
// of numbers of all elements.
constexpr std::size_t kShortRun = 720;
constexpr std::size_t kLongRun = 16 * 1024;  // elements

bool is_separator(char c) { return c == ' ' || c == ',' || c == '\n' || c == '\t' || c == '\r'; }

NumberRun fast_run(const char* begin, const char* end, float* out, std::size_t count) {
  return parse_floats(begin, end, out, count);
}
NumberRun fast_run(const char* begin, const char* end, std::int32_t* out, std::size_t count) {
  return parse_integers(begin, end, out, count);
}
NumberRun fast_run(const char* begin, const char*, const double*, std::size_t) { return {begin, 0, 0, nullptr}; }

}  // namespace

// Examines eight bytes at once, because long lists pass through it.
std::uint32_t count_lines(std::string_view text) {
  constexpr std::uint64_t kFeeds = 0x0a0a0a0a0a0a0a0a, kLow = 0x7f7f7f7f7f7f7f7f;
  std::uint32_t lines = 0;
  for (; text.size() >= 8; text.remove_prefix(8)) {
    std::uint64_t word = 0;
    std::memcpy(&word, text.data(), 8);
    word ^= kFeeds;
    // The high bit of each byte that is zero. No carry passes from one byte to the next.
    const std::uint64_t feeds = ~(((word & kLow) + kLow) | word | kLow);
    lines += static_cast<std::uint32_t>((feeds >> 7) * 0x0101010101010101 >> 56);
  }
  return lines + static_cast<std::uint32_t>(std::count(text.begin(), text.end(), '\n'));
}

SourceLocation location_in(std::string_view text, SourceLocation start, const char* p) {
  const auto before = text.substr(0, static_cast<std::size_t>(p - text.data()));
  const std::uint32_t lines = count_lines(before);
  if (lines == 0) return {start.line, start.column + static_cast<std::uint32_t>(before.size())};
  return {start.line + lines, static_cast<std::uint32_t>(before.size() - before.rfind('\n'))};
}

void unescape(std::string_view raw, std::string& out) {
  out.clear();
  for (std::size_t i = 0; i < raw.size(); ++i) {
    if (raw[i] == '\\' && i + 1 < raw.size() && (raw[i + 1] == '"' || raw[i + 1] == '\\')) ++i;
    out += raw[i];
  }
}

// Counts from the last position, because lists may contain millions of words that need one.
SourceLocation ValueReader::location_of(const char* p) {
  if (p < located_) {
    located_ = value_->text.data();
    location_ = value_->location;
  }
  location_ = location_in({located_, static_cast<std::size_t>(p - located_)}, location_, p);
  located_ = p;
  return location_;
}

void ValueReader::skip_separators() {
  while (next_ < end_ && is_separator(*next_)) ++next_;
}

std::string_view ValueReader::next_word() {
  skip_separators();
  const char* const begin = next_;
  while (next_ < end_ && !is_separator(*next_)) ++next_;
  return {begin, static_cast<std::size_t>(next_ - begin)};
}

String ValueReader::string_of(std::string_view text, SourceLocation location) {
  if (!sink_.limits().admits_string(text.size(), location)) return {};
  if (std::none_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) >= 0x80; }))
    return String(text);
  bool latin1 = false;
  const std::string decoded = decode_string(text, false, latin1);
  if (latin1) sink_.problems().warn_once(said_latin1_, location, "a string is not UTF-8; read as Latin-1");
  return String(decoded);
}

bool ValueReader::boolean_of(std::string_view word, SourceLocation location, bool& is_boolean) {
  const bool yes = word == "true" || word == "TRUE" || word == "True" || word == "1";
  const bool no = word == "false" || word == "FALSE" || word == "False" || word == "0";
  is_boolean = yes || no;
  if (is_boolean && word != "true" && word != "false")
    sink_.problems().warn_once(said_boolean_, location, "expected true or false, found " + quoted(word));
  return yes;
}

// Parses a number that the bulk readers cannot parse: at the end of the text, hexadecimal, or invalid.
template <class Number>
Number ValueReader::slow_number(std::string_view word) {
  Number number{};
  if (parse_number(word, number)) return number;
  std::int32_t integer = 0;
  double real = 0;
  if constexpr (std::is_same_v<Number, std::int32_t>) {
    if (parse_number(word, real) && !std::isnan(real)) {
      // Colours of images may exceed the range of signed integers.
      if (real != std::trunc(real) || real < 0 || real >= 4294967296.0)
        sink_.problems().warn_once(said_integer_, location_of(word.data()),
                                   "expected an integer of 32 bits, found " + quoted(word) + "; converted");
      if (real > 2147483647.0 && real < 4294967296.0)
        return static_cast<std::int32_t>(static_cast<std::uint32_t>(real));
      return static_cast<std::int32_t>(std::clamp(std::trunc(real), -2147483648.0, 2147483647.0));
    }
  } else {
    if (parse_number(word, integer)) return static_cast<Number>(integer);
    // Some exporters write floats of C, such as "1.5f".
    if (const std::size_t length = number_length(word); length > 0 && length + 1 == word.size())
      if (parse_number(word.substr(0, length), real)) return static_cast<Number>(real);
  }
  if (!std::exchange(said_number_, true))
    sink_.problems().error(location_of(word.data()), "expected a number for " + std::string(value_->name) + ", found " +
                                                         quoted(word) + "; 0 is used");
  return 0;
}

// Reads a short text of at most `count` plain numbers to its end, as read_numbers() does. Returns their count; 0 for
// other texts, of which it reads nothing. The copy ends with a separator, so that the bulk readers take all numbers.
template <class Number>
std::size_t ValueReader::read_short(Number* out, std::size_t count) {
  char copy[96];
  const auto size = static_cast<std::size_t>(end_ - next_);
  if (size >= sizeof copy) return 0;
  std::memcpy(copy, next_, size);
  copy[size] = ' ';
  const NumberRun run = fast_run(copy, copy + size + 1, out, count);
  if (!std::all_of(run.next, static_cast<const char*>(copy) + size, is_separator)) return 0;
  if (run.count > 0) next_ = end_;
  return run.count;
}

// Reads up to `count` numbers. Returns a smaller count at the end of the text.
template <class Number>
std::size_t ValueReader::read_numbers(Number* out, std::size_t count) {
  std::size_t read = 0;
  for (;;) {
    const NumberRun run = fast_run(next_, end_, out + read, count - read);
    next_ = run.next;
    read += run.count;
    if (read == count) return read;
    const std::string_view word = next_word();
    if (word.empty()) return read;
    out[read++] = slow_number<Number>(word);
    if (read == count) return read;
  }
}

template <class T>
void ValueReader::read_element(T& element) {
  using Number = typename ElementNumbers<T>::Number;
  constexpr std::size_t kCount = ElementNumbers<T>::kCount;
  Number numbers[kCount];
  std::size_t count = read_short(numbers, kCount);
  if (count == 0) count = read_numbers(numbers, kCount);
  if (count == kCount) {
    std::copy_n(numbers, kCount, numbers_of(element));
    return check_end();
  }
  const std::string name(value_->name);
  if (count == 0)
    sink_.problems().warn(value_->location, name + " has no value; ignored");
  else
    sink_.problems().error(value_->location,
                           name + " has " + std::to_string(count) + " numbers; expected " + std::to_string(kCount));
  next_ = end_;
}

template <class T>
void ValueReader::read_list(Array<T>& list, FieldValue& whole) {
  using Number = typename ElementNumbers<T>::Number;
  constexpr std::size_t kCount = ElementNumbers<T>::kCount;
  static_assert(kShortRun % kCount == 0);
  alignas(16) Number buffer[kShortRun];
  std::size_t count = read_short(buffer, kShortRun);
  if (count == 0) count = read_numbers(buffer, kShortRun);
  list.append(std::span<const T>(reinterpret_cast<const T*>(buffer), count / kCount));
  bool full = count == kShortRun;
  while (full && !sink_.scene().memory().exhausted()) {
    T* const at = list.prepare(kLongRun);
    count = read_numbers(reinterpret_cast<Number*>(at), kLongRun * kCount);
    list.commit(count / kCount);
    full = count == kLongRun * kCount;
    sink_.limits().charge_growth(whole, charged_, false);
  }
  if (count % kCount != 0)
    sink_.problems().error(location_of(end_), "the last value of " + std::string(value_->name) + " has " +
                                                  std::to_string(count % kCount) + " numbers; expected " +
                                                  std::to_string(kCount));
  list.shrink_to_fit();
}

// Reads one image (ISO/IEC 19776-1 5.5). Returns false at the end of the text or after an error.
bool ValueReader::read_image(SFImage& image) {
  std::int32_t head[3];
  const std::size_t count = read_numbers(head, 3);
  if (count == 0) return false;
  const SourceLocation location = location_of(next_);
  if (count < 3) {
    sink_.problems().error(location,
                           "expected width, height and components of an image for " + std::string(value_->name));
    return false;
  }
  if (!sink_.limits().admits_image(head[0], head[1], head[2], location)) {
    next_ = end_;
    return false;
  }
  const std::size_t pixels = static_cast<std::size_t>(head[0]) * static_cast<std::size_t>(head[1]);
  image.words.clear();
  if (pixels == 0 || head[2] == 0) return true;
  for (const std::int32_t word : head) image.words.push_back(static_cast<std::uint32_t>(word));
  const std::uint32_t mask = head[2] == 4 ? 0xffffffffu : (1u << (8 * head[2])) - 1;
  std::int32_t buffer[kShortRun];
  std::size_t left = pixels;
  for (std::size_t wanted = 0, read = 0; left > 0 && read == wanted;) {
    wanted = std::min(left, kShortRun);
    read = read_numbers(buffer, wanted);
    for (std::size_t i = 0; i < read; ++i) image.words.push_back(static_cast<std::uint32_t>(buffer[i]) & mask);
    left -= read;
  }
  if (left > 0) {
    sink_.problems().error(location_of(end_), std::to_string(left) + " pixels of an image are missing");
    // Few bytes of text may declare many pixels.
    if (left * sizeof(std::uint32_t) > sink_.scene().budget()->left(Resource::nodes) / 4)
      image.words.clear();
    else
      image.words.resize(image.words.size() + left);
  }
  image.words.shrink_to_fit();
  return true;
}

// Reads strings in double quotes. Many files omit the quotes; such text is one string.
void ValueReader::read_strings(MFString& strings) {
  skip_separators();
  if (next_ < end_ && *next_ != '"') {
    std::string_view text(next_, static_cast<std::size_t>(end_ - next_));
    while (!text.empty() && is_separator(text.back())) text.remove_suffix(1);
    strings.push_back(string_of(text, location_of(next_)));
    return;
  }
  for (skip_separators(); next_ < end_; skip_separators()) {
    const char* const begin = next_;
    if (*begin != '"') {
      const std::string_view word = next_word();
      if (!std::exchange(said_number_, true))
        sink_.problems().error(location_of(begin), "expected a string in quotes for " + std::string(value_->name) +
                                                       ", found " + quoted(word));
      continue;
    }
    bool escaped = false;
    for (++next_; next_ < end_ && *next_ != '"'; ++next_)
      if (*next_ == '\\' && next_ + 1 < end_) escaped = true, ++next_;
    std::string_view text(begin + 1, static_cast<std::size_t>(std::min(next_, end_) - begin - 1));
    if (next_ >= end_)
      sink_.problems().error(location_of(begin),
                             "unterminated string in " + std::string(value_->name) + "; expected '\"'");
    else
      ++next_;
    if (escaped) {
      unescape(text, scratch_);
      text = scratch_;
    }
    strings.push_back(string_of(text, escaped ? value_->location : location_of(begin)));
    if (sink_.scene().memory().exhausted()) return;
  }
}

void ValueReader::check_end() {
  const std::string_view rest = next_word();
  if (!rest.empty())
    sink_.problems().warn(location_of(rest.data()),
                          "more values than " + std::string(value_->name) + " takes; " + quoted(rest) + " is skipped");
}

void ValueReader::read(const ValueText& value, FieldValue& into) {
  value_ = &value;
  next_ = value.text.data();
  end_ = next_ + value.text.size();
  located_ = next_;
  location_ = value.location;
  said_number_ = false;
  charged_ = 0;
  std::visit(
      [&]<class T>(T& target) {
        using Element = ElementOf<T>;
        constexpr bool kIsList = requires { target.push_back(Element{}); };
        if constexpr (kIsList) target.clear();
        if constexpr (std::is_same_v<T, SFString>) {
          if (value.text.find('\\') != std::string_view::npos) unescape(value.text, scratch_);
          target = string_of(value.text.find('\\') != std::string_view::npos ? scratch_ : value.text, value.location);
        } else if constexpr (std::is_same_v<T, MFString>) {
          read_strings(target);
        } else if constexpr (std::is_same_v<Element, bool>) {
          for (std::string_view word = next_word(); !word.empty(); word = next_word()) {
            bool is_boolean = false;
            const bool yes = boolean_of(word, location_of(word.data()), is_boolean);
            if (!is_boolean)
              sink_.problems().error(location_of(word.data()), "expected true or false for " + std::string(value.name) +
                                                                   ", found " + quoted(word));
            if constexpr (kIsList)
              target.push_back(yes);
            else if (is_boolean)
              target = yes;
            if (!kIsList) return check_end();
          }
        } else if constexpr (std::is_same_v<T, SFImage>) {
          (void)read_image(target);
        } else if constexpr (std::is_same_v<Element, SFImage>) {
          for (SFImage image; !sink_.scene().memory().exhausted() && read_image(image);) {
            (void)sink_.scene().memory().charge(image.words.size() * sizeof(std::uint32_t));
            target.push_back(image);
          }
        } else if constexpr (NumberElement<Element>) {
          if constexpr (kIsList) {
            read_list(target, into);
          } else if constexpr (requires { target.edit(); }) {
            read_element(target.edit());
          } else {
            read_element(target);
          }
        }
      },
      into);
  sink_.limits().charge_growth(into, charged_, true);
}

}  // namespace gs::vrml::x3d
