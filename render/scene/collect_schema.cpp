#include "render/scene/collect_schema.h"

namespace gs::render {
namespace {

struct SchemaRow {
  std::string_view type;
  NodeKind kind;
  std::array<std::string_view, Schema::kFields> fields;  // in the order of the enums
};

constexpr SchemaRow kSchemaRows[] = {
    {"Shape", NodeKind::shape, {"appearance", "geometry"}},
    {"Group", NodeKind::group, {"children"}},
    {"Anchor", NodeKind::group, {"children"}},
    {"Collision", NodeKind::collision, {"children", "collide", "proxy"}},
    {"Transform", NodeKind::transform, {"children", "center", "rotation", "scale", "scaleOrientation", "translation"}},
    {"Billboard", NodeKind::billboard, {"children", "axisOfRotation"}},
    {"Switch", NodeKind::switch_node, {"choice", "whichChoice"}},
    {"LOD", NodeKind::lod, {"level", "center", "range"}},
    {"Inline", NodeKind::inline_node, {}},
    {"DirectionalLight", NodeKind::directional_light, {"on", "color", "intensity", "ambientIntensity", "direction"}},
    {"PointLight",
     NodeKind::point_light,
     {"on", "color", "intensity", "ambientIntensity", "", "location", "attenuation", "radius"}},
    {"SpotLight",
     NodeKind::spot_light,
     {"on", "color", "intensity", "ambientIntensity", "direction", "location", "attenuation", "radius", "beamWidth",
      "cutOffAngle"}},
    {"Viewpoint", NodeKind::viewpoint, {"position", "orientation", "fieldOfView", "description", "jump"}},
    {"NavigationInfo", NodeKind::navigation_info, {"type", "avatarSize", "speed", "visibilityLimit", "headlight"}},
    {"Background", NodeKind::background, {"skyColor", "skyAngle", "groundColor", "groundAngle"}},
    {"Fog", NodeKind::fog, {"color", "fogType", "visibilityRange"}},
    {"Appearance", NodeKind::appearance, {"material", "texture", "textureTransform"}},
    {"Material",
     NodeKind::material,
     {"diffuseColor", "emissiveColor", "specularColor", "ambientIntensity", "shininess", "transparency"}},
    {"ImageTexture", NodeKind::image_texture, {"repeatS", "repeatT"}},
    {"MovieTexture", NodeKind::image_texture, {"repeatS", "repeatT"}},
    {"PixelTexture", NodeKind::pixel_texture, {"repeatS", "repeatT", "image"}},
    {"TextureTransform", NodeKind::texture_transform, {"center", "rotation", "scale", "translation"}},
    {"QNV", NodeKind::qnv, {"detail"}},
};

Schema make_schema(const vrml::NodeType& type) {
  Schema schema;
  schema.slots.fill(-1);
  if (type.kind != vrml::NodeType::Kind::built_in) return schema;
  for (const SchemaRow& row : kSchemaRows) {
    if (row.type != type.name) continue;
    schema.kind = row.kind;
    for (std::size_t i = 0; i < row.fields.size(); ++i)
      if (!row.fields[i].empty())
        if (const vrml::InterfaceDeclaration* declaration = type.find_field(row.fields[i]))
          schema.slots[i] = declaration->slot;
  }
  return schema;
}

}  // namespace

const Schema& Schemas::of(const vrml::NodeType& type) {
  const auto found = schemas_.find(&type);
  return found != schemas_.end() ? found->second : schemas_.emplace(&type, make_schema(type)).first->second;
}

NodeView Schemas::view(const vrml::SceneGraph& scene, vrml::NodeId id) {
  id = scene.resolve(id);
  if (!id) return {};
  const vrml::Node& node = scene.node(id);
  return {&node, &of(*node.type)};
}

}  // namespace gs::render
