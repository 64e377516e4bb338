#include "render/text/utf8.h"

#include <catch2/catch.hpp>

#include <random>
#include <string>

namespace gs::render::utf8_test {

TEST_CASE("decodes characters of UTF-8") {
  CHECK(characters_of("").empty());
  CHECK(characters_of("Az~") == U"Az~");
  CHECK(characters_of("\xC2\xAE") == U"\u00AE");  // the example of VRML97 6.47.2
  CHECK(characters_of("\xD7\x90\xE2\x82\xAC\xF0\x9F\x99\x82") == U"\u05D0\u20AC\U0001F642");
  CHECK(characters_of(std::string("a\0b", 3)) == std::u32string(U"a\0b", 3));
  CHECK(characters_of("\xF4\x8F\xBF\xBF") == U"\U0010FFFF");
}

TEST_CASE("replaces invalid UTF-8, one incomplete sequence at a time") {
  // Unicode 3.9, Tables 3-8 to 3-11.
  CHECK(characters_of("\xC0\xAF\xE0\x80\xBF\xF0\x81\x82\x41") == U"\uFFFD\uFFFD\uFFFD\uFFFD\uFFFD\uFFFD\uFFFD\uFFFDA");
  CHECK(characters_of("\xED\xA0\x80\xED\xBF\xBF\xED\xAF\x41") == U"\uFFFD\uFFFD\uFFFD\uFFFD\uFFFD\uFFFD\uFFFD\uFFFDA");
  CHECK(characters_of("\xF4\x91\x92\x93\xFF\x41\x80\xBF\x42") == U"\uFFFD\uFFFD\uFFFD\uFFFD\uFFFDA\uFFFD\uFFFDB");
  CHECK(characters_of("\xE1\x80\xE2\xF0\x91\x92\xF1\xBF\x41") == U"\uFFFD\uFFFD\uFFFD\uFFFDA");
  CHECK(characters_of("\xE2\x82") == U"\uFFFD");
}

TEST_CASE("decodes random bytes to at most as many characters") {
  std::mt19937 random(7);
  for (int round = 0; round < 2000; ++round) {
    std::string bytes(random() % 40, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    const std::u32string characters = characters_of(bytes);
    CHECK(characters.size() <= bytes.size());
    for (const char32_t c : characters) CHECK((c <= 0x10FFFF && (c < 0xD800 || c > 0xDFFF)));
  }
}

}  // namespace gs::render::utf8_test
