#include "app/script/bounds/bounded_natives.h"
#include "app/script/natives.h"
#include "app/script/program_text.h"
#include "app/script/script_runner.h"

#include <js/CompilationAndEvaluation.h>
#include <js/CompileOptions.h>
#include <js/ErrorReport.h>
#include <js/Exception.h>
#include <js/Object.h>
#include <js/Realm.h>
#include <js/SourceText.h>
#include <js/friend/ErrorMessages.h>

#include <algorithm>
#include <utility>

// Compilation of programs, and conversion of exceptions to diagnostics.
namespace gs::app::script {

namespace {

JSScript* compile(JSContext* context, const JS::CompileOptions& options, const std::string& text) {
  JS::SourceText<mozilla::Utf8Unit> source;
  if (!source.init(context, text.data(), text.size(), JS::SourceOwnership::Borrowed)) return nullptr;
  return JS::Compile(context, options, source);
}

}  // namespace

JSScript* compile_mended(JSContext* context, const std::string& text, const std::string& file, SourceLocation place) {
  JS::CompileOptions options(context);
  options.setFileAndLine(file.c_str(), std::max(1U, place.line));
  options.setColumn(place.column > 0 ? place.column - 1 : 0);
  if (!check_program(context, text)) return nullptr;
  JS::RootedScript made(context, compile(context, options, text));
  if (made) return check_integers(context, text) ? made.get() : nullptr;
  if (!JS_IsExceptionPending(context)) return nullptr;
  JS::AutoSaveExceptionState first(context);
  const std::string mended = mended_text(text);
  made = compile(context, options, mended);
  if (!made) return nullptr;
  first.drop();
  return check_integers(context, mended) ? made.get() : nullptr;
}

/// Clears the pending exception and returns its text and position. Returns nullopt if it has no text.
std::optional<Diagnostic> take_exception(JSContext* context, bool& recursion) {
  JS::ExceptionStack stack(context);
  JS::ErrorReportBuilder builder(context);
  if (!JS::StealPendingExceptionStack(context, &stack) ||
      !builder.init(context, stack, JS::ErrorReportBuilder::NoSideEffects)) {
    JS_ClearPendingException(context);
    return std::nullopt;
  }
  const JSErrorReport* const found = builder.report();
  Diagnostic one{Severity::error, found && found->filename ? found->filename : std::string(), {}, {}};
  if (found) one.location = {found->lineno, found->lineno == 0 ? 0 : std::max(1U, found->column)};
  one.message = builder.toStringResult() ? builder.toStringResult().c_str() : "the program failed";
  constexpr std::size_t kMaxText = 400;
  if (one.message.size() > kMaxText) one.message.resize(kMaxText);
  recursion = found && found->errorNumber == JSMSG_OVER_RECURSED;
  return one;
}

namespace {

std::optional<Diagnostic> compile_problem(JSContext* context, const std::string& text, const std::string& file,
                                          SourceLocation place) {
  if (compile_mended(context, text, file, place)) return std::nullopt;
  bool recursion = false;
  auto problem = take_exception(context, recursion);
  return problem ? problem : Diagnostic{Severity::error, file, place, "the program cannot be compiled"};
}

}  // namespace

}  // namespace gs::app::script

namespace gs::app {

void check_programs(const vrml::SceneGraph& scene, Diagnostics& diagnostics) {
  script::Engine* const engine = script::Engine::of_this_thread();
  if (!engine) return;
  JSContext* const context = engine->context();
  JS::RootedObject global(context, script::new_global(context, nullptr, nullptr));
  if (!global) return;
  const JSAutoRealm realm(context, global);
  for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i) {
    const vrml::Node& node = scene.nodes().at(i);
    if (!node.type || !vrml::has(node.type->role, vrml::Role::script) || !scene.contains(scene.nodes().id_at(i)))
      continue;
    if (node.instance != 0) continue;  // a copy in a PROTO instance; its original is checked
    const vrml::InterfaceDeclaration* const url = node.type->find_field("url");
    const auto* const list = url ? std::get_if<vrml::MFString>(&node.values[url->slot]) : nullptr;
    if (!list) continue;
    for (std::size_t k = 0; k < list->size(); ++k) {
      const ProgramPlace held = program_place((*list)[k].view());
      const std::string label = node.name.empty() ? "Script" : "Script " + std::string(node.name);
      if (held.kind == ProgramPlace::Kind::java)
        diagnostics.add({Severity::warning, node.text->file_name(), node.location,
                         label + ": Java programs are not supported; skipped"});
      if (held.kind != ProgramPlace::Kind::held) continue;
      SourceLocation at = node.location;
      if (node.type->url_places.size() == list->size()) {
        at = node.type->url_places[k];
        at.column += static_cast<std::uint32_t>(held.text.data() - (*list)[k].view().data()) + 1;
      }
      if (auto problem = script::compile_problem(context, std::string(held.text), node.text->file_name(), at)) {
        problem->message = label + ": " + problem->message;
        diagnostics.add(std::move(*problem));
      }
    }
  }
}

}  // namespace gs::app
