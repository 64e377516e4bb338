#include "app/script/world/script_messages.h"

#include <utility>

namespace gs::app::script {
namespace {

constexpr std::size_t kMaxMessages = 1000, kMaxSaid = 4000;

}  // namespace

const vrml::SourceText& text_of_program(const ScriptRecord& script) {
  const vrml::Node& node = script.scene->node(script.id);
  const vrml::InterfaceDeclaration* const url = node.type->find_field("url");
  return url ? script.scene->nodes().text_of(script.id, url->slot) : *node.text;
}

std::string label_of(const ScriptRecord& script) {
  const vrml::Node& node = script.scene->node(script.id);
  return node.name.empty() ? std::string("Script") : "Script " + std::string(node.name);
}

std::string late_message_of(const ScriptRecord& script) {
  const vrml::Node& node = script.scene->node(script.id);
  return Diagnostic{Severity::error, node.text->file_name(), node.location, label_of(script) + ": " + kLateProgram}
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

void ScriptMessages::report(Severity severity, const ScriptRecord& script, std::string message,
                            std::optional<Diagnostic> at) {
  const vrml::Node& node = script.scene->node(script.id);
  Diagnostic one = at.value_or(Diagnostic{});
  if (one.file.empty()) one.file = node.text->file_name();
  if (one.location.line == 0) one.location = node.location;
  one.severity = severity;
  one.message = label_of(script) + ": " + std::move(message);
  report(std::move(one));
}

void ScriptMessages::report_direct_output(ScriptRecord& script) {
  if (std::exchange(script.told_direct, true)) return;
  const vrml::Node& node = script.scene->node(script.id);
  const vrml::InterfaceDeclaration* const direct = node.type->find_field("directOutput");
  if (direct && !std::get<vrml::SFBool>(node.values[direct->slot]))
    report(Severity::warning, script, "writes to other nodes with directOutput FALSE (VRML97 4.12.5)");
}

}  // namespace gs::app::script
