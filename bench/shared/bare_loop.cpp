#include "bench/shared/bare_loop.h"

#include <fast_float/fast_float.h>

#include <array>
#include <cstring>

namespace gs::bench {
namespace {

enum : std::uint8_t { kOther, kSeparator, kNumber };

constexpr std::array<std::uint8_t, 256> kClasses = [] {
  std::array<std::uint8_t, 256> classes{};
  for (int c = 0; c <= ' '; ++c) classes[c] = kSeparator;
  for (const char c : {',', '[', ']', '{', '}'}) classes[c] = kSeparator;
  for (int c = '0'; c <= '9'; ++c) classes[c] = kNumber;
  for (const char c : {'+', '-', '.'}) classes[c] = kNumber;
  return classes;
}();

std::uint8_t class_of(char c) { return kClasses[static_cast<unsigned char>(c)]; }

const char* read_integer(const char* at, const char* end, std::int32_t& value) {
  const bool negative = *at == '-';
  if (negative || *at == '+') ++at;
  std::uint32_t magnitude = 0;
  while (at != end) {
    const unsigned digit = static_cast<unsigned>(*at - '0');
    if (digit > 9) break;
    magnitude = magnitude * 10 + digit;
    ++at;
  }
  value = static_cast<std::int32_t>(negative ? 0u - magnitude : magnitude);
  return at;
}

}  // namespace

BareLoop::BareLoop(std::size_t bytes)
    : capacity_(bytes / 2 + 1),
      reals_(std::make_unique<float[]>(capacity_)),
      integers_(std::make_unique<std::int32_t[]>(capacity_)) {}

std::size_t BareLoop::run(std::string_view text) {
  const char* at = text.data();
  const char* const end = at + text.size();
  std::size_t reals = 0, integers = 0;
  bool integral = false;
  while (at != end) {
    const std::uint8_t kind = class_of(*at);
    if (kind == kSeparator) {
      ++at;
      continue;
    }
    const char* const start = at;
    if (kind == kOther) {
      while (at != end && class_of(*at) != kSeparator) ++at;
      integral = std::string_view(start, at - start).ends_with("Index");
      continue;
    }
    if (integral) {
      at = read_integer(at, end, integers_[integers++]);
    } else {
      at = fast_float::from_chars(at + (*at == '+'), end, reals_[reals++]).ptr;
    }
    if (at == start) ++at;                                  // a sign or point without digits after it
    while (at != end && class_of(*at) != kSeparator) ++at;  // "3px"
  }
  return reals + integers;
}

std::uint64_t sum_words(std::string_view text) {
  std::uint64_t sum = 0, word = 0;
  for (std::size_t i = 0; i + sizeof word <= text.size(); i += sizeof word) {
    std::memcpy(&word, text.data() + i, sizeof word);
    sum += word;
  }
  return sum;
}

}  // namespace gs::bench
