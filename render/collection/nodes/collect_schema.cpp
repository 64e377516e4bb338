#include "render/collection/nodes/collect_schema.h"

#include "vrml/scene/meant_node.h"

namespace gs::render {
namespace {

struct SchemaRow {
  NodeKind kind;
  std::array<std::string_view, Schema::kFields> fields;  // names, in the order of the enum
};

constexpr SchemaRow kSchemaRows[] = {
    {NodeKind::shape, {"appearance", "geometry"}},
    {NodeKind::particle_system, {"appearance", "geometry"}},
    {NodeKind::volume_data, {}},
    {NodeKind::segmented_volume, {}},
    {NodeKind::iso_surface_volume, {}},
    {NodeKind::opacity_map_style, {}},
    {NodeKind::boundary_style, {}},
    {NodeKind::edge_style, {}},
    {NodeKind::tone_mapped_style, {}},
    {NodeKind::silhouette_style, {}},
    {NodeKind::cartoon_style, {}},
    {NodeKind::shaded_style, {}},
    {NodeKind::composed_style, {}},
    {NodeKind::blended_style, {}},
    {NodeKind::projection_style, {}},
    {NodeKind::group, {"children"}},
    {NodeKind::layer_set, {"layers"}},
    {NodeKind::layer, {"children"}},
    {NodeKind::viewport, {"children"}},
    {NodeKind::layout, {"align", "offset", "offsetUnits", "scaleMode", "size", "sizeUnits"}},
    {NodeKind::layout_group, {"children", "layout", "viewport"}},
    {NodeKind::layout_layer, {"children", "layout"}},
    {NodeKind::screen_group, {"children"}},
    {NodeKind::collision, {"children", "collide", "proxy"}},
    {NodeKind::transform, {"children", "center", "rotation", "scale", "scaleOrientation", "translation"}},
    {NodeKind::geo_group, {"children"}},
    {NodeKind::geo_lod, {"rootNode"}},
    {NodeKind::humanoid, {"skeleton", "center", "rotation", "scale", "scaleOrientation", "translation", "skin"}},
    {NodeKind::billboard, {"children", "axisOfRotation"}},
    {NodeKind::switch_node, {"choice", "whichChoice"}},
    {NodeKind::lod, {"level", "center", "range"}},
    {NodeKind::inline_node, {}},
    {NodeKind::directional_light,
     {"on", "color", "intensity", "ambientIntensity", "direction", "", "", "", "", "", "global"}},
    {NodeKind::point_light,
     {"on", "color", "intensity", "ambientIntensity", "", "location", "attenuation", "radius", "", "", "global"}},
    {NodeKind::spot_light,
     {"on", "color", "intensity", "ambientIntensity", "direction", "location", "attenuation", "radius", "beamWidth",
      "cutOffAngle", "global"}},
    {NodeKind::viewpoint,
     {"position", "orientation", "fieldOfView", "description", "jump", "centerOfRotation", "viewAll",
      "retainUserOffsets", "nearDistance", "farDistance", "navigationInfo"}},
    {NodeKind::viewpoint_group, {"children", "displayed", "retainUserOffsets", "description", "center", "size"}},
    {NodeKind::navigation_info,
     {"type", "avatarSize", "speed", "visibilityLimit", "headlight", "transitionType", "transitionTime"}},
    {NodeKind::background,
     {"skyColor", "skyAngle", "groundColor", "groundAngle", "transparency", "backTexture", "bottomTexture",
      "frontTexture", "leftTexture", "rightTexture", "topTexture"}},
    {NodeKind::fog, {"color", "fogType", "visibilityRange"}},
    {NodeKind::local_fog, {"color", "fogType", "visibilityRange", "enabled"}},
    {NodeKind::appearance, {"lineProperties", "fillProperties", "pointProperties"}},
    {NodeKind::line_properties, {"applied", "linetype", "linewidthScaleFactor"}},
    {NodeKind::fill_properties, {"filled", "hatched", "hatchColor", "hatchStyle"}},
    {NodeKind::point_properties, {"pointSizeScaleFactor", "pointSizeMinValue", "pointSizeMaxValue", "attenuation"}},
    {NodeKind::clip_plane, {"enabled", "plane"}},
    {NodeKind::cad_face, {"shape"}},
    {NodeKind::material,
     {"diffuseColor", "emissiveColor", "specularColor", "ambientIntensity", "shininess", "transparency"}},
    {NodeKind::two_sided_material,
     {"diffuseColor", "emissiveColor", "specularColor", "ambientIntensity", "shininess", "transparency"}},
    {NodeKind::unlit_material, {"", "emissiveColor", "", "", "", "transparency"}},
    {NodeKind::physical_material, {"baseColor", "emissiveColor", "", "", "", "transparency"}},
    {NodeKind::image_texture, {"repeatS", "repeatT", "", "textureProperties"}},
    {NodeKind::movie_texture, {"repeatS", "repeatT", "", "textureProperties"}},
    {NodeKind::pixel_texture, {"repeatS", "repeatT", "image", "textureProperties"}},
    {NodeKind::image_texture_3d, {"repeatS", "repeatT", "", "textureProperties", "repeatR"}},
    {NodeKind::pixel_texture_3d, {"repeatS", "repeatT", "", "textureProperties", "repeatR"}},
    {NodeKind::composed_texture_3d, {"repeatS", "repeatT", "", "textureProperties", "repeatR"}},
    {NodeKind::image_cube_map_texture, {"", "", "", "textureProperties"}},
    {NodeKind::composed_cube_map_texture, {"", "", "", "textureProperties"}},
    {NodeKind::generated_cube_map_texture, {"", "", "", "textureProperties"}},
    {NodeKind::texture_properties, {}},
    {NodeKind::multi_texture, {}},
    {NodeKind::multi_texture_transform, {}},
    {NodeKind::texture_transform_3d, {}},
    {NodeKind::texture_transform_matrix_3d, {}},
    {NodeKind::texture_coordinate_generator, {}},
    {NodeKind::texture_transform, {"center", "rotation", "scale", "translation"}},
    {NodeKind::sound,
     {"direction", "intensity", "location", "maxBack", "maxFront", "minBack", "minFront", "priority", "source",
      "spatialize"}},
    {NodeKind::qnv, {"detail"}},
};

Schema make_schema(const vrml::NodeType& type) {
  Schema schema;
  schema.slots.fill(-1);
  for (const SchemaRow& row : kSchemaRows) {
    if (row.kind != type.read_as) continue;
    schema.kind = row.kind;
    for (std::size_t i = 0; i < row.fields.size(); ++i)
      if (!row.fields[i].empty())
        if (const vrml::InterfaceDeclaration* declaration = type.find_field(row.fields[i]))
          schema.slots[i] = declaration->slot;
  }
  const auto slot_of = [&](std::string_view name) {
    const vrml::InterfaceDeclaration* declaration = type.find_field(name);
    return declaration ? declaration->slot : -1;
  };
  if (type.language == vrml::Language::x3d) {
    schema.visible = slot_of("visible");
    schema.box_display = slot_of("bboxDisplay");
  }
  return schema;
}

}  // namespace

const Schema& Schemas::of(const vrml::NodeType& type) {
  const auto found = schemas_.find(&type);
  return found != schemas_.end() ? found->second : schemas_.emplace(&type, make_schema(type)).first->second;
}

vrml::NodeId geometry_of(const vrml::SceneGraph& scene, const NodeView& shape) {
  const vrml::NodeId given = shape.get(ShapeFields::geometry, vrml::NodeId{});
  const vrml::NodeId meant = vrml::meant_node(scene, given, vrml::Role::geometry);
  return meant ? meant : scene.resolve(given);
}

NodeView Schemas::view(const vrml::SceneGraph& scene, vrml::NodeId id) {
  id = scene.resolve(id);
  if (!id) return {};
  const vrml::Node& node = scene.node(id);
  return {&node, &of(*node.type)};
}

}  // namespace gs::render
