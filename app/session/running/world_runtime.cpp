#include "app/session/running/world_runtime.h"

#include "app/base/world_work.h"
#include "app/formats/qnv/geometry_reader.h"
#include "app/media/media_file.h"
#include "render/scene/late_meshes.h"
#include "vrml/behaviours/browser_events.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace gs::app {
namespace {

// Number of batches of changes that are kept. A render list that is behind by more batches is collected from scratch.
constexpr std::size_t kMaxBatches = 8;

}  // namespace

double world_time() {
  using Steady = std::chrono::steady_clock;
  static const Steady::time_point begin = Steady::now();
  static const double at_begin =
      std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  return at_begin + std::chrono::duration<double>(Steady::now() - begin).count();
}

/// Work that the user can stop. Then the events of the world end.
class WorldRuntime::Work : NonCopyable {
 public:
  explicit Work(WorldRuntime& runtime) : runtime_(runtime) {}
  ~Work() {
    if (work_.was_stopped()) runtime_.execution_.budget().halt();
    runtime_.note_halt();
  }

 private:
  WorldRuntime& runtime_;
  WorldWork work_;
};

void WorldRuntime::note_halt() {
  if (!execution_.budget().is_halted() || std::exchange(told_halt_, true)) return;
  programs_.tell(
      {{Severity::error, world_.path, {}, "the events of this world took long and were stopped by the user"}, false});
}

WorldRuntime::WorldRuntime(LoadedWorld& world, render::MeshCache& meshes)
    : world_(world), meshes_(meshes), execution_(*world.scene) {
  execution_.lifetime().observe_removal([this](vrml::SceneGraph& scene, vrml::NodeId node) { forget(scene, node); });
  execution_.routes().imports().report(world_.diagnostics);
  note_loaded();
}

// Notes the urls that were loaded before the world began.
void WorldRuntime::note_loaded() {
  using vrml::UrlLoad;
  for (const auto& [place, image] : world_.images)
    if (image) execution_.loads().note(*place.node, UrlLoad::loaded);
  for (const auto& [node, media] : world_.media) execution_.loads().note(*node, UrlLoad::loaded);
  for (const vrml::SceneState& state : execution_.scenes().states())
    for (const auto& [index, content] : state.scene->inlines().all())
      if (content) execution_.loads().note(state.scene->nodes().at(index), UrlLoad::loaded);
}

void WorldRuntime::note_load(const ResourceUpdates::Place& place, bool loaded) {
  if (execution_.scenes().has(place.scene) && place.scene->contains(place.node))
    execution_.loads().note(place.scene->node(place.node), loaded ? vrml::UrlLoad::loaded : vrml::UrlLoad::failed);
}

// Destroys the programs first, because they refer to other members.
WorldRuntime::~WorldRuntime() { programs_.stop(); }

void WorldRuntime::start(double now) {
  const Work work(*this);
  started_ = true;
  programs_.start();
  execution_.start(now);
  for (const vrml::SceneState& state : execution_.scenes().states())
    if (state.scene) refresh_.note_scene(*state.scene);
  progress_ = std::exchange(world_.progress, {});
  durations_ = std::exchange(world_.durations, {});
  for (const MediaDuration& one : durations_) movies_.open(one);
  tell_progress();
  tell_durations();
  (void)take_changes();
}

bool WorldRuntime::step(double now) {
  const Work work(*this);
  if (execution_.budget().is_halted()) return take_changes();
  programs_.begin_step(now);
  execution_.step(now);
  requests_.refresh(refresh_.take_due());
  tell_progress();
  tell_durations();
  return take_changes();
}

std::optional<double> WorldRuntime::next_time() const {
  if (told_halt_) return std::nullopt;
  if (!progress_.empty() || !durations_.empty() || movies_.running()) return execution_.now();
  const std::optional<double> event = execution_.next_time(), refresh = refresh_.next_time();
  return event && refresh ? std::min(*event, *refresh) : event ? event : refresh;
}

