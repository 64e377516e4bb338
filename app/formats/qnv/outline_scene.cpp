#include "app/formats/qnv/outline_scene.h"

#include "app/formats/common/scene_builder.h"

#include <algorithm>
#include <limits>
#include <span>
#include <string_view>

namespace gs::app {
namespace {

// Maximum number of corners of a node. Corner indices have 32 bits.
constexpr std::size_t kMaxCorners = std::size_t{1} << 30;

vrml::Color color_of(const qnv::Rgb8& c) {
  return {static_cast<float>(c.r) / 255, static_cast<float>(c.g) / 255, static_cast<float>(c.b) / 255};
}

Look look_of(const qnv::OutlineAppearance& from) {
  Look look;
  look.lit = from.lit;
  look.diffuse = color_of(from.diffuse);
  look.emissive = color_of(from.emissive);
  look.specular = color_of(from.specular);
  look.ambient_intensity = static_cast<float>(from.ambient_intensity) / 255;
  look.shininess = static_cast<float>(from.shininess) / 255;
  look.transparency = static_cast<float>(from.transparency) / 255;
  if (!from.lit && from.diffuse != qnv::Rgb8{255, 255, 255}) {
    look.lit = true;
    look.emissive = look.diffuse;
    look.diffuse = look.specular = {};
    look.ambient_intensity = 0;
  }
  if (from.textured) look.texture_url = vrml::String(from.texture_url);
  return look;
}

/// Returns a reference to the value of a field, for modification.
template <class T>
T& value_of(vrml::SceneGraph& scene, vrml::NodeId id, std::string_view field) {
  const vrml::Node& node = scene.node(id);
  return *std::get_if<T>(&node.values[node.type->find_field(field)->slot]);
}

/// Fields of one polygon list of an OutlineGroup: the outlines or the inner polygons.
struct Fields {
  vrml::MFVec3f& points;
  vrml::MFInt32& index;
  vrml::MFVec2f& coordinates;
  vrml::MFInt32& groups;
};

void append(const Fields& to, const qnv::OutlinePolygon& polygon, std::int32_t group) {
  const auto base = static_cast<std::int32_t>(to.points.size());
  to.points.append(polygon.positions);
  for (const std::uint32_t corner : qnv::bridged_ring(polygon))
    to.index.push_back(base + static_cast<std::int32_t>(corner));
  to.index.push_back(-1);
  if (!polygon.texture_coordinates.empty()) {
    to.coordinates.resize(static_cast<std::size_t>(base));
    to.coordinates.append(polygon.texture_coordinates);
  }
  to.groups.push_back(group);
}

}  // namespace

void OutlineScene::add(const qnv::OutlineHeader& header, const std::vector<qnv::OutlineBatch>& batches) {
  for (const qnv::OutlineBatch& batch : batches)
    if (Target* target = target_of(header, batch.appearance)) add(*target, batch);
}

OutlineScene::Target* OutlineScene::target_of(const qnv::OutlineHeader& header, std::uint32_t appearance) {
  const std::uint32_t key = node_ ? 0 : appearance;
  const auto [at, fresh] = targets_.try_emplace(key);
  if (!fresh) return at->second.node ? &at->second : nullptr;
  SceneBuilder builder(scene_, diagnostics_);
  const qnv::OutlineAppearance look =
      appearance < header.appearances.size() ? header.appearances[appearance] : qnv::OutlineAppearance{};
  at->second.node = node_ ? node_ : builder.make(vrml::NodeKind::outline_group);
  if (!at->second.node) return nullptr;
  if (!node_) {
    builder.set(at->second.node, "solid", vrml::SFBool{look.solid});
    builder.set(at->second.node, "creaseAngle", vrml::SFFloat{look.crease_angle});
    builder.add_root(builder.shape(at->second.node, builder.appearance(look_of(look))));
  }
  return &at->second;
}

std::int32_t OutlineScene::group_of(Target& target, std::uint32_t group, std::uint32_t count) {
  auto& sizes = value_of<vrml::MFInt32>(scene_, target.node, "groupSize");
  const auto [at, fresh] = target.groups.try_emplace(group, static_cast<std::int32_t>(sizes.size()));
  if (fresh) sizes.push_back(0);
  if (count > 0)
    sizes.mutable_data()[at->second] =
        static_cast<std::int32_t>(std::min<std::uint32_t>(count, std::numeric_limits<std::int32_t>::max()));
  return at->second;
}

void OutlineScene::add(Target& target, const qnv::OutlineBatch& batch) {
  const vrml::NodeId node = target.node;
  const auto field = [&]<class T>(std::string_view name, T*) -> T& { return value_of<T>(scene_, node, name); };
  const Fields stays{
      field("point", static_cast<vrml::MFVec3f*>(nullptr)), field("coordIndex", static_cast<vrml::MFInt32*>(nullptr)),
      field("texCoord", static_cast<vrml::MFVec2f*>(nullptr)), field("group", static_cast<vrml::MFInt32*>(nullptr))};
  const Fields outline{field("outline", static_cast<vrml::MFVec3f*>(nullptr)),
                       field("outlineIndex", static_cast<vrml::MFInt32*>(nullptr)),
                       field("outlineTexCoord", static_cast<vrml::MFVec2f*>(nullptr)),
                       field("outlineGroup", static_cast<vrml::MFInt32*>(nullptr))};
  for (std::size_t i = 0; i < batch.polygons.size(); ++i) {
    const qnv::OutlinePolygon polygon = batch.polygons[i];
    if (stays.points.size() + outline.points.size() + polygon.positions.size() > kMaxCorners) return;
    // Memory for positions and indices of the corners, and for the group index of the polygon.
    constexpr std::size_t kCornerBytes = sizeof(glm::vec3) + 2 * sizeof(std::int32_t), kPolygonBytes = 32;
    const std::size_t bytes = polygon.positions.size() * kCornerBytes +
                              polygon.texture_coordinates.size() * sizeof(glm::vec2) + kPolygonBytes;
    full_ = full_ || !scene_.memory().charge(bytes);
    if (full_) return;
    if (batch.inner) {
      append(stays, polygon, group_of(target, batch.groups[i], 0));
    } else if (batch.stays(i)) {
      append(stays, polygon, -1);
    } else {
      append(outline, polygon, group_of(target, batch.groups[i], batch.counts[i]));
    }
  }
}

void OutlineScene::complete() {
  for (const vrml::NodeId id : nodes()) scene_.set<vrml::SFBool>(id, "complete", true);
}

std::vector<vrml::NodeId> OutlineScene::nodes() const {
  std::vector<vrml::NodeId> all;
  for (const auto& [appearance, target] : targets_)
    if (target.node) all.push_back(target.node);
  return all;
}

}  // namespace gs::app
