#include "net/cells/erasure.h"

#include "tests/net/cells/failure_odds.h"
#include "tests/net/link.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <numeric>

namespace {

using namespace gs::net;

std::vector<std::byte> random_bytes(std::size_t size) {
  std::vector<std::byte> bytes(size);
  std::uint64_t state = size;
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(Link::next_random(state));
  return bytes;
}

TEST_CASE("restores the data from any k of n symbols", "[erasure]") {
  std::uint64_t random = 5;
  for (const std::size_t size : {1U, 7U, 200U, 1216U, 1217U, 15000U, 77824U, 100'000U}) {
    const auto data = random_bytes(size);
    const ErasureLayout layout = erasure_layout(size, std::clamp<std::size_t>(size, 8, 1216));
    REQUIRE(layout.sound());
    const ErasureEncoder encoder(data, layout);
    for (int round = 0; round < 5; ++round) {
      ErasureDecoder decoder(layout);
      for (std::size_t block = 0; block < layout.blocks(); ++block) {
        std::vector<std::size_t> numbers(ErasureLayout::kMaxSymbols);
        std::iota(numbers.begin(), numbers.end(), std::size_t{0});
        for (std::size_t i = numbers.size(); i-- > 1;)
          std::swap(numbers[i], numbers[Link::next_random(random) % (i + 1)]);
        for (std::size_t i = 0; i < layout.source; ++i) {
          REQUIRE_FALSE(decoder.done());
          REQUIRE(decoder.add(block, numbers[i], encoder.symbol(block, numbers[i])));
          if (i + 1 < layout.source) REQUIRE_FALSE(decoder.add(block, numbers[i], encoder.symbol(block, numbers[i])));
        }
      }
      REQUIRE(decoder.done());
      REQUIRE(decoder.data() == data);
    }
  }
}

TEST_CASE("copies the data to the first k symbols", "[erasure]") {
  const auto data = random_bytes(3000);
  const ErasureEncoder encoder(data, erasure_layout(3000, 1000));
  REQUIRE(encoder.layout().source == 3);
  for (std::size_t i = 0; i < 3; ++i)
    REQUIRE(std::equal(data.begin() + static_cast<std::ptrdiff_t>(1000 * i),
                       data.begin() + static_cast<std::ptrdiff_t>(1000 * i + 1000), encoder.symbol(0, i).begin()));
}

TEST_CASE("computes parity as by hand", "[erasure]") {
  // GF(256) with 11D: 1/2 = 8E, 1/3 = F4. With two source symbols, symbol 2 is s0 / (2 xor 0) + s1 / (2 xor 1). With
  // one, symbol 1 is s0.
  std::vector<std::byte> data(16);
  data[0] = std::byte{1};
  data[9] = std::byte{1};
  const ErasureEncoder two(data, {16, 8, 2});
  std::vector<std::byte> expected(8);
  expected[0] = std::byte{0x8e};
  expected[1] = std::byte{0xf4};
  REQUIRE(two.symbol(0, 2) == expected);
  const ErasureEncoder one(data, {16, 16, 1});
  REQUIRE(one.symbol(0, 1) == data);
}

TEST_CASE("computes the number of symbols that makes a failure rare", "[erasure]") {
  // With one source symbol, the probability is 0.3^n.
  REQUIRE(failure_of(1, 1, 0.3) == Approx(0.3));
  REQUIRE(failure_of(1, 4, 0.3) == Approx(0.0081));
  REQUIRE(symbols_for(1, 0.3, 1e-6) == 12);
  // Two of three symbols are needed, and each is received with probability 1/2. The code fails if none or one is
  // received: 4/8.
  REQUIRE(failure_of(2, 3, 0.5) == Approx(0.5));
  REQUIRE(failure_of(5, 4, 0) == 1);
  REQUIRE(symbols_for(13, 0, 1e-6) == 13);
  const std::size_t symbols = symbols_for(13, 0.3, 1e-6);
  REQUIRE(failure_of(13, symbols, 0.3) < 1e-6);
  REQUIRE(failure_of(13, symbols - 1, 0.3) >= 1e-6);
  REQUIRE(symbols_for(64, 0.99, 1e-6) == 255);
}

TEST_CASE("rejects invalid symbols and layouts", "[erasure]") {
  REQUIRE_FALSE((ErasureLayout{0, 1000, 4}.sound()));
  REQUIRE_FALSE((ErasureLayout{1000, 0, 4}.sound()));
  REQUIRE_FALSE((ErasureLayout{1000, 1000, 0}.sound()));
  REQUIRE_FALSE((ErasureLayout{0xffffffff, 1000, 4}.sound()));
  REQUIRE_FALSE((ErasureLayout{1000, 1000, 200}.sound()));
  ErasureDecoder decoder(erasure_layout(3000, 1000));
  const auto symbol = random_bytes(1000);
  REQUIRE_FALSE(decoder.add(1, 0, symbol));
  REQUIRE_FALSE(decoder.add(0, 255, symbol));
  REQUIRE_FALSE(decoder.add(0, 0, std::span(symbol).first(999)));
  REQUIRE_FALSE(decoder.done());
}

}  // namespace