bool WorldRuntime::send(const vrml::SceneGraph& scene, vrml::NodeId node, std::string_view event_in,
                        const vrml::FieldValue& value) {
  if (!scene.contains(node)) return false;
  const Work work(*this);
  const vrml::InterfaceDeclaration* event = scene.node(node).type->find_event_in(event_in);
  return event && execution_.send(scene, node, *event, value);
}

// Reports the progress of loading to nodes. A report that is not possible at this timestamp is repeated later.
void WorldRuntime::tell_progress() {
  std::erase_if(progress_, [&](const UrlProgress& one) {
    return !execution_.scenes().has(one.scene) || !one.scene->contains(one.node) ||
           vrml::report_progress(execution_, *one.scene, one.node, one.fraction);
  });
}

void WorldRuntime::tell_durations() {
  std::erase_if(durations_, [&](const MediaDuration& one) {
    return !execution_.scenes().has(one.scene) || !one.scene->contains(one.node) ||
           vrml::report_media(execution_, *one.scene, one.node, one.seconds);
  });
}

void WorldRuntime::show_content(ResourceUpdates::Content&& update) {
  if (requests_.is_stale(update.place)) {
    if (update.content) forget(*update.content, {});
    return;
  }
  vrml::SceneGraph& scene = *update.place.scene;
  note_load(update.place, update.content != nullptr);
  execution_.lifetime().remove_content(scene, update.place.node);
  if (!update.content) return;
  meshes_.take(std::move(update.meshes));
  refresh_.note_scene(*update.content);
  scene.inlines().attach(update.place.node, std::move(update.content));
  execution_.scenes().attach(scene);
  execution_.routes().imports().report(world_.diagnostics);
  programs_.start();
  execution_.changes().mark_content(scene, update.place.node);
}

void WorldRuntime::take_prototypes(ResourceUpdates::Prototypes&& update) {
  if (!execution_.scenes().has(update.scene)) return;
  vrml::SceneGraph& scene = *update.scene;
  if (!app::take_prototypes(scene, update.awaited, std::move(update.library), update.why, world_.diagnostics)) return;
  for (const AwaitedPrototype& one : update.awaited)
    if (vrml::has(one.type->role, render::kGeometryParts)) meshes_.forget_scene(scene);
  execution_.scenes().attach(scene);
  execution_.stacks().bind_new_types();
}

// Sets the polygon lists of outlines without events, because only the browser may write these fields.
void WorldRuntime::take_outlines(ResourceUpdates::Outlines&& update, std::vector<vrml::NodeChange>& changes) {
  vrml::SceneGraph& scene = *update.place.scene;
  const vrml::NodeId node = update.place.node;
  std::vector<std::pair<const vrml::InterfaceDeclaration*, vrml::FieldValue>> told;
  for (const auto& one : update.fields)
    if (one.first->access == vrml::AccessType::exposedField &&
        !(scene.node(node).values[one.first->slot] == one.second))
      told.push_back(one);
  std::erase_if(update.fields, [](const auto& one) { return one.first->access == vrml::AccessType::exposedField; });
  set_outlines(world_, update);
  for (const auto& [field, value] : told) (void)execution_.send(scene, node, *field, value);
  changes.push_back({&scene, node, 0});
  // Also mark the group that this node refines, because both are drawn together.
  for (const vrml::InterfaceDeclaration& field : scene.node(node).type->interfaces)
    if (const auto* other = field.slot < 0 ? nullptr : std::get_if<vrml::SFNode>(&scene.node(node).values[field.slot]))
      if (const vrml::NodeId refined = scene.resolve(*other)) changes.push_back({&scene, refined, 0});
}

