#include "render/collect_nodes.h"
#include "render/collect_schema.h"
#include "render/render_list.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace gs::render {
namespace {

using glm::dmat4;
using glm::dvec3;

// USE lets a small file describe 2^n of anything.
constexpr std::size_t kMaxVisits = 20'000'000;
constexpr std::size_t kMaxItems = 2'000'000;
constexpr std::size_t kMaxLights = 60'000;  // DrawItem indexes them with 16 bits
constexpr std::size_t kMaxLightsOfAnItem = 16;
constexpr std::size_t kMaxViewpoints = 10'000;
constexpr std::size_t kMaxDepth = 100'000;

bool fits_float(const dmat4& m) {
  double sum = 0;
  for (int i = 0; i < 4; ++i) sum += std::abs(m[i].x) + std::abs(m[i].y) + std::abs(m[i].z);
  return sum < std::numeric_limits<float>::max();  // false for NaN too
}

vrml::Bounds transformed(const vrml::Bounds& bounds, const dmat4& matrix) {
  vrml::Bounds result;
  if (bounds.empty()) return result;
  const dvec3 center = (dvec3(bounds.lower) + dvec3(bounds.upper)) * 0.5,
              half = (dvec3(bounds.upper) - dvec3(bounds.lower)) * 0.5;
  const dvec3 moved(matrix * glm::dvec4(center, 1));
  dvec3 extent(0);
  for (int i = 0; i < 3; ++i) extent += glm::abs(dvec3(matrix[i])) * half[i];
  result.lower = glm::vec3(moved - extent);
  result.upper = glm::vec3(moved + extent);
  return result;
}

class Collector {
 public:
  Collector(const Images& images, MeshCache& meshes, const glm::vec3& viewer, const Clouds& clouds)
      : images_(images), meshes_(meshes), viewer_(viewer), clouds_(clouds) {}

  RenderList collect(const vrml::SceneGraph& scene);

 private:
  /// One grouping node on the way down, or the roots of a scene.
  struct Frame {
    const vrml::SceneGraph* scene;
    std::vector<bool>* on_path;  // of the scene: the nodes that are open now
    std::uint32_t node;          // index of the open node; 0 for roots
    const vrml::NodeId* next;
    const vrml::NodeId* end;
    dmat4 world_from_local;
    std::size_t lights_outside;  // how many of active_lights_ hold outside of this group
    bool main;                   // not inside an Inline
  };

  void enter(Frame frame);
  void enter_node(const Frame& parent, vrml::NodeId id, const vrml::MFNode* children, const dmat4& world_from_local);
  void enter_choice(const Frame& parent, vrml::NodeId id, const vrml::MFNode* choices, std::int64_t which);
  void enter_inline(const Frame& parent, vrml::NodeId id);
  void leave();
  void visit(const Frame& parent, vrml::NodeId id);
  void add_light(const NodeView& light, const dmat4& world_from_local, bool directional);
  void add_bindable(const NodeView& view, const Frame& parent);
  void add_shape(const Frame& parent, const NodeView& shape);
  void add_splats(const Frame& parent, const DrawItem& shape, const std::shared_ptr<const qnv::Cloud>& cloud,
                  float detail);
  TextureUse texture_use(const vrml::SceneGraph& scene, const NodeView& appearance);
  std::shared_ptr<const Image> image_of_texture(const NodeView& texture);
  vrml::NodeId refiner_of(const vrml::SceneGraph& scene, vrml::NodeId geometry);
  std::shared_ptr<const vrml::Mesh> mesh_of(const vrml::SceneGraph& scene, vrml::NodeId geometry, bool textured);
  [[nodiscard]] dvec3 viewer_in(const dmat4& world_from_local) const;

