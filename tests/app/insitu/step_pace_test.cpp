#include "app/insitu/step_pace.h"

#include <catch2/catch.hpp>

#include <cstdint>

namespace gs::app::insitu {
namespace step_pace_test {

/// Result of a simulated run.
struct Paced {
  int taken = 0, contacts = 0;
  double share = 0, largest_share = 0;  // at the end; maximum after the first step
};

// Simulates steps of `step` seconds each. Each taken step costs `cost` seconds more.
Paced run_paced(double most_share, std::int64_t every, int steps, double step, double cost) {
  StepPace pace(most_share, every);
  Paced result;
  double now = 0, own = 0;
  std::int64_t contact = 0;
  for (std::int64_t number = 0; number < steps; ++number, now += step) {
    if (number >= contact) {
      ++result.contacts;
      const bool take = pace.may_take(number, now, own);
      contact = number + pace.steps_until_contact(number, now, own, true);
      if (take) {
        ++result.taken;
        now += cost;
        own += cost;
        pace.note_cost(cost);
      }
    }
    if (result.taken > 1) result.largest_share = std::max(result.largest_share, own / now);
  }
  result.share = own / now;
  return result;
}

TEST_CASE("pace: the library keeps to its share of run time") {
  for (const double share : {0.01, 0.02, 0.2}) {
    INFO(share);
    const Paced paced = run_paced(share, 1, 20'000, 0.001, 0.05);
    CHECK(paced.taken > 1);
    CHECK(paced.share <= share);
    CHECK(paced.largest_share <= share);
    CHECK(paced.share >= share * 0.3);  // uses much of its share
  }
}

TEST_CASE("pace: without a limit, every wanted step is taken") {
  CHECK(run_paced(0, 1, 100, 0.001, 0.05).taken == 100);
  const Paced tenth = run_paced(0, 10, 100, 0.001, 0.05);
  CHECK(tenth.taken == 10);
  CHECK(tenth.contacts == 10);
}

TEST_CASE("pace: ranks agree often while viewers may request chunks, also between steps that may be taken") {
  StepPace pace(0, 1000);
  CHECK(pace.steps_until_contact(100, 1, 0, true) == 900);
  CHECK(pace.steps_until_contact(100, 1, 0, true, StepPace::kQuickContact) <= 5);
  CHECK(pace.steps_until_contact(999, 10, 0, true, StepPace::kQuickContact) == 1);
}

TEST_CASE("pace: ranks agree rarely between steps that are not taken") {
  const Paced paced = run_paced(0.01, 1, 100'000, 0.0001, 0.05);
  CHECK(paced.share <= 0.01);
  CHECK(paced.contacts < 1000);
}

TEST_CASE("pace: steps that nobody wants cost a contact in a quarter of a second") {
  StepPace pace(0.02, 1);
  pace.note_cost(0.1);
  CHECK(pace.steps_until_contact(0, 0, 0, false) == 1);
  CHECK(pace.steps_until_contact(1000, 1, 0, false) >= 249);
  CHECK(pace.steps_until_contact(10, 10, 0, false) == 1);
}

TEST_CASE("pace: thinned grids keep the share at the wanted pace") {
  // Each byte costs 10 ns; 100 steps take 0.3 s.
  StepPace pace(0.02, 100);
  double now = 0, own = 0;
  int taken = 0;
  for (std::int64_t number = 0; number < 10'000; ++number, now += 0.003) {
    if (!pace.may_take(number, now, own)) continue;
    const std::uint64_t bytes = std::min(pace.affordable_bytes(number, now, own), std::uint64_t{8} << 20);
    const double cost = static_cast<double>(bytes) * 1e-8;
    ++taken;
    now += cost;
    own += cost;
    pace.note_cost(cost, bytes);
  }
  CHECK(taken > 60);
  CHECK(own / now <= 0.02);
  CHECK(own / now > 0.01);
  CHECK(StepPace(0, 1).affordable_bytes(5, 1, 0) == UINT64_MAX);
}

TEST_CASE("pace: a larger share permits the next step earlier") {
  StepPace pace(0.02, 1);
  pace.note_cost(0.1);
  CHECK_FALSE(pace.may_take(1, 4, 0.1));
  pace.set_share(0.1);
  CHECK(pace.may_take(1, 4, 0.1));
}

TEST_CASE("pace: a step that costs more than expected delays the next one") {
  StepPace pace(0.1, 1);
  CHECK(pace.may_take(0, 0, 0));
  pace.note_cost(0.1);
  CHECK_FALSE(pace.may_take(1, 2, 0.1));
  CHECK(pace.may_take(1, 4, 0.1));
  pace.note_cost(1);
  CHECK_FALSE(pace.may_take(2, 5, 0.2));
  CHECK(pace.may_take(3, 30, 0.2));
}

}  // namespace step_pace_test
}  // namespace gs::app::insitu
