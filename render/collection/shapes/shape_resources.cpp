#include "render/collection/shapes/shape_resources.h"

#include "render/collection/nodes/texture_sampling.h"
#include "render/collection/shapes/shape_layers.h"
#include "render/scene/late_meshes.h"
#include "render/text/glyph_sheet.h"
#include "render/text/system_fonts.h"

#include <glm/glm.hpp>
#include <glm/gtc/constants.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace gs::render {
namespace {

// Additional bytes per pixel of an image: 4 for the renderer's copy, and its mipmaps.
constexpr std::size_t kPixelCopy = 6;

/// Returns the circumradius of the regular polygon that has the area of the unit circle. Tiny primitives then keep
/// their brightness.
float outside_of_circle(int segments) {
  const auto count = static_cast<float>(segments);
  return std::sqrt(glm::two_pi<float>() / (count * std::sin(glm::two_pi<float>() / count)));
}

/// Scales a mesh away from the Y axis by a factor.
void widen(vrml::Mesh& mesh, float factor) {
  std::vector<glm::vec3> positions(mesh.positions.begin(), mesh.positions.end());
  mesh.bounds = {};
  for (glm::vec3& position : positions) {
    position.x *= factor;
    position.z *= factor;
    mesh.bounds.add(position);
  }
  mesh.positions.clear();
  glm::vec3* to = mesh.positions.prepare(positions.size());
  std::copy(positions.begin(), positions.end(), to);
  mesh.positions.commit(positions.size());
}

bool is_x3d(const vrml::SceneGraph& scene, vrml::NodeId id) {
  return id && scene.node(id).type->language == vrml::Language::x3d;
}

/// Reports whether a node of X3D may need a LayeredMaterial. VRML97 has none.
bool may_have_layers(const vrml::SceneGraph& scene, const vrml::ShapeParts& parts) {
  return is_x3d(scene, parts.appearance) || is_x3d(scene, parts.material) || is_x3d(scene, parts.texture) ||
         is_x3d(scene, parts.texture_transform);
}

/// Returns the first image that changes the main colour, for code that knows only one texture.
TextureUse plain_texture(const LayeredMaterial& material) {
  TextureUse use;
  for (const TextureLayer& layer : material.layers) {
    const bool main = layer.target == TextureLayer::Target::main || layer.target == TextureLayer::Target::stage;
    if (!main || layer.kind != TextureLayer::Kind::image || layer.coordinates != TextureLayer::Coordinates::mesh)
      continue;
    use.image = layer.image;
    use.repeat_s = layer.sampling.s == Sampling::Edge::repeat;
    use.repeat_t = layer.sampling.t == Sampling::Edge::repeat;
    const glm::mat4& m = layer.transform;
    use.transform = glm::mat3(m[0].x, m[0].y, 0, m[1].x, m[1].y, 0, m[3].x, m[3].y, 1);
    use.modulates = layer.color_mode == TextureLayer::Mode::modulate;
    break;
  }
  return use;
}

/// Reports whether a material has textures (X3D 4).
bool has_textures(const vrml::SceneGraph& scene, const vrml::Node& material) {
  if (material.type->language != vrml::Language::x3d) return false;
  for (std::size_t i = 0; i < material.type->defaults.size(); ++i)
    if (const auto* node = std::get_if<vrml::SFNode>(&material.values[i]))
      if (const vrml::NodeId id = scene.resolve(*node); id && vrml::has(scene.node(id).type->role, vrml::Role::texture))
        return true;
  return false;
}

}  // namespace

ShapeResources::AppearanceNodes ShapeResources::appearance_nodes(const vrml::SceneGraph& scene, const NodeView& shape) {
  AppearanceNodes nodes;
  const auto parts = vrml::parts_of_appearance(scene, shape.get(ShapeFields::appearance, vrml::NodeId{}));
  const auto node_of = [&](vrml::NodeId id) { return id ? &scene.node(id) : nullptr; };
  nodes.appearance = node_of(parts.appearance);
  nodes.material = node_of(parts.material);
  nodes.texture = node_of(parts.texture);
  nodes.texture_transform = node_of(parts.texture_transform);
  const StyleNodes styles = style_nodes(scene, parts.appearance);
  nodes.line = styles.line.node;
  nodes.fill = styles.fill.node;
  nodes.point = styles.point.node;
  nodes.material_textures = nodes.material && has_textures(scene, *nodes.material);
  return nodes;
}

