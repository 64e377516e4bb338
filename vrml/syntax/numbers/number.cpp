#include "vrml/syntax/numbers/number.h"

#include <fast_float/fast_float.h>

#include <array>
#include <charconv>

#include "vrml/syntax/numbers/number_paths.h"

namespace gs::vrml {
namespace {

constexpr std::ptrdiff_t kGuardSearch = 128;

enum SeparatorClass : std::uint8_t { other, separator, line_feed, carriage_return };
constexpr std::array<std::uint8_t, 256> kSeparatorClass = [] {
  std::array<std::uint8_t, 256> table{};
  table[' '] = table['\t'] = table[','] = separator;
  table['\n'] = line_feed;
  table['\r'] = carriage_return;
  return table;
}();

// Number of decimal digits that always fits into 64 bits.
constexpr std::ptrdiff_t kMaxDigits = 19;

std::uint8_t separator_class(char c) { return kSeparatorClass[static_cast<unsigned char>(c)]; }
unsigned digit_of(char c) { return static_cast<unsigned>(static_cast<unsigned char>(c)) - '0'; }
bool is_digit(char c) { return digit_of(c) < 10; }

// Reports whether a bulk read continues after a number that this byte ends. The slow path handles all other bytes, even
// `x` and `#`.
bool ends_number(char c) { return separator_class(c) != other || c == ']'; }

// Skips separators before `guard`. A carriage return counts as a separator only before a line feed.
const char* skip_separators(const char* p, const char* guard, NumberRun& run) {
  for (; p < guard; ++p) {
    const std::uint8_t kind = separator_class(*p);
    if (kind == separator) continue;
    if (kind == line_feed) {
      ++run.lines;
      run.line_start = p + 1;
    } else if (kind == other || p[1] != '\n') {
      return p;
    }
  }
  return p;
}

// Reads the digits at `p`, and moves `p` after them. The value is exact for at most kMaxDigits digits.
void read_digits(const char*& p, std::uint64_t& value) {
  for (unsigned digit; (digit = digit_of(*p)) < 10; ++p) value = value * 10 + digit;
}

// Reads an optional sign, and moves `p` after it. Returns true for a minus.
bool read_sign(const char*& p) {
  const bool negative = *p == '-';
  p += negative || *p == '+';
  return negative;
}

}  // namespace

bool number_paths::read_number(const char*& p, float& value) {
  const char* q = p;
  const bool negative = read_sign(q);
  const char* const digits = q;
  std::uint64_t mantissa = 0;
  read_digits(q, mantissa);
  std::ptrdiff_t count = q - digits;
  int exponent = 0;
  if (*q == '.') {
    const char* const fraction = ++q;
    read_digits(q, mantissa);
    const std::ptrdiff_t places = q - fraction;
    count += places;
    exponent = places <= kMaxDigits ? -static_cast<int>(places) : 0;
  }
  if (count == 0) return false;
  if (!ends_number(*q)) {
    if (*q != 'e' && *q != 'E') return false;
    ++q;
    const bool down = read_sign(q);
    const char* const start = q;
    int shift = 0;
    for (; is_digit(*q); ++q) shift = shift < 1000 ? shift * 10 + static_cast<int>(digit_of(*q)) : shift;
    if (q == start || !ends_number(*q)) return false;
    exponent += down ? -shift : shift;
  }
  float magnitude = 0;
  if (count > kMaxDigits || !number_paths::scale(mantissa, exponent, magnitude)) {
    if (fast_float::from_chars(digits, q, magnitude).ptr != q) return false;
  }
  value = negative ? -magnitude : magnitude;
  p = q;
  return true;
}

bool number_paths::read_number(const char*& p, std::int32_t& value) {
  const char* q = p;
  const bool negative = read_sign(q);
  const char* const digits = q;
  std::uint64_t magnitude = 0;
  read_digits(q, magnitude);
  const std::ptrdiff_t count = q - digits;
  if (count == 0 || count > kMaxDigits || !ends_number(*q)) return false;
  if (magnitude > 0x7fffffffu + std::uint64_t{negative}) return false;
  const auto bits = static_cast<std::uint32_t>(magnitude);
  value = static_cast<std::int32_t>(negative ? 0u - bits : bits);
  p = q;
  return true;
}

namespace {

template <class T>
void read_plain_run(NumberRun& run, const char* guard, T* out, std::size_t target) {
  const char* p = run.next;
  std::size_t count = run.count;
  while (count < target) {
    number_paths::fetch_ahead(p);
    p = skip_separators(p, guard, run);
    if (p >= guard || !number_paths::read_number(p, out[count])) break;
    ++count;
  }
  run.next = p;
  run.count = count;
}

template <class T>
NumberRun portable(const char* begin, const char* end, T* out, std::size_t capacity) {
  NumberRun run{begin, 0, 0, nullptr};
  const char* const guard = number_paths::find_guard(begin, end);
  if (guard) read_plain_run(run, guard, out, capacity);
  return run;
}

template <class T>
bool parse_decimal(std::string_view text, T& value) {
  const std::size_t sign = text.starts_with('+') || text.starts_with('-');
  // rejects "inf" and "nan", which from_chars accepts
  if (text.size() == sign || (!is_digit(text[sign]) && text[sign] != '.')) return false;
  if (text.front() == '+') text.remove_prefix(1);
  T parsed{};
  const auto result = fast_float::from_chars(text.data(), text.data() + text.size(), parsed);
  if (result.ptr != text.data() + text.size()) return false;
  value = parsed;
  return true;
}

}  // namespace

std::size_t number_length(std::string_view text) {
  const auto digits_from = [&](std::size_t at) {
    std::size_t end = at;
    while (end < text.size() && is_digit(text[end])) ++end;
    return end - at;
  };
  const std::size_t sign = !text.empty() && (text[0] == '+' || text[0] == '-') ? 1 : 0;
  if (text.substr(sign).starts_with("0x") || text.substr(sign).starts_with("0X")) {
    const auto is_hexadecimal = [](char c) { return is_digit(c) || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F'); };
    std::size_t end = sign + 2;
    while (end < text.size() && is_hexadecimal(text[end])) ++end;
    if (end > sign + 2) return end;
  }
  const std::size_t whole = digits_from(sign);
  std::size_t end = sign + whole, fraction = 0;
  if (end < text.size() && text[end] == '.') {
    fraction = digits_from(end + 1);
    if (whole + fraction > 0) end += 1 + fraction;
  }
  if (whole + fraction == 0) return 0;
  if (end < text.size() && (text[end] == 'e' || text[end] == 'E')) {
    const std::size_t after = end + 1 + (end + 1 < text.size() && (text[end + 1] == '+' || text[end + 1] == '-'));
    if (const std::size_t digits = digits_from(after); digits > 0) end = after + digits;
  }
  return end;
}

namespace number_paths {

const char* find_guard(const char* begin, const char* end) {
  const char* const first = end - begin > kGuardSearch ? end - kGuardSearch : begin;
  for (const char* p = end; p > first;) {
    --p;
    if (!is_digit(*p) && *p != '.' && *p != '-' && *p != '+' && *p != 'e' && *p != 'E') return p;
  }
  return nullptr;
}

void read_plain(NumberRun& run, const char* guard, float* out, std::size_t target) {
  read_plain_run(run, guard, out, target);
}
void read_plain(NumberRun& run, const char* guard, std::int32_t* out, std::size_t target) {
  read_plain_run(run, guard, out, target);
}

NumberRun floats_portable(const char* begin, const char* end, float* out, std::size_t capacity) {
  return portable(begin, end, out, capacity);
}
NumberRun integers_portable(const char* begin, const char* end, std::int32_t* out, std::size_t capacity) {
  return portable(begin, end, out, capacity);
}

}  // namespace number_paths

bool parse_number(std::string_view text, float& value) { return parse_decimal(text, value); }
bool parse_number(std::string_view text, double& value) { return parse_decimal(text, value); }

bool parse_number(std::string_view text, std::int32_t& value) {
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
  if (hexadecimal) text.remove_prefix(2);
  std::uint64_t magnitude = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), magnitude, hexadecimal ? 16 : 10);
  if (text.empty() || result.ec != std::errc() || result.ptr != text.data() + text.size()) return false;
  if (hexadecimal) {
    if (magnitude > 0xffffffffu) return false;
    const auto bits = static_cast<std::uint32_t>(magnitude);
    value = static_cast<std::int32_t>(negative ? 0u - bits : bits);
    return true;
  }
  if (magnitude > 0x7fffffffu + std::uint64_t{negative}) return false;
  const auto bits = static_cast<std::uint32_t>(magnitude);
  value = static_cast<std::int32_t>(negative ? 0u - bits : bits);
  return true;
}

NumberRun parse_floats(const char* begin, const char* end, float* out, std::size_t capacity) {
  static const auto path = number_paths::has_avx2() ? number_paths::floats_avx2 : number_paths::floats_portable;
  return path(begin, end, out, capacity);
}

NumberRun parse_integers(const char* begin, const char* end, std::int32_t* out, std::size_t capacity) {
  static const auto path = number_paths::has_avx2() ? number_paths::integers_avx2 : number_paths::integers_portable;
  return path(begin, end, out, capacity);
}

}  // namespace gs::vrml
