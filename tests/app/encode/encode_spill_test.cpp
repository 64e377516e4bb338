#include "app/encode/encode_spill.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <random>
#include <span>
#include <vector>

namespace gs::app {
namespace encode_spill_test {

TEST_CASE("encode spill: Bytes are the same in memory and in a file") {
  std::mt19937 random(4);
  std::vector<std::byte> all;
  EncodeSpill memory(1 << 20, {}), file(10'000, {}), at_once(0, {});
  for (int i = 0; i < 60; ++i) {
    std::vector<std::byte> piece(random() % 2000);
    for (std::byte& byte : piece) byte = static_cast<std::byte>(random());
    all.insert(all.end(), piece.begin(), piece.end());
    for (EncodeSpill* spill : {&memory, &file, &at_once}) {
      REQUIRE(spill->append(piece));
      CHECK(spill->size() == all.size());
    }
  }
  std::vector<std::byte> beyond(2);
  for (const EncodeSpill* spill : {&memory, &file, &at_once}) CHECK_FALSE(spill->read(all.size() - 1, beyond));
  for (int i = 0; i < 60; ++i) {
    const std::size_t from = random() % all.size(), count = random() % (all.size() - from);
    std::vector<std::byte> back(count);
    for (const EncodeSpill* spill : {&memory, &file, &at_once}) {
      REQUIRE(spill->read(from, back));
      CHECK(std::equal(back.begin(), back.end(), all.begin() + static_cast<std::ptrdiff_t>(from)));
    }
  }
}

TEST_CASE("encode spill: A folder without files is an error") {
  EncodeSpill spill(10, "/nonexistent");
  CHECK(spill.append(std::vector<std::byte>(9)));
  CHECK_FALSE(spill.append(std::vector<std::byte>(9)));
  CHECK(spill.problem() == "cannot create a temporary file in /nonexistent: No such file or directory");
}

}  // namespace encode_spill_test
}  // namespace gs::app
