#include "app/world/scene_handler.h"
#include "vrml/scene/prototype.h"
#include "vrml/syntax/stand_ins.h"

#include <algorithm>
#include <optional>
#include <utility>

// Where the PROTOs of a scene's EXTERNPROTOs come from.
namespace gs::app {
namespace {

using vrml::Severity;

// Whether a url names a file, or a part of it.
bool names_file(net::Url url, const std::string& file) {
  url.fragment.clear();
  url.has_fragment = false;
  return url.text() == file;
}

}  // namespace

void SceneHandler::look_for_prototypes() {
  std::unordered_map<std::string, SceneHandler*> fresh;  // EXTERNPROTOs of one file are one library
  for (const auto& type : scene->types()) {
    if (type->kind != vrml::NodeType::Kind::external_prototype || type->prototype ||
        !used_types_.contains(type.get()) || !asked_types_.insert(type.get()).second)
      continue;
    Reference reference = refer(type->url, *scene);
    // What names this file itself is not fetched. First of all it is the one; behind others, where these cannot be had.
    std::optional<std::string> own;
    const auto origin = origins_.find(scene);
    const bool own_first = !reference.places.empty() && origin != origins_.end() &&
                           names_file(reference.places.front(), origin->second.url);
    std::erase_if(reference.places, [&](const net::Url& url) {
      if (origin == origins_.end() || !names_file(url, origin->second.url)) return false;
      if (!own) own = url.fragment;
      return true;
    });
    if (own_first || (own && reference.places.empty())) {
      own_types_.emplace_back(type.get(), *own);
      continue;
    }
    if (own) own_fragments_[type.get()] = *own;
    std::vector<net::Url> files = reference.places;
    for (net::Url& url : files) url.fragment.clear(), url.has_fragment = false;
    const std::string fragment = files.empty() ? std::string() : reference.places.front().fragment;
    SceneHandler*& known = fresh[fetch_key(files, reference.from)];
    if (known) {
      known->types.push_back(type.get());
      known->fragments.push_back(fragment);
      continue;
    }
    auto library = std::make_shared<SceneHandler>(world_, Role::library, this);
    known = library.get();
    library->what = "EXTERNPROTO " + type->name;
    library->place_file = scene->file_name();
    library->urls = type->url;
    library->types = {type.get()};
    library->fragments = {fragment};
    libraries_.push_back(library);
    ++awaited_libraries_;
    ask_for(std::move(reference), nullptr, std::move(library), Urgency::prototypes);
  }
  take_own_prototypes();
}

// Those whose EXTERNPROTO names the file that it stands in (4.9.2): when they are complete.
void SceneHandler::take_own_prototypes() {
  const std::size_t before = to_resolve_.size(), waiting = own_types_.size();
  std::erase_if(own_types_, [&](const auto& one) {
    const auto& [type, name] = one;
    const vrml::NodeType* source = vrml::find_own_prototype(*scene, name);
    if (!source && !text_ended_) return false;
    if (!source) {
      report(Severity::error, type->location,
             "no PROTO" + (name.empty() ? "" : " '" + name + "'") + " in this file for EXTERNPROTO " + type->name);
      stand_in(*type);
    } else if (vrml::stands_inside(*type, *source)) {
      report(Severity::error, type->location,
             "EXTERNPROTO " + type->name + " stands inside its own PROTO " + source->name + "; left out");
    } else {
      take_prototype(*type, *source, scene->file_name());
      resolve_types();  // so that the next one is looked for in the body of this one
    }
    return true;
  });
  if (to_resolve_.size() != before) resolve_types();
  if (own_types_.size() != waiting) look_for_references();  // of what has come in
}

bool SceneHandler::stand_in(vrml::NodeType& type) {
  const vrml::NodeType* source = vrml::stand_in_for(*scene, type);
  if (source) to_resolve_.emplace_back(&type, source);
  return source != nullptr;
}

// One that cannot be had, because of `why`.
void SceneHandler::miss_prototype(vrml::NodeType& type, const std::string& why, bool told_already) {
  if (const auto own = own_fragments_.find(&type); own != own_fragments_.end()) {
    own_types_.emplace_back(&type, own->second);
    return;
  }
  const bool replaced = stand_in(type);
  const vrml::NodeType* own = vrml::built_in_node_type(type.name);
  const bool is_fallback = own && own->url_content == vrml::UrlContent::vectors;  // for browsers without our own node
  if (told_already || is_fallback) return;
  report(Severity::warning, type.location,
         "EXTERNPROTO " + type.name + ": " + why_missing(type.url, why) +
             (replaced ? "; a stand-in takes its place" : ""));
}

void SceneHandler::take_library(SceneHandler& library) {
  if (library.scene && !library.refused) {
    origins_.insert(library.origins_.begin(), library.origins_.end());
    vrml::SceneGraph& attached = scene->attach_library(std::move(library.own_));
    const std::string& file = attached.file_name();
    for (std::size_t i = 0; i < library.types.size(); ++i) {
      vrml::NodeType& type = *library.types[i];
      const std::string& name = library.fragments[i];
      const vrml::NodeType* source = vrml::find_prototype(attached, name);
      if (!source || !source->prototype) {
        report(Severity::error, {},
               file + " declares no PROTO" + (name.empty() ? "" : " '" + name + "'") + " for EXTERNPROTO " + type.name);
        (void)stand_in(type);
      } else {
        take_prototype(type, *source, file);
      }
    }
  }
  --awaited_libraries_;
  resolve_types();
  look_for_references();
  settle();
}

void SceneHandler::take_prototype(vrml::NodeType& type, const vrml::NodeType& source, const std::string& file) {
  if (const vrml::InterfaceDeclaration* odd = vrml::unlike_prototype(type, source))
    report(Severity::warning, type.location,
           "PROTO " + source.name + " of " + file + " has no " + std::string(name_of(odd->access)) + ' ' +
               std::string(name_of(odd->type)) + " '" + odd->name + "', as EXTERNPROTO " + type.name +
               " says (VRML97 4.9.2)");
  to_resolve_.emplace_back(&type, &source);
}

// Instances whose own fields are still being read must wait for them.
void SceneHandler::resolve_types() {
  std::unordered_set<const vrml::NodeType*> open_types;
  if (parser_)
    for (const vrml::NodeId id : parser_->open_nodes()) open_types.insert(scene->node(id).type);
  std::erase_if(to_resolve_, [&](const auto& one) {
    if (open_types.contains(one.first)) return false;
    if (!vrml::resolve_external(*scene, *one.first, *one.second))
      report(Severity::error, {}, "EXTERNPROTO instances make more nodes than the limit; the rest stay empty");
    world_.changed = true;
    return true;
  });
}

// Instances of a library's PROTOs stand in other scenes; what they are made of is to be had here.
void SceneHandler::use_types_inside() {
  std::vector<const vrml::NodeType*> waiting;
  std::unordered_set<const vrml::NodeType*> seen;
  for (const std::string& name : fragments)
    if (const vrml::NodeType* source = vrml::find_prototype(*scene, name)) waiting.push_back(source);
  while (!waiting.empty()) {
    const vrml::NodeType& type = *waiting.back();
    waiting.pop_back();
    if (!seen.insert(&type).second) continue;
    if (type.kind == vrml::NodeType::Kind::external_prototype) used_types_.insert(&type);
    if (!type.prototype) continue;
    for (const vrml::NodeId id : type.prototype->nodes) waiting.push_back(type.prototype->scene->node(id).type);
  }
}

}  // namespace gs::app
