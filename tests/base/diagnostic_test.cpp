#include "base/diagnostic.h"

#include <catch2/catch.hpp>

namespace gs::diagnostic_test {

TEST_CASE("joins equal warnings of a file, and keeps each error") {
  Diagnostics all;
  all.add({Severity::warning, "a.wrl", {1, 2}, "unknown field x"});
  all.add({Severity::error, "a.wrl", {2, 1}, "expected a number"});
  all.add({Severity::warning, "a.wrl", {7, 2}, "unknown field x"});
  all.add({Severity::error, "a.wrl", {9, 1}, "expected a number"});
  all.add({Severity::warning, "b.wrl", {1, 2}, "unknown field x"});
  all.add({Severity::note, "a.wrl", {1, 2}, "unknown field x"});
  all.add({Severity::warning, "a.wrl", {8, 2}, "unknown field x"});
  const auto rows = joined(all.entries());
  REQUIRE(rows.size() == 5);
  CHECK(text_of(rows[0]) == "a.wrl:1:2: warning: unknown field x (3 times)");
  CHECK(text_of(rows[1]) == "a.wrl:2:1: error: expected a number");
  CHECK(text_of(rows[2]) == "a.wrl:9:1: error: expected a number");
  CHECK(text_of(rows[3]) == "b.wrl:1:2: warning: unknown field x");
  CHECK(rows[4].first->severity == Severity::note);
  CHECK(joined({}).empty());
}

}  // namespace gs::diagnostic_test
