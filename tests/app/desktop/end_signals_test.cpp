#include "app/desktop/end_signals.h"

#include <catch2/catch.hpp>

#include <csignal>
#include <future>

namespace gs::app::end_signals_test {

TEST_CASE("wakes the program by a termination signal, and continues") {
  for (const int signal : {SIGTERM, SIGINT}) {
    std::promise<bool> woken;
    struct sigaction before {};
    REQUIRE(sigaction(signal, nullptr, &before) == 0);
    {
      const EndWatch watch([&] { woken.set_value(EndOnSignals::told()); });
      CHECK_FALSE(EndOnSignals::told());
      REQUIRE(std::raise(signal) == 0);
      CHECK(woken.get_future().get());
      CHECK(EndOnSignals::told());
    }
    struct sigaction now {};
    REQUIRE(sigaction(signal, nullptr, &now) == 0);
    CHECK((now.sa_handler == before.sa_handler));
  }
}

TEST_CASE("wakes nothing without a signal") {
  bool woken = false;
  {
    const EndWatch watch([&] { woken = true; });
  }
  CHECK_FALSE(woken);
}

}  // namespace gs::app::end_signals_test
