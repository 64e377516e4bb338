#include "vrml/scene/coordinates/geo_tiles.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace gs::vrml {
namespace {

// Appends an Inline for the urls in a field of a GeoLOD. The Inline belongs to the same text, so that its relative URLs
// have the same base.
void append_tile(SceneGraph& scene, NodeId lod, std::string_view url_field, MFNode& tiles) {
  const Node& node = scene.node(lod);
  const InterfaceDeclaration* const field = node.type->find_field(url_field);
  const auto* const urls = field ? std::get_if<MFString>(&node.values[field->slot]) : nullptr;
  if (!urls || std::all_of(urls->begin(), urls->end(), [](const SFString& url) { return url.empty(); })) return;
  const NodeType& type = *x3d_extension_of(built_in_node_type(NodeKind::inline_node));
  const WritingFor writing(scene, node.owner);
  const NodeId made = scene.create(type, node.location);
  if (!made) return;
  scene.set(made, "url", *urls);
  scene.nodes().set_text(made, type.find_field("url")->slot, scene.nodes().text_of(lod, field->slot));
  tiles.push_back(made);
}

}  // namespace

bool make_root_tile(SceneGraph& scene, NodeId lod) {
  const GeoTiles* const known = scene.inlines().tiles_of(lod);
  MFNode tiles = known ? known->root : MFNode();
  if (!tiles.empty()) return false;
  append_tile(scene, lod, "rootUrl", tiles);
  if (tiles.empty()) return false;
  scene.inlines().tiles(lod).root = std::move(tiles);
  return true;
}

bool make_child_tiles(SceneGraph& scene, NodeId lod) {
  const GeoTiles* const known = scene.inlines().tiles_of(lod);
  MFNode tiles = known ? known->children : MFNode();
  if (!tiles.empty()) return false;
  for (const std::string_view field : {"child1Url", "child2Url", "child3Url", "child4Url"})
    append_tile(scene, lod, field, tiles);
  if (tiles.empty()) return false;
  scene.inlines().tiles(lod).children = std::move(tiles);
  return true;
}

}  // namespace gs::vrml
