#include "app/loading/fetch/fetcher.h"

#include <catch2/catch.hpp>

#include <optional>
#include <vector>

namespace gs::app::progress_test {

TEST_CASE("computes the received fraction only if all sizes are known") {
  const auto part = [](const std::vector<LoadingState>& states) { return received_part(states); };
  CHECK(part({}) == std::nullopt);
  CHECK(part({{100, std::nullopt, 1, 1}}) == std::nullopt);
  CHECK(part({{100, 400, 1, 1}}) == 0.25);
  CHECK(part({{100, 400, 1, 1}, {100, 100, 1, 0}}) == 0.4);
  CHECK(part({{100, 400, 1, 1}, {7, std::nullopt, 1, 1}}) == std::nullopt);
  CHECK(part({{0, 0, 1, 1}}) == std::nullopt);
  CHECK(part({{500, 400, 1, 1}}) == 1.0);  // the file has grown
}

}  // namespace gs::app::progress_test