void WorldRuntime::arrive(ResourceUpdates&& updates) {
  const Work work(*this);
  for (ResourceUpdates::Content& one : updates.contents) show_content(std::move(one));
  for (ResourceUpdates::Text& one : updates.texts) requests_.take_text(std::move(one));
  for (ResourceUpdates::Prototypes& one : updates.prototypes) take_prototypes(std::move(one));
  const auto gone = [this](const ResourceUpdates::Place& place) { return requests_.is_stale(place); };
  for (ResourceUpdates::Image& one : updates.images) {
    std::erase_if(one.textures, gone);
    for (const ResourceUpdates::Place& texture : one.textures) note_load(texture, one.image != nullptr);
  }
  for (ResourceUpdates::Media& one : updates.media) {
    std::erase_if(one.players, gone);
    for (const ResourceUpdates::Place& player : one.players) note_load(player, one.media != nullptr);
    for (const ResourceUpdates::Place& player : one.players)
      durations_.push_back({player.scene, player.node, one.media ? one.media->info.duration : -1});
  }
  std::erase_if(updates.geometries,
                [&](const ResourceUpdates::Geometry& one) { return requests_.is_stale(one.place); });
  progress_.insert(progress_.end(), updates.progress.begin(), updates.progress.end());
  std::vector<vrml::NodeChange> changes;
  for (ResourceUpdates::Outlines& one : updates.outlines)
    if (!requests_.is_stale(one.place)) take_outlines(std::move(one), changes);
  render::forget_changed(meshes_, changes);
  std::vector<MediaDuration> movies;
  for (const ResourceUpdates::Media& one : updates.media)
    for (const ResourceUpdates::Place& player : one.players) movies.push_back({player.scene, player.node});
  for (const ResourceUpdates::Place& place : take_in(world_, std::move(updates)))
    changes.push_back({place.scene, place.node, 0});
  for (const MediaDuration& one : movies) movies_.open(one);
  if (!changes.empty()) add_changes(std::move(changes));
}

// Removes all data about a removed node; for a null `node`, about all nodes of a scene. Required because their
// addresses may be reused.
void WorldRuntime::forget(vrml::SceneGraph& scene, vrml::NodeId node) {
  rays_.forget();
  const auto forget_one = [&](const vrml::Node& one) {
    for (std::size_t i = 0, count = one.type ? one.type->url_fields().size() : 0; i < count; ++i)
      world_.images.erase({&one, i});
    requests_.forget_node(one);
    execution_.loads().forget(one);
    refresh_.forget(one);
    world_.geometries.erase(&one);
    world_.media.erase(&one);
    movies_.forget(one);
    world_.outlines.erase(&one);
    meshes_.remove(scene, &one);
  };
  if (node) return forget_one(scene.node(node));
  for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i) forget_one(scene.nodes().at(i));
  if (ScriptRunner* const runner = programs_.runner()) runner->forget_scene(scene);
  requests_.forget_scene(scene);
  for (std::vector<vrml::NodeChange>& batch : batches_)
    std::erase_if(batch, [&](const vrml::NodeChange& change) { return change.scene == &scene; });
}

void WorldRuntime::set_mesh_worker(std::shared_ptr<render::MeshWorker> worker) {
  meshes_.late = worker ? std::make_shared<render::LateMeshes>(std::move(worker)) : nullptr;
}

bool WorldRuntime::take_meshes() {
  if (!meshes_.late) return false;
  meshes_.late->begin_frame();
  std::vector<vrml::NodeChange> changes;
  for (const render::LateMeshes::Made& one : meshes_.late->take(meshes_))
    if (vrml::SceneGraph* scene = execution_.scenes().own(*one.scene)) changes.push_back({scene, one.node, 0});
  if (changes.empty()) return false;
  add_changes(std::move(changes));
  return true;
}

void WorldRuntime::add_changes(std::vector<vrml::NodeChange> changes) {
  batches_.push_back(std::move(changes));
  if (batches_.size() > kMaxBatches) batches_.pop_front();
  ++version_;
}

bool WorldRuntime::take_changes() {
  const auto changes = execution_.changes().take();
  requests_.note_changes(changes);
  for (const vrml::NodeChange& change : changes)
    if (change.scene->node(change.node).type->url_content != vrml::UrlContent::none)
      refresh_.note(*change.scene, change.node);
  if (std::exchange(replaced_, execution_.lifetime().replaced()) != execution_.lifetime().replaced()) {
    batches_.clear();
    ++version_;  // without a batch for this version, all lists are collected from scratch
    render::forget_changed(meshes_, changes);
    return true;
  }
  if (changes.empty()) return false;
  render::forget_changed(meshes_, changes);
  add_changes({changes.begin(), changes.end()});
  return true;
}

