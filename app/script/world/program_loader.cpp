#include "app/script/world/program_loader.h"

#include <utility>

namespace gs::app::script {

void ProgramLoader::provide(vrml::EventNode script, std::optional<std::string> text, const std::string& url) {
  texts_[script] = {std::move(text), url};
}

bool ProgramLoader::start_received_text(ScriptRecord& program) {
  const auto text = texts_.extract(program.node);
  program.waits = false;
  return text.mapped().text && starter_.start_text(program, *text.mapped().text, text.mapped().url, {1, 1});
}

ScriptRequest ProgramLoader::next_files(ScriptRecord& program, const vrml::MFString& urls) {
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

bool ProgramLoader::start(ScriptRecord& program) {
  const vrml::Node& script = program.scene->node(program.id);
  const vrml::InterfaceDeclaration* const url = script.type->find_field("url");
  const vrml::MFString urls = url ? std::get<vrml::MFString>(script.values[url->slot]) : vrml::MFString{};
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
      if (starter_.start_text(program, held.text, file, at_place)) return true;
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
