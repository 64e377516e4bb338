#include "app/loading/content/scene_references.h"

#include "app/base/text_source.h"
#include "app/formats/qnv/geometry_reader.h"
#include "app/loading/content/outline_handler.h"
#include "app/loading/content/scene_handler.h"
#include "app/loading/resources/geometry_handler.h"
#include "app/loading/resources/image_handler.h"
#include "app/loading/resources/media_handler.h"
#include "app/loading/resources/text_handler.h"
#include "app/script/script_runner.h"
#include "net/base/schemes.h"
#include "vrml/scene/coordinates/geo_tiles.h"
#include "vrml/scene/prototype.h"

#include <algorithm>
#include <utility>

// Resources that the nodes of a scene refer to.
namespace gs::app {
namespace {

using vrml::NodeId;

}  // namespace

std::string fetch_key(const std::vector<net::Url>& places, const net::Origin& from) {
  std::string key = from.site() + "\n";
  for (const net::Url& url : places) key += url.text() + "\n";
  return key;
}

/// Vectors that several QNV nodes show. They are fetched only once.
struct SharedGeometry {
  std::shared_ptr<const qnv::Geometry> geometry;
  std::vector<std::pair<std::shared_ptr<SceneHandler>, NodeId>> nodes;
};

vrml::SceneGraph& SceneReferences::scene() const { return *handler_.target().scene(); }

SceneReferences::Reference SceneReferences::refer(const vrml::MFString& list,
                                                  const std::shared_ptr<const vrml::TextSource>& source,
                                                  bool own_file_first) const {
  Reference reference{
      {}, origin_of(source), list.empty() ? std::string() : std::string(list.front().view().substr(0, 200))};
  std::vector<net::Url> bases;
  // A text from the network must not resolve relative URLs to local files.
  const net::Origin& own = handler_.target().found().origin;
  if (!own.is_user() && (!own.is_file() || reference.from.is_file())) bases.push_back(net::parse_url(own.url));
  if (reference.from != own || bases.empty())
    bases.insert(own_file_first ? bases.begin() : bases.end(), net::parse_url(reference.from.url));
  std::unordered_set<std::string> seen;
  for (const vrml::SFString& url : list) {
    const std::string tidy = net::tidy_url(url.view());
    if (tidy.empty()) continue;  // an empty url refers to nothing
    const net::Url parsed = net::parse_url(tidy);
    const auto add = [&](net::Url candidate) {
      if (seen.insert(candidate.text()).second) reference.places.push_back(std::move(candidate));
    };
    for (const net::Url& base : bases) {
      const bool rooted = parsed.scheme.empty() && parsed.authority.empty() && parsed.path.starts_with('/');
      if (rooted && base.scheme == "file")
        for (net::Url& candidate : below_folders(base, parsed, reference.from)) add(std::move(candidate));
      add(net::resolve(base, parsed));
    }
  }
  return reference;
}

// Returns the candidates for a path from the root of a server, such as "/pictures/a.png". In a local file, any parent
// folder could stand for that root. Returns one candidate for each parent folder that the text may read.
std::vector<net::Url> SceneReferences::below_folders(const net::Url& base, const net::Url& rooted,
                                                     const net::Origin& from) const {
  constexpr int kMaxFolders = 32;
  std::vector<net::Url> places;
  net::Url folder = base;
  for (int i = 0; i < kMaxFolders && folder.path.size() > 1; ++i) {
    folder.path.resize(std::max<std::size_t>(1, folder.path.rfind('/', folder.path.size() - 2) + 1));
    net::Url candidate = net::resolve(folder, net::parse_url("." + rooted.path));
    if (!context_.loading.fetcher.policy().refuse(from, candidate)) places.push_back(std::move(candidate));
  }
  return places;
}

SceneReferences::Reference SceneReferences::refer(NodeId id) const {
  const int slot = scene().node(id).type->find_field("url")->slot;
  return refer(scene().get<vrml::MFString>(id, "url"), scene().nodes().text_of(id, slot));
}

void SceneReferences::ask_for(Reference reference, const vrml::Node* node, std::shared_ptr<ContentHandler> handler,
                              Urgency urgency) {
  auto fetch = std::make_unique<Fetch>();
  fetch->candidates = std::move(reference.places);
  fetch->from = std::move(reference.from);
  fetch->reference = std::move(reference.first);
  fetch->refresh = reference.refresh;
  fetch->node = node;
  fetch->handler = std::move(handler);
  context_.loading.fetcher.fetch(std::move(fetch), urgency);
}

void SceneReferences::look() {
  const SceneTarget& target = handler_.target();
  if (!target.scene() || target.refused() || !context_.loading.options.references) return;
  open_.clear();
  for (const NodeId id : handler_.open_nodes()) open_.insert(id.index);
  for (const NodeId id : std::exchange(later_, {})) visit(id);
  // Visiting a node may append nodes: those of PROTO instances.
  while (looked_at_ < scene().nodes().count()) visit(scene().nodes().id_at(++looked_at_));
  handler_.prototypes().look();
}

void SceneReferences::visit(NodeId id) {
  const vrml::Node& node = scene().node(id);
  if (node.in_prototype_body) return;
  if (open_.contains(id.index)) {
    later_.push_back(id);
    return;
  }
  if (node.type->prototype || node.type->kind == vrml::NodeType::Kind::external_prototype) {
    handler_.prototypes().use(*node.type);
    // The PROTO may have the name of a built-in QNV node.
    const vrml::NodeType* native = vrml::built_in_node_type(node.type->name);
    if (native && native->url_content == vrml::UrlContent::vectors) replace_fallback(id, *native);
    return;
  }
  if (vrml::has(node.type->role, vrml::Role::script)) return visit_script(id);
  if (!vrml::may_load(node)) return;
  switch (node.type->url_content) {
    case vrml::UrlContent::none:
      // The caller visits the new Inline too.
      if (node.type->read_as == vrml::NodeKind::geo_lod) (void)vrml::make_root_tile(scene(), id);
      return;
    case vrml::UrlContent::scene:
      return visit_inline(id);
    case vrml::UrlContent::image:
      return visit_images(id);
    case vrml::UrlContent::vectors:
      return visit_geometry(id);
    case vrml::UrlContent::outlines:
      return visit_outlines(id);
    case vrml::UrlContent::sound:
    case vrml::UrlContent::movie:
      if (const auto& list = scene().get<vrml::MFString>(id, "url"); !list.empty())
        ask_for_media(request_of(id, list), refer(id));
      return;
  }
}

// Returns a request for urls of a node, as if they were set.
UrlRequest SceneReferences::request_of(NodeId id, vrml::MFString urls) const {
  const vrml::Node& node = scene().node(id);
  UrlRequest request;
  request.place = {&scene(), id};
  request.node = &node;
  request.content = node.type->url_content;
  request.urls = std::move(urls);
  request.type = node.type->name;
  request.file = node.text->file_name();
  request.location = node.location;
  request.in_x3d = node.text->language() == vrml::Language::x3d;
  return request;
}

void SceneReferences::visit_inline(NodeId id) {
  const auto& list = scene().get<vrml::MFString>(id, "url");
  if (scene().inlines().of(id) || list.empty()) return;
  Reference reference = refer(id);
  if (!reference.places.empty()) ask_for_inline(request_of(id, list), std::move(reference), false);
}

void SceneReferences::ask_for_inline(const UrlRequest& request, Reference reference, bool withheld) {
  inlines_.push_back(
      std::make_shared<SceneHandler>(context_, SceneUse{SceneUse::Role::inlined, &handler_, request, withheld}));
  if (withheld) context_.withheld.push_back(inlines_.back());
  ask_for(std::move(reference), request.node, inlines_.back(), Urgency::inline_scene);
}

void SceneReferences::visit_images(NodeId id) {
  const vrml::Node& node = scene().node(id);
  const auto fields = node.type->url_fields();
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const int slot = fields[i]->slot;
    const auto* list = std::get_if<vrml::MFString>(&node.values[slot]);
    if (!list || list->empty()) continue;
    Reference reference = refer(*list, scene().nodes().text_of(id, slot));
    if (reference.places.empty()) continue;
    UrlRequest request = request_of(id, *list);
    request.place.url = i;
    ask_for_image(request, std::move(reference), false);
  }
}

