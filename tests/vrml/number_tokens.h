#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

/// Random texts of numbers, for tests of their readers.
namespace gs::test {

using RandomBits = std::mt19937_64;
inline unsigned below(RandomBits& random, unsigned bound) { return static_cast<unsigned>(random() % bound); }

inline std::string digits(RandomBits& random, unsigned count) {
  std::string text;
  for (unsigned i = 0; i < count; ++i) text += static_cast<char>('0' + below(random, 10));
  return text;
}

inline std::string format(const char* pattern, double value) {
  char text[512];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

/// Returns all digits of a number exactly or nearly halfway between two floats.
inline std::string midpoint(RandomBits& random) {
  const auto f =
      std::bit_cast<float>(static_cast<std::uint32_t>(random() & 0x7fffffu) | (97 + below(random, 80)) << 23);
  const double middle = (static_cast<double>(f) + static_cast<double>(std::nextafter(f, 1e38f))) / 2;
  std::string text = format("%.60f", middle);
  const auto last = text.find_last_not_of('0');
  text.resize(text[last] == '.' ? last : last + 1);
  if (below(random, 4) == 0) text += text.find('.') == std::string::npos ? ".0001" : "001";
  if (below(random, 4) == 0 && text.back() > '0') --text.back();
  return text;
}

inline std::string float_token(RandomBits& random) {
  static const char* const signs[] = {"", "", "-", "+"};
  std::string text = signs[below(random, 4)];
  const double number = std::uniform_real_distribution<double>(0, 1000)(random);
  switch (below(random, 12)) {
    case 0:
      return text + format("%.6f", number);
    case 1:
      return text + format("%g", number);
    case 2:
      return text + format("%.9g", number / 1e5);
    case 3:
      return text + format("%.17g", number);
    case 4:
      return text + format("%e", number);
    case 5:
      return text + midpoint(random);
    case 6:
      return text + std::string(below(random, 22), '0') + digits(random, 1 + below(random, 10));
    case 7:
      return text + "." + digits(random, 1 + below(random, 20));
    case 8:
      return text + digits(random, 1 + below(random, 20)) + ".";
    case 9:
      return text + digits(random, 1 + below(random, 20));
    default:
      break;
  }
  text += digits(random, 1 + below(random, 10)) + "." + digits(random, below(random, 19));
  static const char* const exponents[] = {"e", "E", "e-", "E+"};
  if (below(random, 3) == 0) text += exponents[below(random, 4)] + std::to_string(below(random, 55));
  return text;
}

inline std::string integer_token(RandomBits& random) {
  static const char* const signs[] = {"", "", "-", "+"};
  std::string text = signs[below(random, 4)];
  switch (below(random, 8)) {
    case 0:
      return "-1";
    case 1:
      return text + std::to_string(below(random, 0x80000000u));
    case 2:
      return text + std::to_string(2147483600u + below(random, 48));
    case 3:
      return text + "0x" + digits(random, 1 + below(random, 8));
    case 4:
      return text + std::string(below(random, 12), '0') + std::to_string(below(random, 1000));
    default:
      return text + std::to_string(random() >> (40 + below(random, 24)));
  }
}

inline std::string separator(RandomBits& random) {
  static const char* const all[] = {" ", ",", "\n", "\t", ", ", "  ", ",\n", "\r\n", " ,\r\n\t "};
  return below(random, 40) == 0 ? std::string(below(random, 150), ' ') + "\n" : all[below(random, 9)];
}

inline std::string joined(RandomBits& random, const std::vector<std::string>& tokens) {
  std::string text;
  for (const std::string& token : tokens) text += token + separator(random);
  return text;
}

}  // namespace gs::test