  const Images& images_;
  MeshCache& meshes_;
  dvec3 viewer_;
  const Clouds& clouds_;
  Schemas schemas_;
  RenderList list_;
  std::vector<ViewpointState> inlined_viewpoints_;
  bool have_navigation_ = false, have_background_ = false;
  std::vector<Frame> path_;
  std::unordered_map<const vrml::SceneGraph*, std::vector<bool>> open_nodes_;
  std::unordered_map<const vrml::SceneGraph*, std::unordered_map<std::uint32_t, vrml::NodeId>> refiners_;  // by index
  std::vector<std::uint16_t> active_lights_;
  std::size_t visits_ = 0;
};

RenderList Collector::collect(const vrml::SceneGraph& scene) {
  auto& open = open_nodes_[&scene];
  open.resize(scene.node_count() + 1);
  enter({&scene, &open, 0, scene.roots().begin(), scene.roots().end(), dmat4(1), 0, true});
  while (!path_.empty()) {
    Frame& top = path_.back();
    if (top.next == top.end || visits_ >= kMaxVisits || list_.items.size() >= kMaxItems) {
      leave();
      continue;
    }
    ++visits_;
    const vrml::NodeId id = *top.next++;
    visit(Frame(top), id);  // a copy: entering a group moves the path
  }
  for (ViewpointState& viewpoint : inlined_viewpoints_) list_.viewpoints.push_back(std::move(viewpoint));
  return std::move(list_);
}

void Collector::enter(Frame frame) {
  if (path_.size() >= kMaxDepth) return;
  frame.lights_outside = active_lights_.size();
  if (frame.node) (*frame.on_path)[frame.node] = true;
  // A DirectionalLight lights its siblings, whichever come first (VRML97 6.16).
  for (const vrml::NodeId* child = frame.next; child != frame.end; ++child) {
    const NodeView view = schemas_.view(*frame.scene, *child);
    if (view.kind() == NodeKind::directional_light) add_light(view, frame.world_from_local, true);
  }
  path_.push_back(frame);
}

void Collector::leave() {
  const Frame& top = path_.back();
  if (top.node) (*top.on_path)[top.node] = false;
  active_lights_.resize(top.lights_outside);
  path_.pop_back();
}

void Collector::enter_node(const Frame& parent, vrml::NodeId id, const vrml::MFNode* children,
                           const dmat4& world_from_local) {
  if (!children || children->empty() || !fits_float(world_from_local)) return;
  enter({parent.scene, parent.on_path, id.index, children->begin(), children->end(), world_from_local, 0, parent.main});
}

void Collector::enter_choice(const Frame& parent, vrml::NodeId id, const vrml::MFNode* choices, std::int64_t which) {
  if (!choices || which < 0 || which >= static_cast<std::int64_t>(choices->size())) return;
  const vrml::NodeId* chosen = choices->begin() + which;
  enter({parent.scene, parent.on_path, id.index, chosen, chosen + 1, parent.world_from_local, 0, parent.main});
}

void Collector::enter_inline(const Frame& parent, vrml::NodeId id) {
  const vrml::SceneGraph* inlined = parent.scene->inlined(id);
  if (!inlined || inlined->roots().empty()) return;
  const auto [open, fresh] = open_nodes_.try_emplace(inlined);
  if (fresh) open->second.resize(inlined->node_count() + 1);
  enter(
      {inlined, &open->second, 0, inlined->roots().begin(), inlined->roots().end(), parent.world_from_local, 0, false});
}

dvec3 Collector::viewer_in(const dmat4& world_from_local) const {
  const dvec3 local(glm::inverse(world_from_local) * glm::dvec4(viewer_, 1));
  return std::isfinite(local.x + local.y + local.z) ? local : dvec3(0);
}

void Collector::visit(const Frame& parent, vrml::NodeId id) {
  id = parent.scene->resolve(id);
  if (!id || (*parent.on_path)[id.index]) return;
  const vrml::Node& node = parent.scene->node(id);
  const NodeView view{&node, &schemas_.of(*node.type)};
  const dmat4& world = parent.world_from_local;
  switch (view.kind()) {
    case NodeKind::shape:
      add_shape(parent, view);
      break;
    case NodeKind::group:
      enter_node(parent, id, view.find<vrml::MFNode>(GroupFields::children), world);
      break;
    case NodeKind::transform:
      enter_node(parent, id, view.find<vrml::MFNode>(TransformFields::children), world * transform_matrix(view));
      break;
    case NodeKind::billboard:
      enter_node(parent, id, view.find<vrml::MFNode>(BillboardFields::children),
                 world * billboard_matrix(view, viewer_in(world)));
      break;
    case NodeKind::switch_node:
      enter_choice(parent, id, view.find<vrml::MFNode>(SwitchFields::choice),
                   view.get<vrml::SFInt32>(SwitchFields::which_choice, -1));
      break;
    case NodeKind::lod:
      enter_choice(parent, id, view.find<vrml::MFNode>(LodFields::level), lod_level(view, viewer_in(world)));
      break;
    case NodeKind::inline_node:
      enter_inline(parent, id);
      break;
    case NodeKind::point_light:
    case NodeKind::spot_light:
      add_light(view, world, false);
      break;
    case NodeKind::viewpoint:
    case NodeKind::navigation_info:
    case NodeKind::background:
      add_bindable(view, parent);
      break;
    default:
      break;  // DirectionalLights were seen by enter()
  }
}

void Collector::add_light(const NodeView& light, const dmat4& world_from_local, bool directional) {
  if (!light.get(LightFields::on, true) || list_.lights.size() >= kMaxLights) return;
  if (directional) active_lights_.push_back(static_cast<std::uint16_t>(list_.lights.size()));
  list_.lights.push_back(world_light(light, world_from_local));
}

void Collector::add_bindable(const NodeView& view, const Frame& parent) {
  if (view.kind() == NodeKind::viewpoint) {
    auto& viewpoints = parent.main ? list_.viewpoints : inlined_viewpoints_;
    if (viewpoints.size() < kMaxViewpoints) viewpoints.push_back(world_viewpoint(view, parent.world_from_local));
    return;
  }
  // Bindable nodes of an Inline are not bound at start (VRML97 4.6.10).
  if (!parent.main) return;
  if (view.kind() == NodeKind::background && !std::exchange(have_background_, true))
    list_.background = world_background(view, parent.world_from_local);
  if (view.kind() == NodeKind::navigation_info && !std::exchange(have_navigation_, true))
    list_.navigation = navigation_state(view);
}

void Collector::add_shape(const Frame& parent, const NodeView& shape) {
  const vrml::NodeId geometry = parent.scene->resolve(shape.get(ShapeFields::geometry, vrml::NodeId{}));
  if (!geometry) return;
  DrawItem item;
  item.material.lit = false;
  item.material.diffuse = glm::vec3(1);
  const NodeView appearance = schemas_.view(*parent.scene, shape.get(ShapeFields::appearance, vrml::NodeId{}));
  if (appearance.kind() == NodeKind::appearance) {
    const NodeView material = schemas_.view(*parent.scene, appearance.get(AppearanceFields::material, vrml::NodeId{}));
    if (material.kind() == NodeKind::material) item.material = material_of(material);
    item.texture = texture_use(*parent.scene, appearance);
  }
  if (const auto cloud = clouds_.find(&parent.scene->node(geometry)); cloud != clouds_.end() && cloud->second) {
    add_splats(parent, item, cloud->second, detail_of(schemas_.view(*parent.scene, geometry)));
    return;
  }
  item.mesh = mesh_of(*parent.scene, geometry, item.texture.image != nullptr);
  if (!item.mesh || item.mesh->empty() || !fits_float(parent.world_from_local)) return;
  item.world_from_node = glm::mat4(parent.world_from_local);
  const std::size_t lights = std::min(active_lights_.size(), kMaxLightsOfAnItem);
  item.directional_lights.assign(active_lights_.end() - static_cast<std::ptrdiff_t>(lights), active_lights_.end());
  const vrml::Bounds bounds = transformed(item.mesh->bounds, parent.world_from_local);
  if (!bounds.empty() && std::isfinite(glm::dot(bounds.lower, bounds.upper) * 0.0f)) list_.bounds.add(bounds);
  list_.items.push_back(std::move(item));
}

void Collector::add_splats(const Frame& parent, const DrawItem& shape, const std::shared_ptr<const qnv::Cloud>& cloud,
                           float detail) {
  if ((cloud->empty() && !cloud->levels) || !fits_float(parent.world_from_local)) return;
  SplatItem item;
  item.cloud = cloud;
  item.world_from_node = glm::mat4(parent.world_from_local);
  // Discs have normals, so they are lit even where no Material asks for it.
  item.own_color = !shape.material.lit;
  item.material = item.own_color ? Material{} : shape.material;
  item.detail = detail;
  const std::size_t lights = std::min(active_lights_.size(), kMaxLightsOfAnItem);
  item.directional_lights.assign(active_lights_.end() - static_cast<std::ptrdiff_t>(lights), active_lights_.end());
  const qnv::Box& box = cloud->description.box;
  const vrml::Bounds bounds = transformed({box.lower, box.upper}, parent.world_from_local);
  if (!bounds.empty() && std::isfinite(glm::dot(bounds.lower, bounds.upper) * 0.0f)) list_.bounds.add(bounds);
  list_.splats.push_back(std::move(item));
}

TextureUse Collector::texture_use(const vrml::SceneGraph& scene, const NodeView& appearance) {
  TextureUse use;
  const NodeView texture = schemas_.view(scene, appearance.get(AppearanceFields::texture, vrml::NodeId{}));
  if (texture.kind() != NodeKind::image_texture && texture.kind() != NodeKind::pixel_texture) return use;
  use.image = image_of_texture(texture);
  if (!use.image) return use;
  use.repeat_s = texture.get(TextureFields::repeat_s, true);
  use.repeat_t = texture.get(TextureFields::repeat_t, true);
  const NodeView transform = schemas_.view(scene, appearance.get(AppearanceFields::texture_transform, vrml::NodeId{}));
  if (transform.kind() == NodeKind::texture_transform) use.transform = texture_matrix(transform);
  return use;
}

std::shared_ptr<const Image> Collector::image_of_texture(const NodeView& texture) {
  const auto given = images_.find(texture.node);
  if (given != images_.end() && given->second && !given->second->empty()) return given->second;
  if (texture.kind() != NodeKind::pixel_texture) return nullptr;
  const auto* pixels = texture.find<vrml::SFImage>(TextureFields::image);
  if (!pixels || pixels->words.empty()) return nullptr;
  MeshCache::PixelEntry& entry = meshes_.pixel_images[texture.node];
  if (!entry.source.words.shares_with(pixels->words)) {
    Image image = image_of(*pixels);
    entry.source = *pixels;
    entry.image = image.empty() ? nullptr : std::make_shared<const Image>(std::move(image));
  }
  return entry.image;
}

// Type and measures of a geometry that a few numbers describe wholly; empty for any other.
std::string primitive_key(const vrml::Node& node) {
  std::string key;
  for (std::size_t i = 0; i < node.type->defaults.size(); ++i) {
    const bool plain = std::visit(
        [&key](const auto& value) {
          using T = std::decay_t<decltype(value)>;
          constexpr bool kPlain =
              std::is_same_v<T, vrml::SFFloat> || std::is_same_v<T, vrml::SFBool> || std::is_same_v<T, vrml::SFVec3f>;
          if constexpr (kPlain) key.append(reinterpret_cast<const char*>(&value), sizeof value);
          return kPlain;
        },
        node.values[i]);
    if (!plain) return {};
  }
  return key.empty() ? key : key + node.type->name;
}

// The OutlineGroup that says that it refines this one. Scenes with such nodes are looked through once.
vrml::NodeId Collector::refiner_of(const vrml::SceneGraph& scene, vrml::NodeId geometry) {
  static const vrml::NodeType* const kOutlineGroup = vrml::built_in_node_type("OutlineGroup");
  if (scene.node(geometry).type != kOutlineGroup) return {};
  const auto [at, fresh] = refiners_.try_emplace(&scene);
  for (std::uint32_t i = 1; fresh && i <= scene.node_count(); ++i) {
    const vrml::NodeId id = scene.id_at(i);
    if (scene.node(id).type != kOutlineGroup || scene.node(id).in_prototype_body) continue;
    if (const auto refined = scene.resolve_as(scene.get<vrml::SFNode>(id, "refines"), "OutlineGroup"))
      at->second.emplace(refined.index, id);
  }
  const auto found = at->second.find(geometry.index);
  return found == at->second.end() ? vrml::NodeId{} : found->second;
}

std::shared_ptr<const vrml::Mesh> Collector::mesh_of(const vrml::SceneGraph& scene, vrml::NodeId geometry,
                                                     bool textured) {
  MeshCache::Entry& entry = meshes_.meshes[&scene.node(geometry)];
  if (!entry.mesh || (textured && !entry.texture_coordinates)) {
    const std::string key = primitive_key(scene.node(geometry));
    std::weak_ptr<const vrml::Mesh>* shared = key.empty() ? nullptr : &meshes_.primitives[key];
    if (shared && (entry.mesh = shared->lock())) {
      entry.texture_coordinates = true;  // primitives always have them
      return entry.mesh;
    }
    vrml::MeshOptions options;
    options.texture_coordinates = textured || shared;
    options.refiner = refiner_of(scene, geometry);
    entry.mesh = std::make_shared<const vrml::Mesh>(vrml::tessellate(scene, geometry, options));
    entry.texture_coordinates = options.texture_coordinates;
    if (shared) *shared = entry.mesh;
  }
  return entry.mesh;
}

}  // namespace

RenderList collect(const vrml::SceneGraph& scene, const Images& images, MeshCache& meshes, const glm::vec3& viewer,
                   const Clouds& clouds) {
  const bool usable = std::isfinite(viewer.x) && std::isfinite(viewer.y) && std::isfinite(viewer.z);
  return Collector(images, meshes, usable ? viewer : glm::vec3(0, 0, 10), clouds).collect(scene);
}

}  // namespace gs::render