// Fetches an image unless another texture has it. With `again`, fetches a missing image again.
void SceneReferences::ask_for_image(const UrlRequest& request, Reference reference, bool again) {
  auto& shared = context_.images[fetch_key(reference.places, reference.from)];
  const bool fresh = !shared || shared->is_spent() || (again && shared->has_none()) || request.refresh;
  if (fresh) shared = std::make_shared<ImageHandler>(context_.loading, request);
  shared->add(request.place);
  if (fresh) ask_for(std::move(reference), request.node, shared, Urgency::texture);
}

// Reads the vectors of a QNV node from its own records, else from the first url that works. The node's transfer
// function overrides the stream's.
void SceneReferences::visit_geometry(NodeId id) {
  const vrml::Node& node = scene().node(id);
  LoadResults& results = context_.loading.results;
  const WorldBudget& budget = context_.loading.budget;
  if (const LoadedWorld* world = results.world(); world && world->geometries.contains(&node)) return;
  if (!scene().get<vrml::MFInt32>(id, "vectors").empty()) {
    const auto warn = [&](const std::string& why) {
      results.report(Severity::warning, node.text->file_name(), node.location, "QNV: " + why);
    };
    auto made = inline_vectors(scene(), id);
    if (const auto* problem = std::get_if<std::string>(&made))
      warn(*problem);
    else if (auto held = hold_geometry(std::move(std::get<qnv::Geometry>(made)), budget))
      results.add_own({&scene(), id}, std::move(held));
    else
      warn(budget->refusal(Resource::vectors) + "; left out");
    return;
  }
  const auto& list = scene().get<vrml::MFString>(id, "url");
  if (list.empty()) return;
  Reference reference = refer(id);
  if (reference.places.empty()) return;
  auto& shared = context_.geometries[fetch_key(reference.places, reference.from)];
  if (shared) {
    shared->nodes.emplace_back(handler_.shared_from_this(), id);
    if (shared->geometry) set_geometry(id, shared->geometry);
    return;
  }
  shared = std::make_shared<SharedGeometry>();
  shared->nodes.emplace_back(handler_.shared_from_this(), id);
  auto handler = std::make_shared<GeometryHandler>(
      context_.loading, request_of(id, list),
      [shared = shared](const std::shared_ptr<const qnv::Geometry>& geometry) {
        shared->geometry = geometry;
        for (const auto& [user, of] : shared->nodes) user->references().set_geometry(of, geometry);
      },
      [&results, shared = shared](double fraction) {
        for (const auto& [user, of] : shared->nodes) results.add(UrlProgress{user->target().scene(), of, fraction});
      });
  ask_for(std::move(reference), &node, std::move(handler), Urgency::vectors);
}

