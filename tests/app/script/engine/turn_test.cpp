#include "app/script/engine/engine.h"
#include "base/thread_time.h"

#include <js/GlobalObject.h>
#include <js/Interrupt.h>
#include <js/Realm.h>
#include <js/RootingAPI.h>
#include <jsapi.h>

#include <catch2/catch.hpp>

#include <chrono>
#include <string>
#include <thread>

namespace gs::app::turn_test {
namespace {

using Clock = std::chrono::steady_clock;
constexpr double kSeconds = 0.02;

/// Reports whether the engine lets the program of this turn continue.
bool goes_on(script::Engine& engine) {
  JS_RequestInterruptCallback(engine.context());
  return JS_CheckForInterrupt(engine.context());
}

}  // namespace

TEST_CASE("stops a turn that used its processor time, not one that waited for a processor") {
  script::Engine* const engine = script::Engine::of_this_thread();
  REQUIRE(engine);
  static const JSClass kind{"global", JSCLASS_GLOBAL_FLAGS, &JS::DefaultGlobalClassOps, nullptr, nullptr, nullptr};
  const JS::RootedObject global(engine->context(), JS_NewGlobalObject(engine->context(), &kind, nullptr,
                                                                      JS::FireOnNewGlobalHook, JS::RealmOptions()));
  REQUIRE(global);
  const JSAutoRealm realm(engine->context(), global);
  const std::string late = "late";
  bool waited = false, quick = false;
  // On a busy machine, a turn may wait for over a second. The engine stops such a turn, and the test tries again.
  for (int attempts = 0; attempts < 20 && !quick; ++attempts) {
    script::Engine::Turn turn(*engine, kSeconds, std::size_t{64} << 20, late);
    const Clock::time_point began = Clock::now();
    std::this_thread::sleep_for(std::chrono::duration<double>(2 * kSeconds));
    waited = goes_on(*engine) && turn.stop() == script::Stop::none;
    quick = Clock::now() - began < std::chrono::seconds(1);
  }
  CHECK(waited);
  script::Engine::Turn turn(*engine, kSeconds, std::size_t{64} << 20, late);
  const double began = thread_seconds();
  while (thread_seconds() < began + 2 * kSeconds) continue;
  CHECK(!goes_on(*engine));
  CHECK(turn.stop() == script::Stop::time);
}

}  // namespace gs::app::turn_test
