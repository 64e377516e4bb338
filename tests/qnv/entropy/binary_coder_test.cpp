#include "qnv/entropy/binary_coder.h"

#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

namespace gs::qnv::displaced::binary_coder_test {
namespace {

struct Decision {
  int model = 0;  // under 4: a model; 4: plain bits; 5: a number
  std::uint32_t value = 0;
  int bits = 0;
};

struct Models {
  std::array<BitModel, 4> bits;
  NumberModel<6> number;
};

std::vector<Decision> random_decisions(std::uint32_t seed, std::size_t count) {
  std::mt19937 random(seed);
  std::vector<Decision> out;
  // Probability of a 1, in thousandths.
  constexpr std::array<std::uint32_t, 4> kLikely{1, 300, 500, 1000};
  for (std::size_t i = 0; i < count; ++i) {
    Decision d;
    d.model = static_cast<int>(random() % 6);
    if (d.model < 4) d.value = random() % 1000 < kLikely[static_cast<std::size_t>(d.model)] ? 1 : 0;
    if (d.model == 4) {
      d.bits = 1 + static_cast<int>(random() % 17);
      d.value = static_cast<std::uint32_t>(random()) & ((1u << d.bits) - 1);
    }
    if (d.model == 5) d.value = static_cast<std::uint32_t>(random()) >> (8 + random() % 24);
    out.push_back(d);
  }
  return out;
}

std::vector<std::byte> written(std::span<const Decision> decisions) {
  BinaryEncoder encoder;
  Models models;
  for (const Decision& d : decisions) {
    if (d.model < 4) encoder.put(models.bits[static_cast<std::size_t>(d.model)], d.value != 0);
    if (d.model == 4) encoder.put_bits(d.value, d.bits);
    if (d.model == 5) models.number.put(encoder, d.value);
  }
  return encoder.finish();
}

std::uint32_t read_one(BinaryDecoder& decoder, Models& models, const Decision& d) {
  if (d.model < 4) return decoder.get(models.bits[static_cast<std::size_t>(d.model)]) ? 1 : 0;
  return d.model == 4 ? decoder.get_bits(d.bits) : models.number.get(decoder);
}

}  // namespace

TEST_CASE("decodes the output of the range coder") {
  for (std::uint32_t seed = 0; seed < 200; seed += static_cast<std::uint32_t>(watched_step(5))) {
    const std::vector<Decision> decisions = random_decisions(seed, seed * 7);
    const std::vector<std::byte> bytes = written(decisions);
    BinaryDecoder decoder(bytes);
    Models models;
    for (const Decision& d : decisions) REQUIRE_EACH(read_one(decoder, models, d) == d.value);
    CHECK(!decoder.exhausted());
  }
}

TEST_CASE("decodes any number of equal decisions from few bytes and spared trailing zeros") {
  for (const bool bit : {false, true})
    for (std::size_t count = 0; count < 20000; count += 1 + count / 3) {
      BinaryEncoder encoder;
      BitModel model;
      for (std::size_t i = 0; i < count; ++i) encoder.put(model, bit);
      const std::vector<std::byte> bytes = encoder.finish();
      CHECK(bytes.size() <= 10 + count / 4000);
      BinaryDecoder decoder(bytes);
      BitModel read;
      for (std::size_t i = 0; i < count; ++i) REQUIRE_EACH(decoder.get(read) == bit);
      CHECK(!decoder.exhausted());
    }
}

// FORMAT.md, "Binary range coding", computed independently of this program in integer arithmetic.
TEST_CASE("writes the pinned bytes of the range coder") {
  BinaryEncoder encoder;
  BitModel model;
  for (const bool bit : {true, true, false, true, false, false, false, true, true, false}) encoder.put(model, bit);
  encoder.put_bits(0x2a5, 10);
  NumberModel<6> number;
  for (const std::uint32_t value : {0u, 3u, 6u, 40u}) number.put(encoder, value);
  CHECK(encoder.finish() == std::vector<std::byte>{std::byte{0x66}, std::byte{0x85}, std::byte{0xf8}, std::byte{0x49},
                                                   std::byte{0x3a}, std::byte{0xc9}, std::byte{0x60}});
  BitModel learned;
  CHECK(learned.probability() == 32768);
  learned.learn(true);  // (65535 - 32768) * 43690 >> 16
  CHECK(learned.one == 32768 + 21844);
  learned.learn(false);  // -54612 * 26214 >> 16, rounded down
  CHECK(learned.one == 54612 - 21845);
}

TEST_CASE("decodes a prefix of range-coded bytes safely, and detects that it is one") {
  const std::vector<Decision> decisions = random_decisions(77, 900);
  const std::vector<std::byte> bytes = written(decisions);
  std::size_t known = 0;
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    const std::vector<std::byte> prefix(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length));
    BinaryDecoder decoder(prefix);
    Models models;
    for (const Decision& d : decisions) (void)read_one(decoder, models, d);
    known += decoder.exhausted() ? 1 : 0;
  }
  CHECK(known > bytes.size() * 9 / 10);
}

TEST_CASE("maps signed numbers to unsigned ones and back") {
  CHECK(zigzag(0) == 0);
  CHECK(zigzag(-1) == 1);
  CHECK(zigzag(1) == 2);
  for (const std::int32_t value : {0, 1, -1, 77, -32768, 2147483647, -2147483647})
    CHECK(unzigzag(zigzag(value)) == value);
}

}  // namespace gs::qnv::displaced::binary_coder_test
