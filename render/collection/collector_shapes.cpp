// Part of Collector for Shapes: their drawable content and its limits.
#include "render/collection/collector.h"
#include "render/scene/surface_mesh.h"

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <utility>

namespace gs::render {
namespace {

using glm::dmat4;
using glm::dvec3;

/// Prepares the part of a QNV surface with a texture if `pictured`, otherwise the part without a texture.
void prepare_surface(ShapeResources& resources, const vrml::Node& geometry, bool pictured, DrawItem& item) {
  item.mesh = resources.surface_mesh(item.surface, pictured);
  dress_surface(item);
  const auto* mesh = item.surface->as<qnv::IndexedMesh>();
  if (pictured && mesh) item.texture = resources.surface_texture(geometry, *mesh);
}

}  // namespace

dmat4 world_from_geometry(const dmat4& world_from_node, const qnv::Geometry& geometry) {
  const dvec3& origin = geometry.description().origin;
  return origin == dvec3(0) ? world_from_node : glm::translate(world_from_node, origin);
}

dmat4 world_from_mesh(const dmat4& world_from_node, const vrml::Mesh& mesh) {
  return mesh.origin == dvec3(0) ? world_from_node : glm::translate(world_from_node, mesh.origin);
}

void Collector::add_shape(const Frame& parent, vrml::NodeId id, const NodeView& shape) {
  const vrml::NodeId geometry = geometry_of(*parent.scene, shape);
  if (!geometry) return;
  DrawItem item;
  resources_.apply_appearance(item, *parent.scene, shape);
  RenderSources::Item source;
  source.geometry = &parent.scene->node(geometry);
  source.appearance = resources_.appearance_nodes(*parent.scene, shape);
  const auto found = geometries_.find(source.geometry);
  const auto stream = found != geometries_.end() ? found->second : nullptr;
  const auto* mesh = stream ? stream->as<qnv::IndexedMesh>() : nullptr;
  if (stream && !mesh && !stream->as<qnv::SurfacePatches>()) {
    add_splats(parent, id, item, stream, detail_of(schemas_.view(*parent.scene, geometry)), source);
    return;
  }
  dmat4 world_from_node = parent.world_from_local;
  if (stream) {
    if (mesh && mesh->triangles.empty()) return;
    item.surface = stream;
    world_from_node = world_from_geometry(world_from_node, *stream);
    item.detail = detail_of(schemas_.view(*parent.scene, geometry));
    if (!fits_float(world_from_node)) return;
    const bool pictured = mesh && !mesh->texture_coordinates.empty();
    if (pictured && mesh->first_textured() > 0) {
      DrawItem other = item;
      prepare_surface(resources_, *source.geometry, false, other);
      if (!room_.take_item(list_, other.mesh->indices.size() / 3, *parent.scene, geometry)) return;
      add_item(parent, id, geometry, std::move(other), source, world_from_node);
    }
    prepare_surface(resources_, *source.geometry, pictured, item);
    if (!room_.take_item(list_, item.mesh->indices.size() / 3, *parent.scene, geometry)) return;
  } else if (const auto scale = vrml::scale_of_primitive(*parent.scene, geometry)) {
    item.mesh = resources_.primitive(*parent.scene, geometry, 0);
    source.scale = *scale;
    world_from_node = glm::scale(world_from_node, dvec3(*scale));
    if (!fits_float(world_from_node) || !room_.take_primitive(list_, item.mesh, *parent.scene, geometry)) return;
  } else {
    // The texture may not be loaded yet, so test the node, not the image.
    item.mesh = resources_.mesh_of(*parent.scene, geometry, source.appearance.need_coordinates());
    if (item.mesh) world_from_node = world_from_mesh(world_from_node, *item.mesh);
    if (!item.mesh || item.mesh->empty() || !fits_float(world_from_node)) {
      if (sources_) sources_->unshown.push_back({source.geometry, parent.scene});
      return;
    }
    const std::size_t corners = item.mesh->primitive == vrml::Mesh::Primitive::triangles ? 3 : 1;
    if (!room_.take_item(list_, item.mesh->indices.size() / corners, *parent.scene, geometry)) return;
  }
  if (item.mesh->in_points) return add_screen_text(parent, id, geometry, std::move(item), source);
  add_item(parent, id, geometry, std::move(item), source, world_from_node);
}

// Adds a Text with a ScreenFontStyle, in a coordinate system with points of the screen as units (X3D 36.4.5).
void Collector::add_screen_text(const Frame& parent, vrml::NodeId id, vrml::NodeId geometry, DrawItem item,
                                const RenderSources::Item& source) {
  const Screen& screen = screens_.of(parent.presence.overlay);
  const dmat4 local = screen.in_pixels(parent.world_from_local, screen.pixels_per_point());
  Frame frame = parent;
  frame.world_from_local = parent.world_from_local * local;
  if (!fits_float(frame.world_from_local)) {
    if (sources_) sources_->unshown.push_back({source.geometry, parent.scene});
    return;
  }
  const std::size_t number = list_.world_from_frame.size();
  if (number < kMaxPlaces)
    begin_frame(frame, parent, parent.scene->node(id), local, true);
  else if (sources_)
    sources_->complete = false;
  const dmat4 world_from_node = world_from_mesh(frame.world_from_local, *item.mesh);
  add_item(frame, id, geometry, std::move(item), source, world_from_node);
  if (!sources_ || frame.frame != number) return;
  RenderSources::Frame& made = sources_->frames[number];
  made.end = static_cast<std::uint32_t>(number + 1);
  made.end_item = static_cast<std::uint32_t>(list_.items.size());
  made.end_splat = made.first_splat;
  made.end_light = made.first_light;
}

void Collector::add_item(const Frame& parent, vrml::NodeId id, vrml::NodeId geometry, DrawItem item,
                         RenderSources::Item source, const dmat4& world_from_node) {
  item.world_from_node = world_from_node;
  item.directional_lights = scoped_.lights();
  item.clip_planes = clip_planes(parent.presence);
  item.local_fog = parent.presence.local_fog;
  item.place = add_place(parent, id);
  source.bounds = world_bounds(source.region.empty() ? item.mesh->bounds : source.region, world_from_node);
  if (item.mesh->font_size > 0) {
    const std::size_t level = text_level(*item.mesh, item.world_from_node, source.bounds, viewer_, sight_,
                                         sources_ && !source.appearance.textured());
    auto [mesh, made] = resources_.text_mesh_of(*parent.scene, geometry, source.appearance.need_coordinates(), level);
    source.text_level = ShapeResources::kCoarsestText;
    // If the image has no room for the finer mesh, keep the coarsest.
    if (mesh == item.mesh || room_.take_triangles(mesh->indices.size() / 3)) {
      item.mesh = std::move(mesh);
      source.bounds = world_bounds(item.mesh->bounds, world_from_node);
      source.text_level = made;
    }
    if (sources_) sources_->texts.push_back(static_cast<std::uint32_t>(list_.items.size()));
  }
  if (item.layered) resources_.fit_layers(item, source.scale);
  item.overlay = parent.presence.overlay;
  item.visible = parent.presence.visible;
  // Text, lines and points do not collide (VRML97 6.8, 6.47), nor do volumes.
  item.collidable = parent.presence.collidable && item.touchable && !item.overlay && !item.volume &&
                    item.mesh->font_size == 0 && item.mesh->primitive == vrml::Mesh::Primitive::triangles;
  list_.overlays = list_.overlays || item.overlay;
  if (item.visible && !item.overlay && !source.bounds.empty()) list_.bounds.add(source.bounds);
  const std::uint32_t place = item.place;
  list_.items.push_back(std::move(item));
  if (sources_) sources_->items.push_back(source);
  const vrml::Node& shape = parent.scene->node(id);
  const NodeView view{&shape, &schemas_.of(*shape.type)};
  if (view.flag(view.schema->box_display, false))
    add_box(shape, parent.world_from_local, list_.items.size() - 1, place, parent.presence);
}

void Collector::add_splats(const Frame& parent, vrml::NodeId id, const DrawItem& shape,
                           const std::shared_ptr<const qnv::Geometry>& splats, float detail,
                           const RenderSources::Item& source) {
  const dmat4 world = world_from_geometry(parent.world_from_local, *splats);
  // The vectors of some streams depend on the view, and the first bytes may have none.
  const auto* const volume = splats->as<qnv::Volume>();
  const auto* const gaussians = splats->as<qnv::Gaussians>();
  const bool shown = splats->as<qnv::OctreeSplats>() || splats->size() > 0 || (volume && volume->detail) ||
                     (gaussians && gaussians->stream);
  if (!shown || !fits_float(world)) return;
  if (list_.splats.size() >= budget_->limit(Resource::items)) return;
  SplatItem item;
  item.geometry = splats;
  item.world_from_node = world;
  // Splats have normals, so light them even without a Material.
  item.own_color = !shape.material.lit;
  item.material = item.own_color ? Material{} : shape.material;
  item.detail = detail;
  item.directional_lights = scoped_.lights();
  item.clip_planes = clip_planes(parent.presence);
  item.place = add_place(parent, id);
  const Box& box = splats->description().box;
  RenderSources::Item kept = source;
  kept.bounds = world_bounds({box.lower, box.upper}, world);
  if (!kept.bounds.empty()) list_.bounds.add(kept.bounds);
  list_.splats.push_back(std::move(item));
  if (sources_) sources_->splats.push_back(kept);
}

}  // namespace gs::render
