#include "net/base/siphash.h"

#include <catch2/catch.hpp>

#include <vector>

namespace {

TEST_CASE("computes SipHash-2-4 as its authors published it", "[siphash]") {
  const gs::net::SipKey key{0x0706050403020100, 0x0f0e0d0c0b0a0908};
  std::vector<std::byte> bytes;
  // Appendix A of the paper, and the first test vector of the reference implementation.
  for (int i = 0; i < 15; ++i) bytes.push_back(static_cast<std::byte>(i));
  REQUIRE(gs::net::siphash(key, bytes) == 0xa129ca6149be45e5);
  REQUIRE(gs::net::siphash(key, {}) == 0x726fdb47dd0e0e31);
}

}  // namespace