ShapeResources::StyleNodes ShapeResources::style_nodes(const vrml::SceneGraph& scene, vrml::NodeId appearance) {
  const NodeView view = schemas_.view(scene, appearance);
  if (view.kind() != NodeKind::appearance) return {};
  const auto node_in = [&](int field) { return schemas_.view(scene, view.get(field, vrml::NodeId{})); };
  return {node_in(AppearanceFields::line_properties), node_in(AppearanceFields::fill_properties),
          node_in(AppearanceFields::point_properties)};
}

// Returns null for the default style. Shapes with equal styles share one.
std::shared_ptr<const ShapeStyle> ShapeResources::style_use(const vrml::SceneGraph& scene, vrml::NodeId appearance) {
  const StyleNodes nodes = style_nodes(scene, appearance);
  if (!nodes.line && !nodes.fill && !nodes.point) return nullptr;
  const ShapeStyle style = style_of(nodes.line, nodes.fill, nodes.point);
  if (style == ShapeStyle{}) return nullptr;
  constexpr std::size_t kMostShared = 64;
  for (const auto& known : styles_)
    if (*known == style) return known;
  if (styles_.size() >= kMostShared) styles_.clear();
  return styles_.emplace_back(std::make_shared<const ShapeStyle>(style));
}

void ShapeResources::apply_appearance(DrawItem& item, const vrml::SceneGraph& scene, const NodeView& shape,
                                      const glm::vec3& scale) {
  item.material = {};
  item.texture = {};
  item.material.lit = false;
  item.material.diffuse = glm::vec3(1);
  const auto parts = vrml::parts_of_appearance(scene, shape.get(ShapeFields::appearance, vrml::NodeId{}));
  const NodeView material = schemas_.view(scene, parts.material);
  const NodeKind kind = material.kind();
  if (kind == NodeKind::material || kind == NodeKind::physical_material || kind == NodeKind::unlit_material ||
      kind == NodeKind::two_sided_material)
    item.material = material_of(material);
  item.texture = texture_use(scene, parts);
  item.style = style_use(scene, parts.appearance);
  item.layered = nullptr;
  if (!may_have_layers(scene, parts)) return;
  LayerBuilder builder(*this, scene, parts, geometry_of(scene, shape));
  if (builder.is_plain()) return;
  item.layered = keep(builder.build());
  if (!item.texture.image) item.texture = plain_texture(*item.layered);
  if (item.mesh) fit_layers(item, scale);
}

TextureUse ShapeResources::surface_texture(const vrml::Node& node, const qnv::IndexedMesh& mesh) const {
  TextureUse use;
  const auto given = images_.find(&node);
  if (given == images_.end() || !given->second || given->second->empty() || !mesh.picture) return use;
  use.image = given->second;
  use.repeat_s = mesh.picture->repeat_s;
  use.repeat_t = mesh.picture->repeat_t;
  return use;
}

TextureUse ShapeResources::texture_use(const vrml::SceneGraph& scene, const vrml::ShapeParts& parts) {
  TextureUse use;
  const NodeView texture = schemas_.view(scene, parts.texture);
  if (texture.kind() != NodeKind::image_texture && texture.kind() != NodeKind::movie_texture &&
      texture.kind() != NodeKind::pixel_texture)
    return use;
  use.image = image_of_texture(scene, parts.texture);
  if (!use.image) return use;
  use.repeat_s = texture.get(TextureFields::repeat_s, true);
  use.repeat_t = texture.get(TextureFields::repeat_t, true);
  if (has_properties(scene, texture)) use.sampling = sampling_of(schemas_, scene, texture);
  constexpr int kModern = 40;
  use.modulates = texture.node->text->version() >= kModern;
  const NodeView transform = schemas_.view(scene, parts.texture_transform);
  if (transform.kind() == NodeKind::texture_transform) use.transform = texture_matrix(transform);
  return use;
}

std::shared_ptr<const Image> ShapeResources::image_of_texture(const vrml::SceneGraph& scene, vrml::NodeId id) {
  const NodeView texture = schemas_.view(scene, id);
  const auto given = images_.find(texture.node);
  if (given != images_.end() && given->second && !given->second->empty()) return given->second;
  if (texture.kind() != NodeKind::pixel_texture) return nullptr;
  const auto* pixels = texture.find<vrml::SFImage>(TextureFields::image);
  if (!pixels || pixels->words.empty()) return nullptr;
  MeshCache::PixelEntry& entry = meshes_.pixel_images[texture.node];
  if (!entry.source.words.shares_with(pixels->words)) {
    entry.source = *pixels;
    entry.image = nullptr;
    entry.share = Share(budget_, Resource::pixels);
    if (!entry.share.grow(pixels->pixels().size() * (pixels->components() + kPixelCopy))) {
      report_limit("PixelTexture: " + budget_->refusal(Resource::pixels), scene, id);
      return nullptr;
    }
    Image image = image_of(*pixels);
    if (!image.empty()) entry.image = std::make_shared<const Image>(std::move(image));
  }
  return entry.image;
}

