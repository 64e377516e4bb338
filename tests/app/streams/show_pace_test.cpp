#include "app/streams/show_pace.h"

#include <catch2/catch.hpp>

namespace gs::app {

TEST_CASE("pictures of a growing stream take at most a fifth of the time") {
  using net::Instant;
  ShowPace pace;
  CHECK(pace.due(Instant{0}));
  pace.made(Instant{1'000'000}, Instant{1'010'000});  // 10 ms
  CHECK_FALSE(pace.due(Instant{1'249'999}));
  CHECK(pace.due(Instant{1'250'000}));
  pace.made(Instant{2'000'000}, Instant{2'500'000});  // half a second
  CHECK_FALSE(pace.due(Instant{4'499'999}));
  CHECK(pace.due(Instant{4'500'000}));
}

TEST_CASE("a clock that jumps back delays pictures by a quarter of a second at most") {
  using net::Instant;
  ShowPace pace;
  pace.made(Instant{5'000'000}, Instant{1'000'000});
  CHECK(pace.due(Instant{5'250'000}));
}

}  // namespace gs::app
