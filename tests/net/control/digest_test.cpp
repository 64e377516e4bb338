#include "net/control/digest.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace gs::net::digest_test {
namespace {

std::string hex(const std::array<std::byte, 20>& digest) {
  std::string text;
  for (const std::byte byte : digest)
    for (const int digit : {std::to_integer<int>(byte) >> 4, std::to_integer<int>(byte) & 15})
      text += "0123456789abcdef"[digit];
  return text;
}

std::string encoded(std::string_view text) { return base64(std::as_bytes(std::span(text))); }

}  // namespace

TEST_CASE("computes the SHA-1 digests of RFC 3174 7.3, and of texts around a block boundary") {
  CHECK(hex(sha1("abc")) == "a9993e364706816aba3e25717850c26c9cd0d89d");
  CHECK(hex(sha1("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq")) ==
        "84983e441c3bd26ebaae4aa1f95129e5e54670f1");
  CHECK(hex(sha1(std::string(1'000'000, 'a'))) == "34aa973cd4c4daa4f61eeb2bdbad27316534016f");
  std::string eight;
  for (int i = 0; i < 10; ++i) eight += "0123456701234567012345670123456701234567012345670123456701234567";
  CHECK(hex(sha1(eight)) == "dea356a2cddd90c7a7ecedc5ebb563934f460452");
  CHECK(hex(sha1("")) == "da39a3ee5e6b4b0d3255bfef95601890afd80709");
}

TEST_CASE("encodes Base64 as in RFC 4648 10, and decodes nothing else") {
  const std::vector<std::pair<std::string, std::string>> vectors = {{"", ""},
                                                                    {"f", "Zg=="},
                                                                    {"fo", "Zm8="},
                                                                    {"foo", "Zm9v"},
                                                                    {"foob", "Zm9vYg=="},
                                                                    {"fooba", "Zm9vYmE="},
                                                                    {"foobar", "Zm9vYmFy"}};
  for (const auto& [plain, text] : vectors) {
    CHECK(encoded(plain) == text);
    const auto back = base64_bytes(text);
    REQUIRE(back);
    CHECK(std::string(reinterpret_cast<const char*>(back->data()), back->size()) == plain);
  }
  for (const char* wrong : {"Z", "Zg", "Zg=", "Zh==", "Zg==Zg==", "Z===", "====", "Zm9\n", "Zm9-", "=m9v", "Zm=v"}) {
    INFO(wrong);
    CHECK_FALSE(base64_bytes(wrong));
  }
}

TEST_CASE("accepts UTF-8 of RFC 3629, and rejects overlong forms, surrogates and values over U+10FFFF") {
  for (const char* good : {"", "plain", "\xc2\x80", "\xdf\xbf", "\xe0\xa0\x80", "\xed\x9f\xbf", "\xee\x80\x80",
                           "\xef\xbf\xbf", "\xf0\x90\x80\x80", "\xf4\x8f\xbf\xbf", "12345678\xc3\xa9"}) {
    INFO(good);
    CHECK(is_utf8(good));
  }
  for (const char* bad : {"\x80", "\xc0\x80", "\xc1\xbf", "\xc3", "\xe0\x9f\xbf", "\xed\xa0\x80", "\xf0\x8f\xbf\xbf",
                          "\xf4\x90\x80\x80", "\xf5\x80\x80\x80", "\xff", "12345678\xc3", "\xe2\x82", "\xe2\x28\xa1"}) {
    INFO(bad);
    CHECK_FALSE(is_utf8(bad));
  }
}

}  // namespace gs::net::digest_test