void SceneReferences::visit_outlines(NodeId id) {
  const vrml::Node& node = scene().node(id);
  const auto& list = scene().get<vrml::MFString>(id, "url");
  if (list.empty()) return;
  ask_for(refer(id), &node, std::make_shared<OutlineHandler>(context_, request_of(id, list), &node), Urgency::vectors);
}

void SceneReferences::set_geometry(NodeId id, const std::shared_ptr<const qnv::Geometry>& geometry) {
  const auto fallback = fallbacks_.find(id.index);
  context_.loading.results.add(
      ResourceUpdates::Geometry{{&scene(), id}, fallback == fallbacks_.end() ? NodeId{} : fallback->second, geometry});
}

// Replaces an instance of a PROTO with a built-in node of the same name, which shows vectors. The PROTO body is a
// fallback for other browsers.
void SceneReferences::replace_fallback(NodeId id, const vrml::NodeType& native) {
  const NodeId made = scene().create(native, scene().node(id).location);
  if (!made) return;
  const vrml::Node& instance = scene().node(id);
  vrml::Node& node = scene().node(made);
  for (const vrml::InterfaceDeclaration& declaration : native.interfaces) {
    const vrml::InterfaceDeclaration* own = instance.type->find_field(declaration.name);
    if (declaration.slot < 0 || !own || own->type != declaration.type) continue;
    node.values[declaration.slot] = instance.values[own->slot];
    scene().nodes().set_text(made, declaration.slot, vrml::text_of_field(scene(), id, *own));
  }
  fallbacks_[made.index] = id;  // the loop of the caller visits the new node too
}

