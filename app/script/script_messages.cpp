#include "app/script/script_messages.h"

#include "app/script/program_text.h"

#include <utility>

namespace gs::app::script {
namespace {

constexpr std::size_t kMaxMessages = 1000, kMaxSaid = 4000;

}  // namespace

std::string label_of(const Program& program) {
  const vrml::Node& node = program.scene->node(program.id);
  return node.name.empty() ? std::string("Script") : "Script " + std::string(node.name);
}

std::string late_message_of(const Program& program) {
  const vrml::Node& node = program.scene->node(program.id);
  return Diagnostic{Severity::error, node.text->file_name(), node.location,
                    label_of(program) + ": " + ProgramFaults::kLate}
      .text();
}

void ScriptMessages::tell(ScriptMessage message) {
  if (observer_) return observer_(message);
  if (messages_.size() < kMaxMessages) messages_.push_back(std::move(message));
}

void ScriptMessages::print(std::string text) {
  constexpr std::size_t kMaxText = 4096;
  if (text.size() > kMaxText) text.resize(kMaxText);
  tell({{Severity::note, "", {}, std::move(text)}, true});
}

void ScriptMessages::report(Diagnostic problem) {
  if (said_.size() < kMaxSaid && said_.insert(problem.text()).second) tell({std::move(problem), false});
}

void ScriptMessages::report(Severity severity, const Program& program, std::string message,
                            std::optional<Diagnostic> at) {
  const vrml::Node& node = program.scene->node(program.id);
  Diagnostic one = at.value_or(Diagnostic{severity, node.text->file_name(), node.location, {}});
  one.severity = severity;
  one.message = label_of(program) + ": " + std::move(message);
  report(std::move(one));
}

void ScriptMessages::report_direct_output(Program& program) {
  if (std::exchange(program.told_direct, true)) return;
  const vrml::Node& script = program.scene->node(program.id);
  const vrml::InterfaceDeclaration* const direct = script.type->find_field("directOutput");
  if (direct && !std::get<vrml::SFBool>(script.values[direct->slot]))
    report(Severity::warning, program, "writes to other nodes with directOutput FALSE (VRML97 4.12.5)");
}

void ProgramFaults::report(Program& program, const Engine::Turn& turn) {
  JSContext* const context = engine_.context();
  if (turn.stop() == Stop::none && JS_IsExceptionPending(context)) {
    report_exception(program);
  } else if (turn.stop() == Stop::memory) {
    add(program, "the program exceeds the " + std::to_string(execution_.scenes().root().limits().script_heap >> 20) +
                     " MiB limit for the programs of a world");
  } else {
    add(program, turn.stop() == Stop::time ? kLate : "the program failed");
  }
  JS_ClearPendingException(context);
}

void ProgramFaults::add(Program& program, const std::string& why, std::optional<Diagnostic> at) {
  const bool last = ++program.faults >= kMax;
  messages_.report(Severity::error, program,
                   why + (last ? "; this third fault switches the program off"
                               : " (fault " + std::to_string(program.faults) + " of " + std::to_string(kMax) + ")"),
                   std::move(at));
  program.off = last;
}

void ProgramFaults::report_exception(Program& program) {
  const bool no_memory = JS_IsThrowingOutOfMemory(engine_.context());
  bool recursion = false;
  std::optional<Diagnostic> at = take_exception(engine_.context(), recursion);
  if (no_memory) return add(program, "the program exceeds the memory limit");
  if (!at) return add(program, "the program failed");
  const vrml::Node& node = program.scene->node(program.id);
  if (at->file.empty()) at->file = node.text->file_name();
  if (at->location.line == 0) at->location = node.location;
  std::string text = std::move(at->message);
  if (recursion) return add(program, text, std::move(at));
  messages_.report(Severity::error, program, std::move(text), std::move(at));
}

}  // namespace gs::app::script
