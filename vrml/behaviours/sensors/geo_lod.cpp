#include "vrml/behaviours/sensors/viewer_box.h"
#include "vrml/events/execution.h"
#include "vrml/scene/coordinates/geo_tiles.h"
#include "vrml/scene/coordinates/geospatial.h"
#include "vrml/scene/values/transformation.h"

#include <glm/geometric.hpp>

#include <utility>

// GeoLOD (X3D 25.3.4): loads four child tiles while the viewer is nearer than `range`, and shows them instead of the
// root once all of them are loaded or have failed.
namespace gs::vrml {
namespace {

struct Terrain {
  enum : int { children, level_changed, center, range, root_node };
};

bool is_in_range(Execution& execution, EventNode node) {
  const EventMember& at = execution.nodes()[node];
  const glm::dvec3 viewer(execution.viewer().pose()[3]);
  const glm::dvec3 center = geo_position(*at.scene, *at.node, "center");
  const double range = execution.get<SFFloat>(node, Terrain::range);
  for (const glm::dmat4& world_from_local : execution.viewer().places_of(node))
    if (glm::length(viewer_in_local(viewer, world_from_local) - center) < range) return true;
  return false;
}

// Takes new tiles into the hierarchy and requests their content.
void take_in_tiles(Execution& execution, EventNode node) {
  const EventMember at = execution.nodes()[node];
  execution.placement().children_changed(*at.scene, at.id);
  execution.scenes().attach(*at.scene);
}

// Sets `load` of the child tiles, without events. FALSE removes their content from memory.
void set_load(Execution& execution, SceneGraph& scene, const MFNode& tiles, bool load) {
  for (const NodeId id : tiles) {
    Node& tile = scene.node(id);
    const EventNode member = may_load(tile) == load ? 0 : execution.scenes().event_node(scene, id);
    if (member == 0) continue;
    const int slot = load_field(*tile.type)->slot;
    tile.values[slot] = SFBool{load};
    if (load) execution.loads().note(tile, UrlLoad::pending);
    execution.changes().mark(member, slot);
  }
}

// Reports whether no tile is loading, and at least one has content.
bool are_loaded(Execution& execution, const SceneGraph& scene, const MFNode& tiles) {
  bool any = false;
  for (const NodeId id : tiles) any = any || scene.inlines().of(id) != nullptr;
  return any && execution.loads().count(scene, tiles).pending == 0;
}

// Writes the shown nodes: Inlines for urls, or the nodes of rootNode.
bool shown_nodes(Execution& execution, EventNode node, FieldValue& value) {
  const NodePlace at = execution.nodes().place_of(node);
  const GeoTiles* const tiles = at.scene->inlines().tiles_of(at.node);
  const MFNode* const shown = tiles ? tiles->shown() : nullptr;
  value = shown ? *shown : execution.get<MFNode>(node, Terrain::root_node);
  return true;
}

void show_level(Execution& execution, EventNode node, bool refined) {
  const EventMember at = execution.nodes()[node];
  at.scene->inlines().tiles(at.id).refined = refined;
  FieldValue shown;
  (void)shown_nodes(execution, node, shown);
  execution.send(node, Terrain::children, std::get<MFNode>(std::move(shown)));
  execution.send(node, Terrain::level_changed, SFInt32{refined ? 1 : 0});
  execution.changes().mark_content(*at.scene, at.id);
}

void choose_tiles(Execution& execution, EventNode node) {
  execution.timers().run(node, true);
  if (!execution.budget().spend(EventBudget::kDelivery)) return;
  const EventMember at = execution.nodes()[node];
  SceneGraph& scene = *at.scene;
  const bool near = is_in_range(execution, node);
  const bool made_root = make_root_tile(scene, at.id), made_children = near && make_child_tiles(scene, at.id);
  if (made_root || made_children) take_in_tiles(execution, node);
  const GeoTiles* const tiles = scene.inlines().tiles_of(at.id);
  if (!tiles || tiles->children.empty()) return;
  set_load(execution, scene, tiles->children, near);
  const bool refined = near && (tiles->refined || are_loaded(execution, scene, tiles->children));
  if (refined != tiles->refined && !execution.has_sent(node, Terrain::level_changed))
    show_level(execution, node, refined);
}

void begin_terrain(Execution& execution, EventNode node) { execution.timers().look_again(node); }

// A GeoLOD rests while the viewer is out of range.
std::optional<WideBox> terrain_idle_box(Execution& execution, EventNode node) {
  const EventMember& at = execution.nodes()[node];
  const GeoTiles* const tiles = at.scene->inlines().tiles_of(at.id);
  if (tiles && tiles->refined) return {};
  return world_box_of(execution, node, geo_position(*at.scene, *at.node, "center"),
                      glm::dvec3(execution.get<SFFloat>(node, Terrain::range)));
}

}  // namespace

const Behaviour kGeoLodBehaviour = {
    .events = {"children", "level_changed", "center", "range", "rootNode"},
    .initialize = begin_terrain,
    .on_time = choose_tiles,
    .idle_box = terrain_idle_box,
    .after_idle = [](Execution&, EventNode, const ViewerMoment&) {},
    .unsent_value = shown_nodes,
};

}  // namespace gs::vrml