std::vector<UrlRequest> WorldRuntime::take_url_requests() {
  (void)take_changes();
  return requests_.take_url_requests();
}

std::shared_ptr<RuntimeScene> WorldRuntime::look(const glm::dvec3& viewer, bool own) {
  if (!own)
    if (auto shared = shared_.lock()) return shared;
  const Work work(*this);
  auto scene = std::make_shared<RuntimeScene>(
      RuntimeScene{render::RenderScene(*world_.scene, world_.images, world_.geometries, meshes_), version_});
  scene->scene.gather(bound(), viewer);
  if (!own) shared_ = scene;
  return scene;
}

bool WorldRuntime::show(RuntimeScene& scene, const glm::dvec3& viewer) {
  const Work work(*this);
  (void)take_changes();
  const std::uint64_t behind = version_ - scene.version;
  scene.version = version_;
  if (behind > batches_.size()) {
    scene.scene.gather(bound(), viewer);
    return true;
  }
  if (behind == 0) return scene.scene.update({}, bound(), viewer);
  std::vector<vrml::NodeChange> changes;
  for (auto batch = batches_.end() - static_cast<std::ptrdiff_t>(behind); batch != batches_.end(); ++batch)
    changes.insert(changes.end(), batch->begin(), batch->end());
  return scene.scene.update(changes, bound(), viewer);
}

render::BoundNodes WorldRuntime::bound() const {
  using vrml::NodeKind;
  const auto node_of = [&](NodeKind kind) -> const vrml::Node* {
    const vrml::NodeChange bound = execution_.stacks().bound(vrml::built_in_node_type(kind));
    return bound.scene ? &bound.scene->node(bound.node) : nullptr;
  };
  render::BoundNodes nodes{node_of(NodeKind::viewpoint), node_of(NodeKind::navigation_info),
                           node_of(NodeKind::background), node_of(NodeKind::fog)};
  if (const std::optional<vrml::LayerSet> set = execution_.stacks().layers()) add_layers(*set, nodes);
  return nodes;
}

// Adds the layers of a LayerSet to the bound nodes of the active layer. Layers that `order` omits are not drawn.
void WorldRuntime::add_layers(const vrml::LayerSet& set, render::BoundNodes& nodes) const {
  using vrml::NodeKind;
  const vrml::SceneGraph& world = *world_.scene;
  const auto id_of = [&](int layer) {
    return layer == 0 ? vrml::NodeId{} : set.layers[static_cast<std::size_t>(layer) - 1];
  };
  nodes.layer_set = set.node;
  nodes.layer = set.active;
  nodes.boundary = vrml::clip_boundary_of(world, id_of(set.active));
  nodes.pickable = vrml::is_pickable(world, id_of(set.active));
  nodes.parallel = vrml::is_layout_layer(world, id_of(set.active));
  nodes.drawn = false;
  bool in_front = false;
  for (const int layer : set.order) {
    if (!vrml::is_visible(world, id_of(layer))) continue;
    if (layer == set.active) {
      in_front = nodes.drawn = true;
      continue;
    }
    const auto node_of = [&](NodeKind kind) -> const vrml::Node* {
      const vrml::NodeChange bound = execution_.stacks().bound(vrml::built_in_node_type(kind), layer);
      return bound.scene ? &bound.scene->node(bound.node) : nullptr;
    };
    nodes.others.push_back({node_of(NodeKind::viewpoint), node_of(NodeKind::navigation_info),
                            node_of(NodeKind::background), node_of(NodeKind::fog), layer,
                            vrml::clip_boundary_of(world, id_of(layer)), in_front,
                            vrml::is_pickable(world, id_of(layer)), vrml::is_layout_layer(world, id_of(layer))});
  }
}

}  // namespace gs::app
