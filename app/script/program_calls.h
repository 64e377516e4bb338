#pragma once

#include "app/script/assignments.h"
#include "app/script/engine/engine.h"
#include "app/script/engine/script_clock.h"
#include "app/script/program_faults.h"
#include "base/noncopyable.h"

#include <jsapi.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

namespace gs::app::script {

/// Calls of the programs of a world: their limits, their promise jobs, and the events of their assignments. One thread.
class ProgramCalls {
 public:
  /// All arguments must outlive the object.
  ProgramCalls(WorldView& view, Engine& engine, bool repeatable);

  /// Sets the limits and the time of the next calls.
  void prepare(const Order& order);

  /// Returns the program that the engine is running.
  [[nodiscard]] Program& running() { return *running_; }
  [[nodiscard]] std::size_t image_pixels() const { return image_pixels_; }

  /// Runs `what` in the global object of a program and within its limits. Then sends the events of its assignments.
  template <class Do>
  void run(Program& program, const Do& what) {
    if (program.off || !program.global) return;
    const Call call(*this, program);
    Engine::Turn turn = make_turn(program);
    const JSAutoRealm realm(engine_.context(), program.global);
    if (!what() || turn.stop() != Stop::none) faults_.report(program, turn, heap_);
    run_jobs(program, turn);
    if (!changed_.flush(engine_.context())) JS_ClearPendingException(engine_.context());
  }
  /// Calls a function of a program without arguments, if it exists.
  void call(Program& program, const char* name);
  /// Calls the function of an eventIn, if it exists.
  void call_event(Program& program, std::uint32_t interface, const vrml::FieldValue& value, double time);
  /// Runs a line of code in a program; see ScriptRunner::evaluate(). Returns the text of its value or error.
  [[nodiscard]] Report evaluate(Program& program, const std::string& line);

  /// Records that a field or eventOut of a Script was written.
  void own_changed(Program& program, std::uint32_t place);
  [[nodiscard]] PostedEvents& posted() { return posted_; }
  [[nodiscard]] ChangedLists& changed() { return changed_; }
  [[nodiscard]] ScriptClock& clock() { return clock_; }

 private:
  /// Guard of one call. At its end, sends the events of the program's assignments.
  class Call : NonCopyable {
   public:
    Call(ProgramCalls& calls, Program& program);
    ~Call();

   private:
    ProgramCalls& calls_;
    Program& program_;
    Program* const outer_;
  };

  [[nodiscard]] Engine::Turn make_turn(const Program& program);
  void run_jobs(Program& program, Engine::Turn& turn);

  Engine& engine_;
  ProgramFaults faults_;
  PostedEvents posted_;
  ChangedLists changed_;
  ScriptClock clock_;
  double now_ = 0, seconds_ = 0;
  std::size_t heap_ = 0, image_pixels_ = 0;
  Program* running_ = nullptr;
};

}  // namespace gs::app::script
