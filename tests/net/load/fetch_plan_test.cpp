#include "net/load/fetch_plan.h"

#include <catch2/catch.hpp>

#include <array>
#include <vector>

namespace gs::net::fetch_plan_test {

TEST_CASE("plans only the bytes that no unfinished fetch loads, and joins near ranges") {
  std::vector<TransferId> cancelled;
  const std::function<void(TransferId)> cancel = [&](TransferId id) { cancelled.push_back(id); };
  FetchPlan plan(cancel, 5);
  plan.add(RangeSet(std::array{ByteRange{0, 10}, ByteRange{12, 20}, ByteRange{40, 50}}));
  REQUIRE(plan.all().size() == 2);
  CHECK(plan.all()[0]->range == ByteRange{0, 20});
  plan.cover(RangeSet(std::array{ByteRange{0, 60}}));
  REQUIRE(plan.all().size() == 4);
  CHECK(plan.all()[2]->range == ByteRange{20, 40});
  CHECK(plan.all()[3]->range == ByteRange{50, 60});
  CHECK(plan.is_first_unfinished(*plan.all()[0]));

  plan.all()[0]->transfer = 7;
  plan.all()[1]->transfer = 8;
  plan.all()[1]->attempts = 3;
  plan.finish_others(plan.all()[1].get());
  CHECK(cancelled == std::vector<TransferId>{7});
  CHECK(plan.is_first_unfinished(*plan.all()[1]));
  plan.erase_finished();
  REQUIRE(plan.all().size() == 1);
  CHECK(plan.attempts() == 3);
  plan.stop_all();
  CHECK(cancelled == std::vector<TransferId>{7, 8});
}

}  // namespace gs::net::fetch_plan_test