void ShapeResources::report_limit(const std::string& why, const vrml::SceneGraph& scene, vrml::NodeId node) {
  for (LimitReport& known : limit_reports_)
    if (known.why == why) {
      ++known.count;
      return;
    }
  const bool exists = scene.contains(node);
  limit_reports_.push_back({why, 1, scene.file_name(), exists ? scene.node(node).location : SourceLocation{}});
}

std::shared_ptr<const vrml::Mesh> ShapeResources::primitive(const vrml::SceneGraph& scene, vrml::NodeId geometry,
                                                            std::size_t fineness) {
  const vrml::Node& node = scene.node(geometry);
  std::string key = node.type->name;
  for (std::size_t i = 0; i < node.type->defaults.size(); ++i)
    if (const auto* flag = std::get_if<vrml::SFBool>(&node.values[i])) key += *flag ? '1' : '0';
  key += static_cast<char>('a' + fineness);
  if (const auto known = meshes_.primitives.find(key); known != meshes_.primitives.end()) return known->second;
  const PhaseScope phase(meshes_.phases, Phase::tessellate);
  vrml::MeshOptions options;
  options.default_measures = true;
  options.segments = kSegments[fineness];
  vrml::Mesh mesh = vrml::tessellate(scene, geometry, options);
  if (fineness > kCoarsestPrimitive) widen(mesh, outside_of_circle(kSegments[fineness]));
  if (fineness + 1 < kSegments.size()) {
    auto coarser = primitive(scene, geometry, fineness + 1);
    if (coarser->indices.size() < mesh.indices.size()) {
      // Deviation of the coarser polygon from a circle of radius 1, the radius of all default sizes.
      const int segments = kSegments[fineness + 1];
      const float outside = fineness + 1 > kCoarsestPrimitive ? outside_of_circle(segments) : 1;
      const float away = std::max(outside - 1, 1 - outside * std::cos(glm::pi<float>() / static_cast<float>(segments)));
      mesh.coarser_error = away / (glm::length(mesh.bounds.size()) / 2);
      mesh.coarser = std::move(coarser);
    }
  }
  return meshes_.primitives[key] = std::make_shared<const vrml::Mesh>(std::move(mesh));
}

// Returns the OutlineGroup that refines `geometry`. Searches each scene with OutlineGroups only once.
vrml::NodeId ShapeResources::refiner_of(const vrml::SceneGraph& scene, vrml::NodeId geometry) {
  constexpr vrml::NodeKind kOutlineGroup = vrml::NodeKind::outline_group;
  if (scene.node(geometry).type->read_as != kOutlineGroup) return {};
  const auto [at, fresh] = refiners_.try_emplace(&scene);
  for (std::uint32_t i = 1; fresh && i <= scene.nodes().count(); ++i) {
    const vrml::NodeId id = scene.nodes().id_at(i);
    if (scene.nodes().at(i).type->read_as != kOutlineGroup || scene.nodes().at(i).in_prototype_body) continue;
    if (const auto refined = scene.resolve_as(scene.get<vrml::SFNode>(id, "refines"), kOutlineGroup))
      at->second.emplace(refined.index, id);
  }
  const auto found = at->second.find(geometry.index);
  return found == at->second.end() ? vrml::NodeId{} : found->second;
}

std::shared_ptr<const vrml::Mesh> ShapeResources::mesh_of(const vrml::SceneGraph& scene, vrml::NodeId geometry,
                                                          bool textured) {
  MeshCache::Entry& entry = meshes_.meshes[&scene.node(geometry)];
  bring_up_to_date(entry, scene, geometry, textured, kCoarsestText);
  if (entry.refused) report_limit(budget_->refusal(Resource::meshes), scene, geometry);
  return entry.mesh;
}

