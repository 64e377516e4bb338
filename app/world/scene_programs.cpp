#include "app/script/script_runner.h"
#include "app/world/scene_handler.h"

#include <utility>

// Programs of Scripts in own files (VRML97 4.12.1), and texts that programs request.
namespace gs::app {

/// Content handler for a text of VRML or of a program, optionally gzip-compressed.
struct WorldLoading::State::TextHandler final : ContentHandler {
  TextHandler(State& state, const SceneHandler* waits, const UrlRequest& request)
      : world(state), waits_for(waits), what(request), held(state.budget, Resource::files) {}

  [[nodiscard]] const SceneHandler* makes_nodes_of() const override { return waits_for; }
  bool begin(const Found& where) override {
    found = where;
    return true;
  }
  void receive(std::span<const std::byte> piece) override {
    if (!full && held.grow(piece.size())) {
      bytes.insert(bytes.end(), piece.begin(), piece.end());
    } else if (!std::exchange(full, true)) {
      world.report(Severity::warning, what.file, what.location,
                   what.type + " " + found.path + ": " + world.budget->refusal(Resource::files) + "; left out");
    }
  }
  void end(const std::optional<std::string>& problem) override {
    if (problem) world.report(Severity::warning, what.file, what.location, what.type + ": " + *problem);
    if (full || problem) return give(std::nullopt);
    if (!is_gzip(bytes)) return give(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    const UnpackedBytes unpacked = unpack_gzip(bytes, world.budget, Resource::files);
    if (unpacked.problem) {
      world.report(Severity::warning, what.file, what.location,
                   what.type + " " + found.path + ": " + *unpacked.problem);
      return give(std::nullopt);
    }
    give(std::string(reinterpret_cast<const char*>(unpacked.bytes.data()), unpacked.bytes.size()));
  }
  void missing(const std::string& why) override {
    if (!told)
      world.report(Severity::warning, what.file, what.location, what.type + ": " + why_missing(what.urls, why));
    give(std::nullopt);
  }
  void give(std::optional<std::string> text) {
    bytes = {};
    held.shrink_to(0);
    world.text_arrived({what.place, std::move(text), found.path, source_of(found.origin)});
  }

  State& world;
  const SceneHandler* waits_for;
  UrlRequest what;
  Found found;
  std::vector<std::byte> bytes;
  Share held;  // of the bytes
  bool full = false;
};

void WorldLoading::State::text_arrived(ResourceUpdates::Text text) {
  if (taken)
    updates.texts.push_back(std::move(text));
  else
    world.programs.push_back({text.place.scene, text.place.node, std::move(text.text), std::move(text.url)});
}

// Fetches the files of the url list before the first inline program.
void SceneHandler::visit_script(vrml::NodeId id) {
  const vrml::Node& node = scene->node(id);
  const vrml::InterfaceDeclaration* const url = node.type->find_field("url");
  const auto* const list = url ? std::get_if<vrml::MFString>(&node.values[url->slot]) : nullptr;
  if (!list) return;
  UrlRequest request;
  request.place = {scene, id};
  request.node = &node;
  request.as_text = true;
  request.type = node.type->name;
  request.file = node.text->file_name();
  request.location = node.location;
  for (const vrml::SFString& one : *list) {
    const ProgramPlace::Kind kind = program_place(one.view()).kind;
    if (kind == ProgramPlace::Kind::held) break;
    if (kind == ProgramPlace::Kind::file) request.urls.push_back(one);
  }
  Reference reference = refer(request.urls, scene->text_of(id, url->slot));
  if (reference.places.empty()) return;
  ask_for(std::move(reference), &node, std::make_shared<WorldLoading::State::TextHandler>(world_, this, request),
          Urgency::prototypes);
}

void SceneHandler::load_text(const UrlRequest& request, Reference reference) {
  if (reference.places.empty()) return world_.text_arrived({request.place, std::nullopt, {}, {}});
  ask_for(std::move(reference), request.node,
          std::make_shared<WorldLoading::State::TextHandler>(world_, nullptr, request), Urgency::inline_scene);
}

}  // namespace gs::app
