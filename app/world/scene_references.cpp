#include "app/world/outline_handler.h"
#include "app/world/scene_handler.h"
#include "app/world/shared_image.h"
#include "net/base/schemes.h"
#include "vrml/scene/prototype.h"

#include <algorithm>
#include <utility>

// References of the nodes of a scene.
namespace gs::app {
namespace {

using vrml::NodeId;

}  // namespace

std::string fetch_key(const std::vector<net::Url>& places, const net::Origin& from) {
  std::string key = from.site() + "\n";
  for (const net::Url& url : places) key += url.text() + "\n";
  return key;
}

/// Vectors that several QNV nodes show.
struct WorldLoading::State::SharedCloud {
  std::shared_ptr<const qnv::Geometry> cloud;
  std::vector<std::pair<std::shared_ptr<SceneHandler>, NodeId>> nodes;
};

SceneHandler::Reference SceneHandler::refer(const vrml::MFString& list,
                                            const std::shared_ptr<const vrml::TextSource>& source,
                                            bool own_file_first) const {
  Reference reference{
      {}, origin_of(source), list.empty() ? std::string() : std::string(list.front().view().substr(0, 200))};
  std::vector<net::Url> bases;
  // A text from the network must not get base URLs of files.
  const net::Origin& own = found_.origin;
  if (!own.is_user() && (!own.is_file() || reference.from.is_file())) bases.push_back(net::parse_url(own.url));
  if (reference.from != own || bases.empty())
    bases.insert(own_file_first ? bases.begin() : bases.end(), net::parse_url(reference.from.url));
  std::unordered_set<std::string> seen;
  for (const vrml::SFString& url : list) {
    const std::string tidy = net::tidy_url(url.view());
    if (tidy.empty()) continue;  // no reference
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

// Returns the candidates for a path such as "/pictures/a.png", which was meant for the root of a server. For files,
// each parent folder that the text may read could be that root.
std::vector<net::Url> SceneHandler::below_folders(const net::Url& base, const net::Url& rooted,
                                                  const net::Origin& from) const {
  constexpr int kMaxFolders = 32;
  std::vector<net::Url> places;
  net::Url folder = base;
  for (int i = 0; i < kMaxFolders && folder.path.size() > 1; ++i) {
    folder.path.resize(std::max<std::size_t>(1, folder.path.rfind('/', folder.path.size() - 2) + 1));
    net::Url candidate = net::resolve(folder, net::parse_url("." + rooted.path));
    if (!world_.policy.refuse(from, candidate)) places.push_back(std::move(candidate));
  }
  return places;
}

SceneHandler::Reference SceneHandler::refer(NodeId id) const {
  const int slot = scene->node(id).type->find_field("url")->slot;
  return refer(scene->get<vrml::MFString>(id, "url"), scene->text_of(id, slot));
}

void SceneHandler::ask_for(Reference reference, const vrml::Node* node, std::shared_ptr<ContentHandler> handler,
                           Urgency urgency) {
  auto fetch = std::make_unique<Fetch>();
  fetch->candidates = std::move(reference.places);
  fetch->from = std::move(reference.from);
  fetch->reference = std::move(reference.first);
  fetch->node = node;
  fetch->handler = std::move(handler);
  world_.fetch(std::move(fetch), urgency);
}

void SceneHandler::look_for_references() {
  if (!scene || refused() || !world_.options.references) return;
  if (parser_) {
    open_.clear();
    for (const NodeId id : parser_->open_nodes()) open_.insert(id.index);
  } else {
    open_.clear();
  }
  for (const NodeId id : std::exchange(later_, {})) visit(id);
  // Visiting may create nodes, those of PROTO instances.
  while (looked_at_ < scene->node_count()) visit(scene->id_at(++looked_at_));
  if (role == Role::library && nothing_more_comes()) use_types_inside();
  look_for_prototypes();
}

void SceneHandler::visit(NodeId id) {
  const vrml::Node& node = scene->node(id);
  if (node.in_prototype_body) return;
  if (open_.contains(id.index)) {
    later_.push_back(id);
    return;
  }
  if (node.type->prototype || node.type->kind == vrml::NodeType::Kind::external_prototype) {
    used_types_.insert(node.type);
    // The PROTO has the name of a node of ours.
    const vrml::NodeType* native = vrml::built_in_node_type(node.type->name);
    if (native && native->url_content == vrml::UrlContent::vectors) replace_fallback(id, *native);
    return;
  }
  if (vrml::has(node.type->role, vrml::Role::script)) return visit_script(id);
  switch (node.type->url_content) {
    case vrml::UrlContent::none:
      return;
    case vrml::UrlContent::scene:
      return visit_inline(id);
    case vrml::UrlContent::image:
      return visit_image(id);
    case vrml::UrlContent::vectors:
      return visit_cloud(id);
    case vrml::UrlContent::outlines:
      return visit_outlines(id);
    case vrml::UrlContent::sound:
    case vrml::UrlContent::movie:
      return visit_media(id);
  }
}

void SceneHandler::visit_inline(NodeId id) {
  const auto& list = scene->get<vrml::MFString>(id, "url");
  if (scene->inlined(id) || list.empty()) return;
  Reference reference = refer(id);
  if (reference.places.empty()) return;
  auto inner = std::make_shared<SceneHandler>(world_, Role::inlined, this);
  inner->what = "Inline";
  inner->urls = list;
  inner->inline_node = id;
  inner->place_file = scene->node(id).text->file_name();
  inner->place = scene->node(id).location;
  inner_.push_back(inner);
  ask_for(std::move(reference), &scene->node(id), std::move(inner), Urgency::inline_scene);
}

void SceneHandler::visit_image(NodeId id) {
  const vrml::Node& node = scene->node(id);
  const auto fields = node.type->url_fields();
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const int slot = fields[i]->slot;
    const auto* list = std::get_if<vrml::MFString>(&node.values[slot]);
    if (!list || list->empty()) continue;
    Reference reference = refer(*list, scene->text_of(id, slot));
    if (reference.places.empty()) continue;
    auto& shared = world_.shared_images[fetch_key(reference.places, reference.from)];
    const bool fresh = !shared || shared->is_spent();
    if (fresh)
      shared = std::make_shared<WorldLoading::State::SharedImage>(world_, node.type->name, node.text->file_name(),
                                                                  node.location, *list);
    shared->add({scene, id, i});
    if (fresh) ask_for(std::move(reference), &node, shared, Urgency::texture);
  }
}

// Reads the vectors of a QNV node from its own records, else from the first available url. The node's transfer function
// overrides that of the stream.
void SceneHandler::visit_cloud(NodeId id) {
  const vrml::Node& node = scene->node(id);
  if (world_.world.clouds.contains(&node)) return;
  if (!scene->get<vrml::MFInt32>(id, "vectors").empty()) {
    auto made = inline_vectors(*scene, id);
    if (const auto* problem = std::get_if<std::string>(&made))
      report_at(node, "QNV: " + *problem);
    else if (auto held = hold_geometry(std::move(std::get<qnv::Geometry>(made)), world_.budget))
      world_.taken ? world_.cloud_arrived({{scene, id}, {}, std::move(held)})
                   : void(world_.world.clouds[&node] = std::move(held));
    else
      report_at(node, "QNV: " + world_.budget->refusal(Resource::vectors) + "; left out");
    return;
  }
  const auto& list = scene->get<vrml::MFString>(id, "url");
  if (list.empty()) return;
  Reference reference = refer(id);
  if (reference.places.empty()) return;
  auto& shared = world_.shared_clouds[fetch_key(reference.places, reference.from)];
  if (shared) {
    shared->nodes.emplace_back(shared_from_this(), id);
    if (shared->cloud) set_cloud(id, shared->cloud);
    return;
  }
  shared = std::make_shared<WorldLoading::State::SharedCloud>();
  shared->nodes.emplace_back(shared_from_this(), id);
  auto handler = std::make_shared<CloudHandler>(
      world_, CloudHandler::Place{node.text->file_name(), node.location, list, true},
      [shared = shared](const std::shared_ptr<const qnv::Geometry>& cloud) {
        shared->cloud = cloud;
        for (const auto& [scene_handler, of] : shared->nodes) scene_handler->set_cloud(of, cloud);
      },
      [&world = world_, shared = shared](double fraction) {
        for (const auto& [scene_handler, of] : shared->nodes) world.note_progress({scene_handler->scene, of, fraction});
      });
  ask_for(std::move(reference), &node, std::move(handler), Urgency::vectors);
}

void SceneHandler::visit_outlines(NodeId id) {
  const vrml::Node& node = scene->node(id);
  const auto& list = scene->get<vrml::MFString>(id, "url");
  if (list.empty()) return;
  ask_for(refer(id), &node,
          std::make_shared<OutlineHandler>(world_, Arrivals::Place{scene, id}, node.text->file_name(), node.location,
                                           list, &node),
          Urgency::vectors);
}

void SceneHandler::set_cloud(NodeId id, const std::shared_ptr<const qnv::Geometry>& cloud) {
  const auto fallback = fallbacks_.find(id.index);
  world_.cloud_arrived({{scene, id}, fallback == fallbacks_.end() ? NodeId{} : fallback->second, cloud});
}

SceneHandler* SceneHandler::handler_of(const vrml::SceneGraph* wanted) {
  std::vector<SceneHandler*> waiting{this};
  while (!waiting.empty()) {
    SceneHandler* const one = waiting.back();
    waiting.pop_back();
    if (one->scene == wanted) return one;
    for (const auto& inner : one->inner_) waiting.push_back(inner.get());
  }
  return nullptr;
}

bool SceneHandler::is_inside(const SceneHandler& top) const {
  const SceneHandler* one = this;
  while (one && one != &top) one = one->outer;
  return one != nullptr;
}

// Replaces an instance of a PROTO with the name of a node of ours. The PROTO body is the fallback for other browsers;
// the vectors are shown instead of it.
void SceneHandler::replace_fallback(NodeId id, const vrml::NodeType& native) {
  const NodeId made = scene->create(native, scene->node(id).location);
  if (!made) return;
  const vrml::Node& instance = scene->node(id);
  vrml::Node& node = scene->node(made);
  for (const vrml::InterfaceDeclaration& declaration : native.interfaces) {
    const vrml::InterfaceDeclaration* own = instance.type->find_field(declaration.name);
    if (declaration.slot < 0 || !own || own->type != declaration.type) continue;
    node.values[declaration.slot] = instance.values[own->slot];
    scene->set_text(made, declaration.slot, vrml::text_of_field(*scene, id, *own));
  }
  fallbacks_[made.index] = id;  // the new node is visited like any other
}

}  // namespace gs::app
