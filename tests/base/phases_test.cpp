#include "base/phases.h"

#include <catch2/catch.hpp>

namespace gs {
namespace {

double now_of_phases = 0;

TEST_CASE("counts the time of an inner phase apart from its outer phase") {
  now_of_phases = 100;
  PhaseClock clock([] { return now_of_phases; }, 99.5);
  {
    const PhaseScope draw(&clock, Phase::draw);
    now_of_phases = 101;
    {
      const PhaseScope compile(&clock, Phase::compile);
      now_of_phases = 103;
    }
    now_of_phases = 103.25;
    const PhaseScope nothing(nullptr, Phase::write);
  }
  now_of_phases = 104;
  clock.enter(Phase::write);
  CHECK(clock.seconds(Phase::other) == Approx(0.5 + 0.75));
  CHECK(clock.seconds(Phase::draw) == Approx(1.25));
  CHECK(clock.seconds(Phase::compile) == Approx(2));
  CHECK(clock.seconds(Phase::write) == 0);
  CHECK(clock.total() == Approx(4.5));
}

}  // namespace
}  // namespace gs