ShapeResources::TextMesh ShapeResources::text_mesh_of(const vrml::SceneGraph& scene, vrml::NodeId geometry,
                                                      bool textured, std::size_t level) {
  std::shared_ptr<const vrml::Mesh> coarsest = mesh_of(scene, geometry, textured);
  constexpr auto kLast = static_cast<std::uint8_t>(kCoarsestText);
  if (level >= kCoarsestText || !coarsest || coarsest->empty()) return {std::move(coarsest), kLast};
  auto& finer = meshes_.meshes[&scene.node(geometry)].finer;
  if (!finer) finer = std::make_unique<MeshCache::FinerMeshes>();
  MeshCache::Entry& entry = finer->levels[level];
  bring_up_to_date(entry, scene, geometry, textured, level);
  if (!entry.mesh) {
    // Until the mesh is ready, use another level that is finer than the coarsest.
    for (std::size_t other = finer->levels.size(); other-- > 0;)
      if (finer->levels[other].mesh && !finer->levels[other].mesh->empty())
        return {finer->levels[other].mesh, static_cast<std::uint8_t>(other)};
    return {std::move(coarsest), kLast};
  }
  if (entry.mesh->empty()) return {std::move(coarsest), kLast};
  // Free unused levels. Otherwise they would fill memory when the viewer passes many texts.
  for (MeshCache::Entry& other : finer->levels)
    if (&other != &entry && other.mesh && other.mesh.use_count() == 1) other = {};
  return {entry.mesh, static_cast<std::uint8_t>(level)};
}

void ShapeResources::bring_up_to_date(MeshCache::Entry& entry, const vrml::SceneGraph& scene, vrml::NodeId geometry,
                                      bool textured, std::size_t text_level) {
  const bool coordinates = entry.job ? entry.job->options.texture_coordinates : entry.texture_coordinates;
  if (!entry.stale && (entry.job || entry.mesh) && (!textured || coordinates)) return;
  vrml::MeshOptions options;
  options.texture_coordinates = options.line_lengths = textured;
  options.refiner = refiner_of(scene, geometry);
  options.text_shaper = &system_fonts();
  options.text_level = text_level;
  entry.scene = &scene;
  LateMeshes* const late = meshes_.late.get();
  if (!late || late->has_time_for(vrml::tessellation_cost(scene, geometry)))
    return make_mesh(entry, scene, geometry, options);
  // Wait for the current job, and show its result. Otherwise a geometry that changes in each frame would never be
  // visible.
  if (entry.job) return;
  meshes_.made(&scene.node(geometry));
  entry.job = late->hand_over(scene, geometry, options, text_level);
  if (!entry.job) return make_mesh(entry, scene, geometry, options);
  entry.stale = false;
}

void ShapeResources::make_mesh(MeshCache::Entry& entry, const vrml::SceneGraph& scene, vrml::NodeId geometry,
                               const vrml::MeshOptions& options) {
  const PhaseScope phase(meshes_.phases, Phase::tessellate);
  entry.mesh = nullptr;
  entry.share = Share(budget_, Resource::meshes);
  entry.job = nullptr;
  entry.stale = false;
  auto mesh = std::make_shared<vrml::Mesh>(vrml::tessellate(scene, geometry, options));
  made_mesh_ = true;
  meshes_.made(&scene.node(geometry));
  MeshCache::keep(entry, std::move(mesh), budget_);
  entry.texture_coordinates = options.texture_coordinates;
}

std::size_t text_level(const vrml::Mesh& text, const glm::dmat4& world_from_node, const WideBox& bounds,
                       const glm::dvec3& viewer, const Sight& sight, bool pictures) {
  constexpr double kMaxPixels = 0.4;  // maximum deviation of outlines, in pixels
  constexpr double kMinLetters = 4;   // pixels per em below which small letters are unreadable
  const glm::dmat3 matrix(world_from_node);
  const double size = text.font_size * std::max(glm::length(matrix[0]), glm::length(matrix[1]));
  const glm::dvec3 nearest = bounds.empty() ? glm::dvec3(world_from_node[3])
                                            : glm::clamp(viewer, glm::dvec3(bounds.lower), glm::dvec3(bounds.upper));
  const bool parallel = sight.height > 0;
  const double distance = parallel ? 1 : glm::length(viewer - nearest),
               pixels = size * (parallel ? 1 / pixel_length(sight, 1) : double{pixels_per_radian(sight)});
  if (pixels <= kMinLetters * distance) return vrml::kTextBars;
  // Up to this size, a pixel of the glyph atlas is at most as large as a sample.
  constexpr double kMaxOfPictures = GlyphSheet::kPixelsPerEm / 2.0;
  if (pictures && pixels <= kMaxOfPictures * distance) return vrml::kTextPictures;
  std::size_t level = vrml::kTextPictures - 1;
  while (level > 0 && !(pixels * vrml::kTextTolerances[level] <= kMaxPixels * distance)) --level;
  return level;
}

}  // namespace gs::render