// Fetches the files that precede the first inline program in the url list.
void SceneReferences::visit_script(NodeId id) {
  const vrml::Node& node = scene().node(id);
  const vrml::InterfaceDeclaration* const url = node.type->find_field("url");
  const auto* const list = url ? std::get_if<vrml::MFString>(&node.values[url->slot]) : nullptr;
  if (!list) return;
  UrlRequest request = request_of(id, {});
  request.as_text = true;
  for (const vrml::SFString& one : *list) {
    const ProgramPlace::Kind kind = program_place(one.view()).kind;
    if (kind == ProgramPlace::Kind::held) break;
    if (kind == ProgramPlace::Kind::file) request.urls.push_back(one);
  }
  Reference reference = refer(request.urls, scene().nodes().text_of(id, url->slot));
  if (reference.places.empty()) return;
  ask_for(std::move(reference), &node, std::make_shared<TextHandler>(context_.loading, &handler_, request),
          Urgency::prototypes);
}

void SceneReferences::load(const UrlRequest& request) {
  if (request.prototype) return handler_.prototypes().load(request);
  LoadResults& results = context_.loading.results;
  Reference reference = refer(request.urls, request.source, request.fetched);
  reference.refresh = request.refresh;
  const ResourceUpdates::Place& at = request.place;
  if (request.as_text) {
    if (reference.places.empty()) return results.add(ResourceUpdates::Text{at, std::nullopt, {}, {}});
    return ask_for(std::move(reference), request.node,
                   std::make_shared<TextHandler>(context_.loading, nullptr, request), Urgency::inline_scene);
  }
  switch (request.content) {
    case vrml::UrlContent::scene:
      return load_inline(request, std::move(reference));
    case vrml::UrlContent::image:
      if (reference.places.empty()) return results.add(ResourceUpdates::Image{{at}, nullptr});
      std::erase_if(context_.images, [](const auto& one) { return one.second->is_spent(); });
      return ask_for_image(request, std::move(reference), true);
    case vrml::UrlContent::vectors: {
      if (reference.places.empty()) return results.add(ResourceUpdates::Geometry{at, {}, nullptr});
      auto handler = std::make_shared<GeometryHandler>(
          context_.loading, request,
          [&results, at](const std::shared_ptr<const qnv::Geometry>& geometry) {
            results.add(ResourceUpdates::Geometry{at, {}, geometry});
          },
          [&results, at](double fraction) {
            results.add(UrlProgress{at.scene, at.node, fraction});
          });
      return ask_for(std::move(reference), request.node, std::move(handler), Urgency::vectors);
    }
    case vrml::UrlContent::outlines: {
      auto handler = std::make_shared<OutlineHandler>(context_, request, nullptr);
      if (reference.places.empty()) return handler->give();
      return ask_for(std::move(reference), request.node, std::move(handler), Urgency::vectors);
    }
    case vrml::UrlContent::sound:
    case vrml::UrlContent::movie:
      return ask_for_media(request, std::move(reference));
    case vrml::UrlContent::none:
      return;
  }
}

void SceneReferences::load_inline(const UrlRequest& request, Reference reference) {
  // Cancels the fetches of the former content and of its references.
  std::erase_if(inlines_, [&](const std::shared_ptr<SceneHandler>& former) {
    if (former->use().request.place.node != request.place.node) return false;
    context_.loading.fetcher.withdraw([&](const ContentHandler& handler) {
      const SceneHandler* of = handler.makes_nodes_of();
      return of && of->is_inside(*former);
    });
    std::erase_if(context_.withheld, [&](const auto& one) { return one->is_inside(*former); });
    return true;
  });
  if (reference.places.empty())
    context_.loading.results.add(ResourceUpdates::Content{request.place, nullptr, {}});
  else
    ask_for_inline(request, std::move(reference), true);
}

void SceneReferences::ask_for_media(const UrlRequest& request, Reference reference) {
  if (reference.places.empty())
    return context_.loading.results.add(ResourceUpdates::Media{{request.place}, nullptr, nullptr});
  std::erase_if(context_.media, [](const auto& one) { return one.second->is_spent(); });
  const std::string key =
      fetch_key(reference.places, reference.from) + (request.content == vrml::UrlContent::movie ? "movie" : "sound");
  auto& shared = context_.media[key];
  const bool fresh = !shared;
  if (fresh) shared = std::make_shared<MediaHandler>(context_.loading, request);
  shared->add(request.place);
  if (fresh) ask_for(std::move(reference), request.node, shared, Urgency::texture);
}

}  // namespace gs::app
