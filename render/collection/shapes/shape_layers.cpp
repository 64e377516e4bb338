#include "render/collection/shapes/shape_layers.h"

#include "render/collection/nodes/node_fields.h"
#include "render/collection/nodes/texture_sampling.h"
#include "vrml/scene/coordinates/texture_coordinate_nodes.h"
#include "vrml/scene/meant_node.h"
#include "vrml/scene/values/transformation.h"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

namespace gs::render {
namespace {

using Layer = TextureLayer;
using Coordinates = TextureLayer::Coordinates;
using Target = TextureLayer::Target;
using vrml::NodeId;

glm::vec3 color(const vrml::Node& node, std::string_view name, const glm::vec3& otherwise) {
  const auto* value = field<vrml::SFColor>(node, name);
  if (!value || !std::isfinite(value->r + value->g + value->b)) return otherwise;
  return glm::clamp(glm::vec3(value->r, value->g, value->b), glm::vec3(0), glm::vec3(1));
}

bool has_node(const vrml::SceneGraph& scene, const vrml::Node& node, std::string_view name) {
  const auto* value = field<vrml::SFNode>(node, name);
  return value && scene.resolve(*value);
}

// X3D Table 18.3.
constexpr std::array<Named<Layer::Mode>, 20> kStageModes = {{
    {"MODULATE", Layer::Mode::modulate},
    {"REPLACE", Layer::Mode::replace},
    {"MODULATE2X", Layer::Mode::modulate_2x},
    {"MODULATE4X", Layer::Mode::modulate_4x},
    {"ADD", Layer::Mode::add},
    {"ADDSIGNED", Layer::Mode::add_signed},
    {"ADDSIGNED2X", Layer::Mode::add_signed_2x},
    {"SUBTRACT", Layer::Mode::subtract},
    {"ADDSMOOTH", Layer::Mode::add_smooth},
    {"BLENDDIFFUSEALPHA", Layer::Mode::blend_diffuse_alpha},
    {"BLENDTEXTUREALPHA", Layer::Mode::blend_texture_alpha},
    {"BLENDFACTORALPHA", Layer::Mode::blend_factor_alpha},
    {"BLENDCURRENTALPHA", Layer::Mode::blend_current_alpha},
    {"MODULATEALPHA_ADDCOLOR", Layer::Mode::modulate_alpha_add_color},
    {"MODULATEINVALPHA_ADDCOLOR", Layer::Mode::modulate_inverse_alpha_add_color},
    {"MODULATEINVCOLOR_ADDALPHA", Layer::Mode::modulate_inverse_color_add_alpha},
    {"DOTPRODUCT3", Layer::Mode::dot_product},
    {"SELECTARG1", Layer::Mode::select_1},
    {"SELECTARG2", Layer::Mode::select_2},
    {"OFF", Layer::Mode::off},
}};
constexpr std::array<Named<Layer::Source>, 3> kStageSources = {{
    {"DIFFUSE", Layer::Source::diffuse},
    {"SPECULAR", Layer::Source::specular},
    {"FACTOR", Layer::Source::factor},
}};
constexpr std::array<Named<Layer::Function>, 2> kStageFunctions = {{
    {"COMPLEMENT", Layer::Function::complement},
    {"ALPHAREPLICATE", Layer::Function::alpha_replicate},
}};
// X3D Table 18.6, and modes of Castle Model Viewer.
constexpr std::array<Named<Coordinates>, 16> kCoordinateModes = {{
    {"SPHERE", Coordinates::sphere},
    {"CAMERASPACENORMAL", Coordinates::camera_normal},
    {"CAMERASPACEPOSITION", Coordinates::camera_position},
    {"CAMERASPACEREFLECTIONVECTOR", Coordinates::camera_reflection},
    {"SPHERE-LOCAL", Coordinates::sphere_local},
    {"COORD", Coordinates::position},
    {"COORD-EYE", Coordinates::camera_position},
    {"NOISE", Coordinates::noise},
    {"NOISE-EYE", Coordinates::noise_camera},
    {"SPHERE-REFLECT", Coordinates::refraction},
    {"SPHERE-REFLECT-LOCAL", Coordinates::refraction_local},
    {"WORLDSPACENORMAL", Coordinates::world_normal},
    {"WORLDSPACEREFLECTIONVECTOR", Coordinates::world_reflection},
    {"BOUNDS", Coordinates::box},
    {"BOUNDS3D", Coordinates::box},
    {"BOUNDS2D", Coordinates::mesh},
}};
constexpr std::array<Named<LayeredMaterial::AlphaMode>, 3> kAlphaModeNames = {{
    {"OPAQUE", LayeredMaterial::AlphaMode::opaque},
    {"MASK", LayeredMaterial::AlphaMode::mask},
    {"BLEND", LayeredMaterial::AlphaMode::blend},
}};

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

/// Returns the element of an MFString; an empty text if there is none.
std::string_view text_at(const vrml::MFString* list, std::size_t i) {
  return list && i < list->size() ? trimmed((*list)[i].view()) : std::string_view();
}

}  // namespace

LayerBuilder::LayerBuilder(ShapeResources& resources, const vrml::SceneGraph& scene, const vrml::ShapeParts& parts,
                           NodeId geometry)
    : resources_(resources),
      scene_(scene),
      appearance_(parts.appearance),
      material_(parts.material),
      texture_(parts.texture),
      transform_(parts.texture_transform),
      material_view_(resources.schemas().view(scene, parts.material)),
      texture_view_(resources.schemas().view(scene, parts.texture)),
      coordinates_(vrml::texture_coordinate_nodes(scene, geometry)) {
  constexpr int kModern = 40;
  modern_ = appearance_ && scene.node(appearance_).text->version() >= kModern;
}

std::span<const LayerBuilder::Slot> LayerBuilder::slots() {
  static constexpr Slot kSlots[] = {
      {"diffuseTexture", "diffuseTextureMapping", Target::main},
      {"baseTexture", "baseTextureMapping", Target::main},
      {"ambientTexture", "ambientTextureMapping", Target::ambient},
      {"emissiveTexture", "emissiveTextureMapping", Target::emissive},
      {"specularTexture", "specularTextureMapping", Target::specular},
      {"shininessTexture", "shininessTextureMapping", Target::shininess},
      {"normalTexture", "normalTextureMapping", Target::normal},
      {"occlusionTexture", "occlusionTextureMapping", Target::occlusion},
      {"metallicRoughnessTexture", "metallicRoughnessTextureMapping", Target::metallic_roughness},
  };
  return kSlots;
}

bool LayerBuilder::is_plain() const {
  const auto language_of = [&](NodeId id) { return scene_.node(id).type->language; };
  constexpr auto kX3D = vrml::Language::x3d;
  if (material_ && language_of(material_) == kX3D) {
    if (material_view_.kind() == NodeKind::physical_material) return false;
    if (material_view_.kind() == NodeKind::two_sided_material &&
        scene_.get<vrml::SFBool>(material_, "separateBackColor"))
      return false;
    for (const Slot& slot : slots())
      if (has_node(scene_, scene_.node(material_), slot.texture)) return false;
  }
  if (appearance_ && language_of(appearance_) == kX3D) {
    if (has_node(scene_, scene_.node(appearance_), "backMaterial")) return false;
    if (named(kAlphaModeNames, text_in(appearance_, "alphaMode"), LayeredMaterial::AlphaMode::automatic) !=
        LayeredMaterial::AlphaMode::automatic)
      return false;
  }
  if (!texture_) return true;
  const NodeKind kind = texture_view_.kind();
  if (kind != NodeKind::image_texture && kind != NodeKind::movie_texture && kind != NodeKind::pixel_texture)
    return kind == NodeKind::other;
  if (transform_ && scene_.node(transform_).type->read_as != NodeKind::texture_transform) return false;
  return coordinates_.empty() ||
         (coordinates_.size() == 1 && scene_.node(coordinates_[0]).type->read_as != NodeKind::texture_coordinate_3d &&
          scene_.node(coordinates_[0]).type->read_as != NodeKind::texture_coordinate_4d &&
          scene_.node(coordinates_[0]).type->read_as != NodeKind::texture_coordinate_generator);
}

LayeredMaterial LayerBuilder::build() {
  set_model();
  set_back();
  set_alpha_mode();
  if (material_) add_slots();
  if (texture_ && !has_main_) add_appearance_texture();
  return std::move(result_);
}

void LayerBuilder::set_model() {
  using Model = LayeredMaterial::Model;
  const NodeKind kind = material_view_.kind();
  result_.model = kind == NodeKind::physical_material                                  ? Model::physical
                  : kind == NodeKind::material || kind == NodeKind::two_sided_material ? Model::phong
                                                                                       : Model::unlit;
  if (!material_view_) return;
  const vrml::Node& node = *material_view_.node;
  result_.metallic = number(node, "metallic", 0, 1, 1);
  result_.roughness = number(node, "roughness", 0, 1, 1);
  result_.normal_scale = number(node, "normalScale", 0, 1000, 1);
  result_.occlusion_strength = number(node, "occlusionStrength", 0, 1, 1);
}

void LayerBuilder::set_back() {
  BackMaterial& back = result_.back;
  if (material_view_.kind() == NodeKind::two_sided_material) {
    const vrml::Node& node = *material_view_.node;
    const auto* separate = field<vrml::SFBool>(node, "separateBackColor");
    if (!separate || !*separate) return;
    result_.has_back = true;
    back.main = color(node, "backDiffuseColor", back.main);
    back.emissive = color(node, "backEmissiveColor", back.emissive);
    back.specular = color(node, "backSpecularColor", back.specular);
    back.ambient_intensity = number(node, "backAmbientIntensity", 0, 1, back.ambient_intensity);
    back.shininess = number(node, "backShininess", 0, 1, back.shininess);
    back.transparency = number(node, "backTransparency", 0, 1, 0);
    return;
  }
  const auto* given = appearance_ ? field<vrml::SFNode>(scene_.node(appearance_), "backMaterial") : nullptr;
  const NodeView view = given ? resources_.schemas().view(scene_, *given) : NodeView{};
  // The standard requires materials of one type on both sides.
  if (!view || view.kind() != material_view_.kind()) return;
  const Material material = material_of(view);
  result_.has_back = true;
  back = {material.diffuse,
          material.emissive,
          material.specular,
          material.ambient_intensity,
          material.shininess,
          material.transparency,
          number(*view.node, "metallic", 0, 1, 1),
          number(*view.node, "roughness", 0, 1, 1)};
}

void LayerBuilder::set_alpha_mode() {
  if (!appearance_ || scene_.node(appearance_).type->language != vrml::Language::x3d) return;
  result_.alpha_mode = named(kAlphaModeNames, text_in(appearance_, "alphaMode"), LayeredMaterial::AlphaMode::automatic);
  result_.alpha_cutoff = number(scene_.node(appearance_), "alphaCutoff", 0, 1, 0.5f);
}

void LayerBuilder::add_slots() {
  const vrml::Node& node = scene_.node(material_);
  for (const Slot& slot : slots()) {
    const auto* given = field<vrml::SFNode>(node, slot.texture);
    const NodeId texture = given ? vrml::meant_node(scene_, *given, vrml::Role::texture) : NodeId{};
    if (!texture) continue;
    Layer layer;
    layer.target = slot.target;
    // The colour of an unlit material is its emissive colour.
    if (result_.model == LayeredMaterial::Model::unlit && layer.target == Target::emissive) layer.target = Target::main;
    has_main_ = has_main_ || layer.target == Target::main;
    if (set_texture(layer, texture)) add(std::move(layer), 0, text_in(material_, slot.mapping));
  }
}

void LayerBuilder::add_appearance_texture() {
  if (texture_view_.kind() == NodeKind::multi_texture) return add_multi_texture(texture_view_);
  Layer layer;
  if (!set_texture(layer, texture_)) return;
  set_single_modes(layer);
  add(std::move(layer), 0, {});
}

void LayerBuilder::add_multi_texture(const NodeView& multi) {
  const auto* textures = field<vrml::MFNode>(*multi.node, "texture");
  const auto* modes = field<vrml::MFString>(*multi.node, "mode");
  const auto* sources = field<vrml::MFString>(*multi.node, "source");
  const auto* functions = field<vrml::MFString>(*multi.node, "function");
  result_.factor = glm::vec4(color(*multi.node, "color", glm::vec3(1)), number(*multi.node, "alpha", 0, 1, 1));
  for (std::size_t i = 0; textures && i < textures->size() && i < kMaxTextureLayers; ++i) {
    Layer layer;
    if (!set_texture(layer, vrml::meant_node(scene_, (*textures)[i], vrml::Role::texture))) continue;
    // Two modes apply to the colour and to alpha.
    const std::string_view mode = text_at(modes, i);
    const std::size_t split = mode.find_first_of(",/");
    layer.color_mode = named(kStageModes, trimmed(mode.substr(0, split)), Layer::Mode::modulate);
    layer.alpha_mode = split == mode.npos ? layer.color_mode
                                          : named(kStageModes, trimmed(mode.substr(split + 1)), Layer::Mode::modulate);
    layer.source = named(kStageSources, text_at(sources, i), Layer::Source::previous);
    layer.function = named(kStageFunctions, text_at(functions, i), Layer::Function::none);
    add(std::move(layer), i, {});
  }
}

/// Sets how the only texture of an Appearance changes the colour: it modulates in X3D 4, otherwise as in Table 17.3.
void LayerBuilder::set_single_modes(Layer& layer) const {
  if (modern_) return;
  const Image* image = layer.image.get();
  for (const auto& face : layer.faces)
    if (!image && face) image = face.get();
  const std::uint32_t components = image ? image->components : 3;
  layer.color_mode = components >= 3 ? Layer::Mode::replace : Layer::Mode::modulate;
  layer.alpha_mode = components % 2 == 0 ? Layer::Mode::replace : Layer::Mode::off;
}

/// Sets the images of a layer. Returns false if there are none (yet).
bool LayerBuilder::set_texture(Layer& layer, NodeId texture) {
  const NodeView view = resources_.schemas().view(scene_, texture);
  switch (view.kind()) {
    case NodeKind::image_texture:
    case NodeKind::movie_texture:
    case NodeKind::pixel_texture:
      layer.image = resources_.image_of_texture(scene_, texture);
      break;
    case NodeKind::image_texture_3d:
      layer.kind = Layer::Kind::volume;
      layer.image = resources_.image_of_texture(scene_, texture);
      break;
    case NodeKind::pixel_texture_3d:
      layer.kind = Layer::Kind::volume;
      layer.image = resources_.volume_of_pixels(scene_, texture);
      break;
    case NodeKind::composed_texture_3d:
      layer.kind = Layer::Kind::volume;
      layer.image = resources_.volume_of_textures(scene_, texture);
      break;
    case NodeKind::image_cube_map_texture:
      layer.kind = Layer::Kind::cube;
      layer.image = resources_.image_of_texture(scene_, texture);
      break;
    case NodeKind::composed_cube_map_texture:
      layer.kind = Layer::Kind::cube;
      if (!set_cube_faces(layer, scene_, view)) return false;
      break;
    case NodeKind::generated_cube_map_texture:
      layer.kind = Layer::Kind::scene_cube;
      layer.scene_cube = resources_.scene_cube(scene_, texture);
      break;
    case NodeKind::multi_texture: {
      // A material takes only single textures; the first one is meant.
      const auto* textures = field<vrml::MFNode>(*view.node, "texture");
      const NodeId first =
          textures && !textures->empty() ? vrml::meant_node(scene_, textures->front(), vrml::Role::texture) : NodeId{};
      return first && resources_.schemas().view(scene_, first).kind() != NodeKind::multi_texture &&
             set_texture(layer, first);
    }
    default:
      return false;
  }
  layer.sampling = sampling_of(resources_.schemas(), scene_, view);
  return layer.kind == Layer::Kind::scene_cube || view.kind() == NodeKind::composed_cube_map_texture || layer.image;
}

bool LayerBuilder::set_cube_faces(Layer& layer, const vrml::SceneGraph& scene, const NodeView& cube) {
  static constexpr std::array<std::string_view, 6> kFaces = {"backTexture", "bottomTexture", "frontTexture",
                                                             "leftTexture", "rightTexture",  "topTexture"};
  bool any = false;
  for (std::size_t i = 0; i < kFaces.size(); ++i) {
    const auto* given = field<vrml::SFNode>(*cube.node, kFaces[i]);
    const NodeId texture = given ? vrml::meant_node(scene, *given, vrml::Role::texture) : NodeId{};
    if (texture) layer.faces[i] = resources_.image_of_texture(scene, texture);
    any = any || layer.faces[i];
  }
  return any;
}

void LayerBuilder::add(Layer layer, std::size_t unit, std::string_view mapping) {
  if (result_.layers.size() >= kMaxTextureLayers) return;
  set_coordinates(layer, unit, mapping);
  set_transform(layer, unit, mapping);
  if (layer.kind == Layer::Kind::cube || layer.kind == Layer::Kind::scene_cube) {
    // Cubes surround the world, so they do not turn with the camera.
    if (layer.coordinates == Coordinates::camera_normal) layer.coordinates = Coordinates::world_normal;
    if (layer.coordinates == Coordinates::camera_reflection) layer.coordinates = Coordinates::world_reflection;
  }
  result_.layers.push_back(std::move(layer));
}

void LayerBuilder::set_coordinates(Layer& layer, std::size_t unit, std::string_view mapping) const {
  const bool cube = layer.kind == Layer::Kind::cube || layer.kind == Layer::Kind::scene_cube;
  if (coordinates_.empty()) {
    if (layer.kind == Layer::Kind::volume) layer.coordinates = Coordinates::box;
    if (cube) layer.coordinates = Coordinates::world_reflection;
    return;
  }
  std::size_t chosen = unit < coordinates_.size() ? unit : 0;
  for (std::size_t i = coordinates_.size(); !mapping.empty() && i-- > 0;)
    if (text_in(coordinates_[i], "mapping") == mapping) chosen = i;
  const NodeKind kind = scene_.node(coordinates_[chosen]).type->read_as;
  if (kind == NodeKind::texture_coordinate_generator) return set_generator(layer, coordinates_[chosen]);
  layer.set = static_cast<std::uint8_t>(std::min(chosen, vrml::kMaxCoordinateSets - 1));
  if (cube && kind == NodeKind::texture_coordinate) layer.coordinates = Coordinates::world_reflection;
}

void LayerBuilder::set_generator(Layer& layer, NodeId generator) const {
  layer.coordinates = named(kCoordinateModes, text_in(generator, "mode"), Coordinates::sphere);
  const auto* parameters = field<vrml::MFFloat>(scene_.node(generator), "parameter");
  if (layer.coordinates == Coordinates::noise || layer.coordinates == Coordinates::noise_camera)
    layer.parameters = {1, 1, 1, 0, 0, 0};  // scale and translation
  for (std::size_t i = 0; parameters && i < std::min(parameters->size(), layer.parameters.size()); ++i)
    if (std::isfinite((*parameters)[i])) layer.parameters[i] = (*parameters)[i];
}

std::vector<NodeId> LayerBuilder::transforms() const {
  if (!transform_) return {};
  if (scene_.node(transform_).type->read_as != NodeKind::multi_texture_transform) return {transform_};
  std::vector<NodeId> nodes;
  for (const NodeId one : scene_.get<vrml::MFNode>(transform_, "textureTransform"))
    if (nodes.size() < kMaxTextureLayers) nodes.push_back(vrml::meant_node(scene_, one, vrml::Role::texture_transform));
  return nodes;
}

void LayerBuilder::set_transform(Layer& layer, std::size_t unit, std::string_view mapping) const {
  const std::vector<NodeId> nodes = transforms();
  std::size_t chosen = unit;
  for (std::size_t i = nodes.size(); !mapping.empty() && i-- > 0;)
    if (nodes[i] && text_in(nodes[i], "mapping") == mapping) chosen = i;
  if (chosen < nodes.size() && nodes[chosen]) layer.transform = matrix_of(nodes[chosen]);
}

glm::mat4 LayerBuilder::matrix_of(NodeId transform) const {
  const NodeView view = resources_.schemas().view(scene_, transform);
  const auto vector = [&](std::string_view name, const glm::vec3& otherwise) {
    const auto* value = field<vrml::SFVec3f>(*view.node, name);
    return value && std::isfinite(value->x + value->y + value->z) ? *value : otherwise;
  };
  glm::mat4 result(1);
  switch (view.kind()) {
    case NodeKind::texture_transform: {
      const glm::mat3 flat = texture_matrix(view);
      result[0] = {flat[0].x, flat[0].y, 0, 0};
      result[1] = {flat[1].x, flat[1].y, 0, 0};
      result[3] = {flat[2].x, flat[2].y, 0, 1};
      return result;
    }
    case NodeKind::texture_transform_3d: {
      // -C * S * R * C * T, as in two dimensions (18.4.8).
      const glm::vec3 center = vector("center", glm::vec3(0));
      const auto* rotation = field<vrml::SFRotation>(*view.node, "rotation");
      result = glm::translate(result, -center);
      result = glm::scale(result, vector("scale", glm::vec3(1)));
      if (rotation) result = result * glm::mat4(glm::mat3(vrml::rotation_matrix(*rotation)));
      return glm::translate(result, center + vector("translation", glm::vec3(0)));
    }
    case NodeKind::texture_transform_matrix_3d: {
      const auto* matrix = field<vrml::SFMatrix4f>(*view.node, "matrix");
      return matrix ? **matrix : result;
    }
    default:
      return result;
  }
}

std::string_view LayerBuilder::text_in(NodeId node, std::string_view name) const {
  const auto* text = field<vrml::SFString>(scene_.node(node), name);
  return text ? text->view() : std::string_view();
}

}  // namespace gs::render
