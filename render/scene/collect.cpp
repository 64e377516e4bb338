#include "render/scene/collect_nodes.h"
#include "render/scene/collect_schema.h"
#include "render/scene/render_list.h"

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace gs::render {
namespace {

using glm::dmat4;
using glm::dvec3;

constexpr std::size_t kMaxLights = 60'000;  // DrawItem indexes them with 16 bits
constexpr std::size_t kMaxLightsOfAnItem = 16;
constexpr std::size_t kMaxViewpoints = 10'000;
constexpr std::size_t kMaxDepth = 100'000;
constexpr std::size_t kBetweenLooks = 1024;  // visits that make no mesh, at the time
// Segments of primitives, from fine to coarse: as many of these as make no more triangles than that, or the last.
constexpr std::array<int, 3> kSegments = {32, 16, 8};
constexpr std::size_t kManyTriangles = std::size_t{1} << 24;
// What a picture's pixels cost beside themselves: the copy of who draws, of 4 bytes each, and its smaller ones.
constexpr std::size_t kPixelCopy = 6;

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
  Collector(const Images& images, MeshCache& meshes, const glm::vec3& viewer, const Clouds& clouds,
            const BoundNodes* bound, std::shared_ptr<vrml::Budget> budget)
      : images_(images), meshes_(meshes), viewer_(viewer), clouds_(clouds), bound_(bound), budget_(std::move(budget)) {}

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
  void add_bindable(const NodeView& view, vrml::NodeId id, const Frame& parent);
  void add_shape(const Frame& parent, const NodeView& shape);
  void add_splats(const Frame& parent, const DrawItem& shape, const std::shared_ptr<const qnv::Cloud>& cloud,
                  float detail);
  TextureUse texture_use(const vrml::SceneGraph& scene, const NodeView& appearance);
  std::shared_ptr<const Image> image_of_texture(const vrml::SceneGraph& scene, vrml::NodeId texture);
  vrml::NodeId refiner_of(const vrml::SceneGraph& scene, vrml::NodeId geometry);
  std::shared_ptr<const vrml::Mesh> mesh_of(const vrml::SceneGraph& scene, vrml::NodeId geometry, bool textured);
  void make_mesh(MeshCache::Entry& entry, const vrml::SceneGraph& scene, vrml::NodeId geometry, bool textured);
  std::shared_ptr<const vrml::Mesh> primitive(const vrml::SceneGraph& scene, vrml::NodeId geometry,
                                              std::size_t fineness);
  bool has_room(const vrml::SceneGraph& scene, vrml::NodeId geometry, std::size_t triangles);
  void leave_out(const std::string& why, const vrml::SceneGraph& scene, vrml::NodeId node);
  void coarsen_primitives();
  [[nodiscard]] dvec3 viewer_in(const dmat4& world_from_local) const;

  const Images& images_;
  MeshCache& meshes_;
  dvec3 viewer_;
  const Clouds& clouds_;
  const BoundNodes* bound_;
  Schemas schemas_;
  RenderList list_;
  std::vector<ViewpointState> inlined_viewpoints_;
  bool have_navigation_ = false, have_background_ = false;
  std::vector<Frame> path_;
  std::unordered_map<const vrml::SceneGraph*, std::vector<bool>> open_nodes_;
  std::unordered_map<const vrml::SceneGraph*, std::unordered_map<std::uint32_t, vrml::NodeId>> refiners_;  // by index
  std::vector<std::uint16_t> active_lights_;
  std::size_t visits_ = 0;
  bool made_mesh_ = false;  // since the last look at the time
  std::shared_ptr<vrml::Budget> budget_;
  std::size_t triangles_ = 0;  // of all items, of primitives the coarsest ones
  // Primitives of which there are items, by their finest mesh.
  struct Primitives {
    std::array<std::shared_ptr<const vrml::Mesh>, kSegments.size()> meshes;
    std::size_t count = 0;
  };
  std::unordered_map<const vrml::Mesh*, Primitives> primitives_;
};

RenderList Collector::collect(const vrml::SceneGraph& scene) {
  auto& open = open_nodes_[&scene];
  open.resize(scene.node_count() + 1);
  enter({&scene, &open, 0, scene.roots().begin(), scene.roots().end(), dmat4(1), 0, true});
  bool stopped = false;
  while (!path_.empty()) {
    Frame& top = path_.back();
    if (top.next == top.end || stopped) {
      leave();
      continue;
    }
    if (++visits_ % kBetweenLooks == 0 || std::exchange(made_mesh_, false)) stopped = budget_->stopped();
    if (visits_ > budget_->limits().visits) {
      stopped = true;
      leave_out("more nodes, with all that USE multiplies, than the " + std::to_string(budget_->limits().visits) +
                    " that one picture may visit",
                *top.scene, *top.next);
      continue;
    }
    const vrml::NodeId id = *top.next++;
    visit(Frame(top), id);  // a copy: entering a group moves the path
  }
  coarsen_primitives();
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
      add_bindable(view, id, parent);
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

void Collector::add_bindable(const NodeView& view, vrml::NodeId id, const Frame& parent) {
  if (view.kind() == NodeKind::viewpoint) {
    auto& viewpoints = parent.main ? list_.viewpoints : inlined_viewpoints_;
    if (viewpoints.size() < kMaxViewpoints) {
      viewpoints.push_back(world_viewpoint(view, parent.world_from_local));
      viewpoints.back().scene = parent.scene;
      viewpoints.back().node = id;
    }
    return;
  }
  const bool background = view.kind() == NodeKind::background;
  // Bindable nodes of an Inline are not bound at start (VRML97 4.6.10).
  const bool counts = bound_ ? view.node == (background ? bound_->background : bound_->navigation_info) : parent.main;
  if (!counts || std::exchange(background ? have_background_ : have_navigation_, true)) return;
  if (background) {
    list_.background = world_background(view, parent.world_from_local);
  } else {
    list_.navigation = navigation_state(view);
  }
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
  dmat4 world_from_node = parent.world_from_local;
  if (const auto scale = vrml::scale_of_primitive(*parent.scene, geometry)) {
    item.mesh = primitive(*parent.scene, geometry, 0);
    world_from_node = glm::scale(world_from_node, dvec3(*scale));
    Primitives& all = primitives_[item.mesh.get()];
    for (std::size_t i = 0; all.count == 0 && i < kSegments.size(); ++i)
      all.meshes[i] = primitive(*parent.scene, geometry, i);
    if (!fits_float(world_from_node) || !has_room(*parent.scene, geometry, all.meshes.back()->indices.size() / 3))
      return;
    ++all.count;
  } else {
    item.mesh = mesh_of(*parent.scene, geometry, item.texture.image != nullptr);
    if (!item.mesh || item.mesh->empty() || !fits_float(world_from_node)) return;
    const std::size_t corners = item.mesh->primitive == vrml::Mesh::Primitive::triangles ? 3 : 1;
    if (!has_room(*parent.scene, geometry, item.mesh->indices.size() / corners)) return;
  }
  item.world_from_node = glm::mat4(world_from_node);
  const std::size_t lights = std::min(active_lights_.size(), kMaxLightsOfAnItem);
  item.directional_lights.assign(active_lights_.end() - static_cast<std::ptrdiff_t>(lights), active_lights_.end());
  const vrml::Bounds bounds = transformed(item.mesh->bounds, world_from_node);
  if (!bounds.empty() && std::isfinite(glm::dot(bounds.lower, bounds.upper) * 0.0f)) list_.bounds.add(bounds);
  list_.items.push_back(std::move(item));
}

void Collector::add_splats(const Frame& parent, const DrawItem& shape, const std::shared_ptr<const qnv::Cloud>& cloud,
                           float detail) {
  if ((cloud->empty() && !cloud->levels) || !fits_float(parent.world_from_local)) return;
  if (list_.splats.size() >= budget_->limit(vrml::Resource::items)) return;
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
  const auto id = appearance.get(AppearanceFields::texture, vrml::NodeId{});
  const NodeView texture = schemas_.view(scene, id);
  if (texture.kind() != NodeKind::image_texture && texture.kind() != NodeKind::pixel_texture) return use;
  use.image = image_of_texture(scene, id);
  if (!use.image) return use;
  use.repeat_s = texture.get(TextureFields::repeat_s, true);
  use.repeat_t = texture.get(TextureFields::repeat_t, true);
  const NodeView transform = schemas_.view(scene, appearance.get(AppearanceFields::texture_transform, vrml::NodeId{}));
  if (transform.kind() == NodeKind::texture_transform) use.transform = texture_matrix(transform);
  return use;
}

std::shared_ptr<const Image> Collector::image_of_texture(const vrml::SceneGraph& scene, vrml::NodeId id) {
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
    entry.share = vrml::Share(budget_, vrml::Resource::pixels);
    if (!entry.share.grow(pixels->pixels().size() * (pixels->components() + kPixelCopy))) {
      leave_out("PixelTexture: " + budget_->refusal(vrml::Resource::pixels), scene, id);
      return nullptr;
    }
    Image image = image_of(*pixels);
    if (!image.empty()) entry.image = std::make_shared<const Image>(std::move(image));
  }
  return entry.image;
}

void Collector::leave_out(const std::string& why, const vrml::SceneGraph& scene, vrml::NodeId node) {
  for (LeftOut& known : list_.left_out)
    if (known.why == why) {
      ++known.count;
      return;
    }
  const bool exists = scene.contains(node);
  list_.left_out.push_back({why, 1, scene.file_name(), exists ? scene.node(node).location : vrml::SourceLocation{}});
}

// USE and PROTO let a small file describe 2^n of anything.
bool Collector::has_room(const vrml::SceneGraph& scene, vrml::NodeId geometry, std::size_t triangles) {
  const std::size_t items = budget_->limit(vrml::Resource::items), most = budget_->limit(vrml::Resource::triangles);
  if (list_.items.size() >= items) {
    leave_out(budget_->refusal(vrml::Resource::items), scene, geometry);
    return false;
  }
  if (triangles > most - std::min(most, triangles_)) {
    leave_out(budget_->refusal(vrml::Resource::triangles), scene, geometry);
    return false;
  }
  triangles_ += triangles;
  return true;
}

std::shared_ptr<const vrml::Mesh> Collector::primitive(const vrml::SceneGraph& scene, vrml::NodeId geometry,
                                                       std::size_t fineness) {
  const vrml::Node& node = scene.node(geometry);
  std::string key = node.type->name;
  for (std::size_t i = 0; i < node.type->defaults.size(); ++i)
    if (const auto* flag = std::get_if<vrml::SFBool>(&node.values[i])) key += *flag ? '1' : '0';
  auto& mesh = meshes_.primitives[key += static_cast<char>('a' + fineness)];
  if (!mesh) {
    vrml::MeshOptions options;
    options.default_measures = true;
    options.segments = kSegments[fineness];
    mesh = std::make_shared<const vrml::Mesh>(vrml::tessellate(scene, geometry, options));
  }
  return mesh;
}

void Collector::coarsen_primitives() {
  std::size_t fineness = 0;
  for (; fineness + 1 < kSegments.size(); ++fineness) {
    std::size_t triangles = 0;
    for (const auto& [finest, all] : primitives_) triangles += all.count * (all.meshes[fineness]->indices.size() / 3);
    if (triangles <= kManyTriangles) break;
  }
  if (fineness == 0) return;
  for (DrawItem& item : list_.items)
    if (const auto known = primitives_.find(item.mesh.get()); known != primitives_.end())
      item.mesh = known->second.meshes[fineness];
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
  if (!entry.mesh || (textured && !entry.texture_coordinates)) make_mesh(entry, scene, geometry, textured);
  if (entry.refused) leave_out(budget_->refusal(vrml::Resource::meshes), scene, geometry);
  return entry.mesh;
}

void Collector::make_mesh(MeshCache::Entry& entry, const vrml::SceneGraph& scene, vrml::NodeId geometry,
                          bool textured) {
  vrml::MeshOptions options;
  options.texture_coordinates = textured;
  options.refiner = refiner_of(scene, geometry);
  entry.mesh = nullptr;
  entry.share = vrml::Share(budget_, vrml::Resource::meshes);
  auto mesh = std::make_shared<vrml::Mesh>(vrml::tessellate(scene, geometry, options));
  made_mesh_ = true;
  // One that there is no room for is not tried again for every USE.
  if (!entry.share.grow(mesh->cost())) {
    *mesh = {};
    mesh->left_out = true;
  }
  entry.refused = mesh->left_out && !budget_->stopped();
  entry.mesh = std::move(mesh);
  entry.texture_coordinates = textured;
}

}  // namespace

RenderList collect(const vrml::SceneGraph& scene, const Images& images, MeshCache& meshes, const glm::vec3& viewer,
                   const Clouds& clouds, const BoundNodes* bound) {
  const bool usable = std::isfinite(viewer.x) && std::isfinite(viewer.y) && std::isfinite(viewer.z);
  return Collector(images, meshes, usable ? viewer : glm::vec3(0, 0, 10), clouds, bound, scene.budget()).collect(scene);
}

}  // namespace gs::render
