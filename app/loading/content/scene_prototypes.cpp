#include "app/loading/content/scene_prototypes.h"

#include "app/loading/content/scene_handler.h"
#include "vrml/scene/prototype.h"
#include "vrml/syntax/stand_ins.h"

#include <algorithm>
#include <optional>
#include <utility>

// Search for the PROTOs that the EXTERNPROTOs of a scene refer to.
namespace gs::app {
namespace {

// Returns true if `url` refers to `file` or to a part of it.
bool names_file(net::Url url, const std::string& file) {
  url.fragment.clear();
  url.has_fragment = false;
  return url.text() == file;
}

}  // namespace

vrml::SceneGraph& ScenePrototypes::scene() const { return *handler_.target().scene(); }

bool ScenePrototypes::is_given() const { return handler_.target().read_scene().is_given(); }

ReportAt ScenePrototypes::reporter() const {
  return [this](Severity severity, SourceLocation at, std::string message) {
    handler_.target().report(severity, at, std::move(message));
  };
}

void ScenePrototypes::look() {
  if (handler_.use().role == SceneHandler::Role::library && handler_.nothing_more_comes()) use_types_inside();
  Libraries fresh;
  for (const auto& type : scene().types()) {
    if (type->kind != vrml::NodeType::Kind::external_prototype || type->prototype ||
        !used_types_.contains(type.get()) || !asked_types_.insert(type.get()).second)
      continue;
    AwaitedPrototype wanted{type.get(), {}, 0, {}};
    UrlRequest request;
    request.type = type->name;
    request.file = scene().file_name();
    request.urls = type->url;
    if (!ask_for(wanted, handler_.references().refer(type->url, scene()), std::move(request), fresh))
      own_types_.emplace_back(type.get(), *wanted.own_name);
  }
  take_own();
}

// Fetches the library of an EXTERNPROTO. If its first url refers to its own file, fetches nothing and returns false.
// `wanted` then has the name of the PROTO in that file.
bool ScenePrototypes::ask_for(AwaitedPrototype& wanted, SceneReferences::Reference reference, UrlRequest request,
                              Libraries& fresh) {
  // A url of this file itself is not fetched. If it is the first url, it is used at once, else only after the others
  // failed.
  const std::string& own_url = handler_.target().found().origin.url;
  const bool own_first = !reference.places.empty() && names_file(reference.places.front(), own_url);
  std::erase_if(reference.places, [&](const net::Url& url) {
    if (!names_file(url, own_url)) return false;
    if (!wanted.own_name) wanted.own_name = url.fragment;
    return true;
  });
  if (own_first || (wanted.own_name && reference.places.empty())) return false;
  std::vector<net::Url> files = reference.places;
  for (net::Url& url : files) url.fragment.clear(), url.has_fragment = false;
  for (std::size_t i = 0; i < files.size(); ++i)
    wanted.references.push_back({files[i].text(), reference.places[i].fragment});
  SceneHandler*& known = fresh[fetch_key(files, reference.from)];
  if (known) {
    known->prototypes().awaiting_.push_back(wanted);
    return true;
  }
  request.type = "EXTERNPROTO " + request.type;
  auto library =
      std::make_shared<SceneHandler>(context_, SceneUse{SceneUse::Role::library, &handler_, std::move(request)});
  known = library.get();
  library->prototypes().awaiting_ = {wanted};
  libraries_.push_back(library);
  ++awaited_libraries_;
  handler_.references().ask_for(std::move(reference), nullptr, std::move(library), Urgency::prototypes);
  return true;
}

// Requests the library of an EXTERNPROTO. Its text was read into the running world, which therefore owns the type.
void ScenePrototypes::load(const UrlRequest& request) {
  Libraries fresh;
  AwaitedPrototype wanted{request.prototype, {}, 0, {}};
  if (!ask_for(wanted, handler_.references().refer(request.urls, request.source, request.fetched), request, fresh))
    give({wanted}, nullptr, std::nullopt);
}

// Resolves EXTERNPROTOs that refer to a PROTO of their own file (VRML97 4.9.2), after that PROTO is complete.
void ScenePrototypes::take_own() {
  const std::size_t before = to_resolve_.size(), waiting = own_types_.size();
  std::erase_if(own_types_, [&](const auto& one) {
    const auto& [type, name] = one;
    if (!vrml::find_own_prototype(scene(), name) && !handler_.nothing_more_comes()) return false;
    const vrml::NodeType* source = prototype_in_own_text(scene(), *type, name, reporter());
    if (!source) {
      stand_in(*type);
    } else if (vrml::stands_inside(*type, *source)) {
      handler_.target().report(Severity::error, type->location,
                               "EXTERNPROTO " + type->name + " is inside its own PROTO " + source->name + "; left out");
    } else {
      to_resolve_.emplace_back(type, source);
      resolve();  // the body may contain the next EXTERNPROTO
    }
    return true;
  });
  if (to_resolve_.size() != before) resolve();
  if (own_types_.size() != waiting) handler_.references().look();  // handles the nodes of the new bodies
}

bool ScenePrototypes::stand_in(vrml::NodeType& type) {
  const vrml::NodeType* source = vrml::stand_in_for(scene(), type);
  if (source) to_resolve_.emplace_back(&type, source);
  return source != nullptr;
}

// Handles a missing library. `why` is the reason, or nullopt if the diagnostics already have it.
void ScenePrototypes::miss(SceneHandler& library, const std::optional<std::string>& why) {
  if (is_given()) return give(library.prototypes().awaiting_, nullptr, why);
  for (const AwaitedPrototype& one : library.prototypes().awaiting_) {
    if (one.own_name) {
      own_types_.emplace_back(one.type, *one.own_name);
      continue;
    }
    const bool replaced = stand_in(*one.type);
    if (why) tell_missing_prototype(*one.type, *why, replaced, reporter());
  }
}

void ScenePrototypes::take_library(SceneHandler& library) {
  --awaited_libraries_;
  const bool usable = library.target().scene() && !library.target().refused();
  std::vector<AwaitedPrototype>& awaiting = library.prototypes().awaiting_;
  for (AwaitedPrototype& one : awaiting) one.loaded = library.target().found().candidate;
  if (is_given()) {
    if (usable) give(awaiting, give_library(library, context_), std::nullopt);
    return;
  }
  if (usable) {
    const vrml::SceneGraph& attached = library.target().read_scene().attach_library(scene());
    for (const AwaitedPrototype& one : awaiting) {
      if (const vrml::NodeType* source = prototype_in_library(attached, one, reporter()))
        to_resolve_.emplace_back(one.type, source);
      else
        (void)stand_in(*one.type);
    }
  }
  resolve();
  handler_.references().look();
  handler_.settle();
}

// Hands prototypes to the running world, which owns the EXTERNPROTOs.
void ScenePrototypes::give(std::vector<AwaitedPrototype> awaited, std::unique_ptr<vrml::SceneGraph> library,
                           std::optional<std::string> why) {
  ResourceUpdates::Prototypes update;
  update.scene = &scene();
  update.scene_held = handler_.target().read_scene().given_content();
  if (handler_.use().role != SceneHandler::Role::root && !update.scene_held) return;  // the Inline no longer exists
  update.awaited = std::move(awaited);
  update.library = std::move(library);
  update.why = std::move(why);
  context_.loading.results.add(std::move(update));
}

// Resolves EXTERNPROTOs. Skips a type while the fields of one of its instances are still being read.
void ScenePrototypes::resolve() {
  std::unordered_set<const vrml::NodeType*> open_types;
  for (const vrml::NodeId id : handler_.open_nodes()) open_types.insert(scene().node(id).type);
  std::erase_if(to_resolve_, [&](const auto& one) {
    if (open_types.contains(one.first)) return false;
    if (!vrml::resolve_external(scene(), *one.first, *one.second))
      handler_.target().report(Severity::error, {},
                               "EXTERNPROTO instances exceed the limit of nodes; the rest stay empty");
    context_.loading.results.set_changed(true);
    return true;
  });
}

// Marks the EXTERNPROTOs inside the library's PROTOs as used. Their instances are in other scenes, but only this
// handler can load their bodies.
void ScenePrototypes::use_types_inside() {
  std::vector<const vrml::NodeType*> waiting;
  std::unordered_set<const vrml::NodeType*> seen;
  for (AwaitedPrototype& one : awaiting_) {
    one.loaded = handler_.target().found().candidate;
    if (const vrml::NodeType* source = find_awaited(scene(), one)) waiting.push_back(source);
  }
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
