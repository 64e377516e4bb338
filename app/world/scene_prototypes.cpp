#include "app/world/scene_handler.h"
#include "vrml/scene/prototype.h"
#include "vrml/syntax/stand_ins.h"

#include <algorithm>
#include <optional>
#include <utility>

// PROTOs for the EXTERNPROTOs of a scene.
namespace gs::app {
namespace {

// Returns true if a url refers to this file or to a part of it.
bool names_file(net::Url url, const std::string& file) {
  url.fragment.clear();
  url.has_fragment = false;
  return url.text() == file;
}

}  // namespace

void SceneHandler::look_for_prototypes() {
  Libraries fresh;
  for (const auto& type : scene->types()) {
    if (type->kind != vrml::NodeType::Kind::external_prototype || type->prototype ||
        !used_types_.contains(type.get()) || !asked_types_.insert(type.get()).second)
      continue;
    AwaitedPrototype wanted{type.get(), {}, {}};
    if (ask_for_prototype(wanted, refer(type->url, *scene), {type->name, scene->file_name(), type->url}, fresh))
      continue;
    own_types_.emplace_back(type.get(), *wanted.own_name);
  }
  take_own_prototypes();
}

// Fetches the library of an EXTERNPROTO. Returns false without fetching if its first url refers to its own text;
// `wanted` then has the name of the PROTO.
bool SceneHandler::ask_for_prototype(AwaitedPrototype& wanted, Reference reference, const PrototypePlace& named,
                                     Libraries& fresh) {
  // A url of this file is not fetched. As the first url it is used at once, otherwise if the other urls fail.
  const std::string& own_url = found_.origin.url;
  const bool own_first = !reference.places.empty() && names_file(reference.places.front(), own_url);
  std::erase_if(reference.places, [&](const net::Url& url) {
    if (!names_file(url, own_url)) return false;
    if (!wanted.own_name) wanted.own_name = url.fragment;
    return true;
  });
  if (own_first || (wanted.own_name && reference.places.empty())) return false;
  std::vector<net::Url> files = reference.places;
  for (net::Url& url : files) url.fragment.clear(), url.has_fragment = false;
  if (!files.empty()) wanted.name = reference.places.front().fragment;
  SceneHandler*& known = fresh[fetch_key(files, reference.from)];
  if (known) {
    known->awaiting.push_back(wanted);
    return true;
  }
  auto library = std::make_shared<SceneHandler>(world_, Role::library, this);
  known = library.get();
  library->what = "EXTERNPROTO " + named.name;
  library->place_file = named.file;
  library->urls = named.urls;
  library->awaiting = {wanted};
  libraries_.push_back(library);
  ++awaited_libraries_;
  ask_for(std::move(reference), nullptr, std::move(library), Urgency::prototypes);
  return true;
}

// Requests the library of an EXTERNPROTO in a text that was read into the running world. Its types belong to that
// world.
void SceneHandler::load_prototype(const UrlRequest& request) {
  Libraries fresh;
  AwaitedPrototype wanted{request.prototype, {}, {}};
  if (!ask_for_prototype(wanted, refer(request.urls, request.source, request.fetched),
                         {request.type, request.file, request.urls}, fresh))
    give_prototypes({wanted}, nullptr, std::nullopt);
}

// Resolves EXTERNPROTOs that refer to a PROTO of their own file (VRML97 4.9.2), once it is complete.
void SceneHandler::take_own_prototypes() {
  const std::size_t before = to_resolve_.size(), waiting = own_types_.size();
  std::erase_if(own_types_, [&](const auto& one) {
    const auto& [type, name] = one;
    if (!vrml::find_own_prototype(*scene, name) && !nothing_more_comes()) return false;
    const vrml::NodeType* source = prototype_in_own_text(*scene, *type, name, reporter());
    if (!source) {
      stand_in(*type);
    } else if (vrml::stands_inside(*type, *source)) {
      report(Severity::error, type->location,
             "EXTERNPROTO " + type->name + " is inside its own PROTO " + source->name + "; left out");
    } else {
      to_resolve_.emplace_back(type, source);
      resolve_types();  // so that the next one can be found in the body of this one
    }
    return true;
  });
  if (to_resolve_.size() != before) resolve_types();
  if (own_types_.size() != waiting) look_for_references();  // handles the nodes of the new bodies
}

bool SceneHandler::stand_in(vrml::NodeType& type) {
  const vrml::NodeType* source = vrml::stand_in_for(*scene, type);
  if (source) to_resolve_.emplace_back(&type, source);
  return source != nullptr;
}

// Handles a missing library. `why` is the reason, or nullopt if it was already reported.
void SceneHandler::miss_prototypes(const SceneHandler& library, const std::optional<std::string>& why) {
  if (owner_ == Owner::world_runtime) return give_prototypes(library.awaiting, nullptr, why);
  for (const AwaitedPrototype& one : library.awaiting) {
    if (one.own_name) {
      own_types_.emplace_back(one.type, *one.own_name);
      continue;
    }
    const bool replaced = stand_in(*one.type);
    if (why) tell_missing_prototype(*one.type, *why, replaced, reporter());
  }
}

void SceneHandler::take_library(SceneHandler& library) {
  --awaited_libraries_;
  const bool usable = library.scene && !library.refused();
  if (owner_ == Owner::world_runtime) {
    if (!usable) return;
    library.give_away();
    give_prototypes(library.awaiting, std::move(library.own_), std::nullopt);
    return;
  }
  if (usable) {
    const vrml::SceneGraph& attached = scene->attach_library(std::move(library.own_));
    for (const AwaitedPrototype& one : library.awaiting) {
      if (const vrml::NodeType* source = prototype_in_library(attached, *one.type, one.name, reporter()))
        to_resolve_.emplace_back(one.type, source);
      else
        (void)stand_in(*one.type);
    }
  }
  resolve_types();
  look_for_references();
  settle();
}

// Passes prototypes to the running world, which owns the types.
void SceneHandler::give_prototypes(std::vector<AwaitedPrototype> awaited, std::unique_ptr<vrml::SceneGraph> library,
                                   std::optional<std::string> why) {
  ResourceUpdates::Prototypes update;
  update.scene = scene;
  update.scene_held = given_.lock();
  if (role != Role::root && !update.scene_held) return;  // the Inline was removed
  update.awaited = std::move(awaited);
  update.library = std::move(library);
  update.why = std::move(why);
  world_.updates.prototypes.push_back(std::move(update));
}

// Resolves EXTERNPROTOs, except those if fields of their instances are still being read.
void SceneHandler::resolve_types() {
  std::unordered_set<const vrml::NodeType*> open_types;
  if (parser_)
    for (const vrml::NodeId id : parser_->open_nodes()) open_types.insert(scene->node(id).type);
  std::erase_if(to_resolve_, [&](const auto& one) {
    if (open_types.contains(one.first)) return false;
    if (!vrml::resolve_external(*scene, *one.first, *one.second))
      report(Severity::error, {}, "EXTERNPROTO instances exceed the limit of nodes; the rest stay empty");
    world_.changed = true;
    return true;
  });
}

// Marks the EXTERNPROTOs that the library's PROTOs use. Their instances are in other scenes, but their bodies must be
// loaded here.
void SceneHandler::use_types_inside() {
  std::vector<const vrml::NodeType*> waiting;
  std::unordered_set<const vrml::NodeType*> seen;
  for (const AwaitedPrototype& one : awaiting)
    if (const vrml::NodeType* source = vrml::find_prototype(*scene, one.name)) waiting.push_back(source);
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
