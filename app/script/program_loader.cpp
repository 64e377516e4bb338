#include "app/script/program_loader.h"

#include "app/script/natives.h"
#include "app/script/program_text.h"
#include "vrml/scene/values/field_numbers.h"

#include <js/CallAndConstruct.h>
#include <js/CompilationAndEvaluation.h>

#include <utility>

namespace gs::app::script {
namespace {

bool is_object(vrml::FieldType type) {
  return vrml::is_multiple(type) || vrml::number_count(type) > 1 || type == vrml::FieldType::SFImage;
}

}  // namespace

std::string modern_text_of(vrml::Execution& execution, const Program& program, std::string_view text) {
  std::vector<std::string> values, exposed;
  for (const auto& interface : execution.nodes().schema_of(program.node).interfaces) {
    const vrml::InterfaceDeclaration& declaration = *interface.declaration;
    if (declaration.access != vrml::AccessType::eventIn && is_object(declaration.type))
      values.push_back(declaration.name);
    if (declaration.access == vrml::AccessType::exposedField) exposed.push_back(declaration.name);
  }
  return contact_text(modern_text(text, values), exposed, is_browser_method);
}

void ProgramLoader::provide(vrml::EventNode script, std::optional<std::string> text, const std::string& url) {
  texts_[script] = {std::move(text), url};
}

bool ProgramLoader::load(Program& program, std::string_view text, const std::string& file, SourceLocation place) {
  JSContext* const context = engine_.context();
  bool good = false;
  calls_.run(program, [&] {
    const std::string modern = modern_text_of(execution_, program, text);
    program.undeclared = UndeclaredNames(modern);
    JS::RootedScript script(context, compile_mended(context, modern, file, place));
    JS::RootedValue ignored(context);
    if (!script) return false;
    good = true;
    return JS_ExecuteScript(context, script, &ignored);
  });
  return good;
}

bool ProgramLoader::start_text(Program& program, std::string_view text, const std::string& file, SourceLocation place) {
  JSContext* const context = engine_.context();
  if (!program.global && !make_global(context, execution_, program, calls_.clock().is_repeatable())) return false;
  if (!load(program, text, file, place)) return false;
  program.runs = true;
  calls_.run(program, [&] {
    JS::RootedValue function(context);
    if (!JS_GetProperty(context, program.global, "eventsProcessed", &function)) return false;
    program.has_processed = function.isObject() && JS::IsCallable(&function.toObject());
    if (program.language != vrml::Language::x3d) return true;
    if (!JS_GetProperty(context, program.global, "prepareEvents", &function)) return false;
    program.has_prepare = function.isObject() && JS::IsCallable(&function.toObject());
    return true;
  });
  calls_.call(program, "initialize");
  return true;
}

bool ProgramLoader::start_received_text(Program& program) {
  const auto text = texts_.extract(program.node);
  program.waits = false;
  return text.mapped().text && start_text(program, *text.mapped().text, text.mapped().url, {1, 1});
}

ScriptRequest ProgramLoader::next_files(Program& program, const vrml::MFString& urls) const {
  ScriptRequest wanted;
  wanted.kind = ScriptRequest::Kind::program;
  wanted.scene = program.scene;
  wanted.node = program.id;
  wanted.location = program.scene->node(program.id).location;
  wanted.origin = &text_of_program(program).origin();
  wanted.source = program.source;
  wanted.from_scene = program.scene;
  while (program.next_url < urls.size() &&
         program_place(urls[program.next_url].view()).kind == ProgramPlace::Kind::file)
    wanted.urls.push_back(urls[program.next_url++].str());
  return wanted;
}

bool ProgramLoader::start(Program& program) {
  const vrml::Node& script = program.scene->node(program.id);
  const vrml::InterfaceDeclaration* const url = script.type->find_field("url");
  const vrml::MFString urls = url ? std::get<vrml::MFString>(script.values[url->slot]) : vrml::MFString{};
  program.library = libraries_.of(program.source, program.language);
  if (!program.library) {
    messages_.report(Severity::error, program, "not enough memory for programs");
    return false;
  }
  const vrml::SourceText& text = text_of_program(program);
  const std::string file = text.file_name();
  const bool own_places = script.type->url_places.size() == urls.size() && url && &text == script.text;
  if (program.waits && start_received_text(program)) return true;
  while (program.next_url < urls.size()) {
    const ProgramPlace held = program_place(urls[program.next_url].view());
    if (held.kind == ProgramPlace::Kind::held) {
      SourceLocation at_place = own_places ? script.type->url_places[program.next_url] : script.location;
      const auto before = static_cast<std::uint32_t>(held.text.data() - urls[program.next_url].view().data());
      if (own_places) at_place.column += before + 1;
      ++program.next_url;
      if (start_text(program, held.text, file, at_place)) return true;
    } else if (held.kind == ProgramPlace::Kind::java) {
      messages_.report(Severity::warning, program, "Java programs are not supported; skipped");
      ++program.next_url;
    } else if (held.kind == ProgramPlace::Kind::file) {
      ScriptRequest wanted = next_files(program, urls);
      if (texts_.contains(program.node)) {
        if (start_received_text(program)) return true;
        continue;
      }
      program.waits = true;
      requests_.add_program(std::move(wanted));
      return false;
    } else {
      if (!held.text.empty())
        messages_.report(Severity::warning, program,
                         "programs in '" + std::string(held.text.substr(0, 40)) + "' are not supported; skipped");
      ++program.next_url;
    }
  }
  return false;
}

}  // namespace gs::app::script
