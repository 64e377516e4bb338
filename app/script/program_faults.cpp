#include "app/script/program_faults.h"

#include "app/script/program_text.h"

#include <utility>

namespace gs::app::script {

void ProgramFaults::report(Program& program, const Engine::Turn& turn, std::size_t heap) {
  JSContext* const context = engine_.context();
  if (turn.stop() == Stop::none && JS_IsExceptionPending(context)) {
    report_exception(program);
  } else if (turn.stop() == Stop::memory) {
    add(program, "the program exceeds the " + std::to_string(heap >> 20) + " MiB limit for the programs of a world");
  } else {
    add(program, turn.stop() == Stop::time ? kLateProgram : "the program failed");
  }
  JS_ClearPendingException(context);
}

void ProgramFaults::add(Program& program, const std::string& why, std::optional<Diagnostic> at) {
  const bool last = ++program.faults >= kMaxFaults;
  view_.report(Severity::error,
               why + (last ? "; this third fault switches the program off"
                           : " (fault " + std::to_string(program.faults) + " of " + std::to_string(kMaxFaults) + ")"),
               std::move(at));
  program.off = last;
}

void ProgramFaults::report_exception(Program& program) {
  const bool no_memory = JS_IsThrowingOutOfMemory(engine_.context());
  bool recursion = false;
  std::optional<Diagnostic> at = take_exception(engine_.context(), recursion);
  if (no_memory) return add(program, "the program exceeds the memory limit");
  if (!at) return add(program, "the program failed");
  std::string text = std::move(at->message);
  if (recursion) return add(program, text, std::move(at));
  view_.report(Severity::error, std::move(text), std::move(at));
}

}  // namespace gs::app::script
