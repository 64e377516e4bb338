#include "base/text.h"

#include <catch2/catch.hpp>

namespace gs::text_test {

TEST_CASE("prints sizes in a suitable unit, and parts in the unit of the whole") {
  CHECK(readable_size(999) == "999 B");
  CHECK(readable_size(1'000'000) == "1.0 MB");
  CHECK(readable_part(0, 183'000) == "0 of 183 kB");
  CHECK(readable_part(45'200, 183'000) == "45 of 183 kB");
  CHECK(readable_part(45'200, 2'300'000) == "45.2 kB of 2.3 MB");
  CHECK(readable_part(1'400'000, 2'300'000) == "1.4 of 2.3 MB");
  CHECK(readable_part(0, 200'000) == "0 of 200 kB");
  CHECK(readable_part(12'345, 45'678) == "12.3 of 45.7 kB");
  CHECK(readable_part(500, 999) == "500 of 999 B");
  CHECK(readable_part(999'960'000, 1'000'000'000'000) == "1.0 GB of 1.0 TB");
}

TEST_CASE("cuts names between characters, and removes their controls") {
  CHECK(shortened("abc", 3) == "abc");
  CHECK(shortened("abcd", 3) == "abc...");
  CHECK(shortened("a\nb", 9) == "a b");
  CHECK(shortened("\xc3\xa4\xc3\xa4", 3) == "\xc3\xa4...");
}

TEST_CASE("computes the same hash of a text on every machine") {
  CHECK(stable_hash("") == 0xcbf29ce484222325);
  CHECK(stable_hash("a") == 0xaf63dc4c8601ec8c);
  CHECK(stable_hash("a", 1) != stable_hash("a"));
}

}  // namespace gs::text_test
