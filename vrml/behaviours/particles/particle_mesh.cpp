#include "vrml/behaviours/particles/particle_mesh.h"

#include "vrml/behaviours/animation/interpolation.h"
#include "vrml/behaviours/particles/particle_simulation.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string_view>
#include <vector>

namespace gs::vrml {
namespace {

using Corners = std::array<glm::vec2, 4>;
constexpr Corners kWholeTexture = {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1), glm::vec2(0, 1)};

template <class T>
const T* system_field(const SceneGraph& scene, NodeId node, std::string_view name) {
  const InterfaceDeclaration* const field = scene.node(node).type->find_field(name);
  return field ? std::get_if<T>(&scene.node(node).values[field->slot]) : nullptr;
}

template <class T>
const T* property_field(const SceneGraph& scene, NodeId system, std::string_view property, std::string_view name) {
  const SFNode* const given = system_field<SFNode>(scene, system, property);
  const NodeId node = given ? scene.resolve(*given) : NodeId{};
  return node ? system_field<T>(scene, node, name) : nullptr;
}

/// Keys of a ramp over the life of a particle. The standard counts them in seconds. Keys up to 1 are fractions of the
/// lifetime if it is longer than 1 s or shorter than the last key, as in X_ITE.
class RampKeys {
 public:
  RampKeys(const SceneGraph& scene, NodeId system, std::string_view field, std::size_t values) {
    if (const MFFloat* const keys = system_field<MFFloat>(scene, system, field))
      keys_ = std::span(keys->begin(), std::min(keys->size(), values));
    const SFFloat* const lifetime = system_field<SFFloat>(scene, system, "particleLifetime");
    if (keys_.empty() || !lifetime) return;
    fractions_ = keys_.back() <= 1 && (*lifetime > 1 || keys_.back() > *lifetime);
  }
  [[nodiscard]] std::span<const float> keys() const { return keys_; }
  /// Returns the time of a particle in the unit of the keys.
  [[nodiscard]] float time_of(const ShownParticle& one) const { return fractions_ ? one.age / one.lifetime : one.age; }

 private:
  std::span<const float> keys_;
  bool fractions_ = false;
};

struct ParticleColor {
  Color color;
  float opacity = 1;
};

/// Colours of particles over time: fields color and colorKey. Tabulated, because the interpolation is in HSV space.
class ColorRamp {
 public:
  ColorRamp(const SceneGraph& scene, NodeId system)
      : colors_(property_field<MFColor>(scene, system, "color", "color")),
        with_opacity_(property_field<MFColorRGBA>(scene, system, "color", "color")),
        keys_(scene, system, "colorKey", count()) {
    if (count() == 0) return;
    const std::span<const float> keys = keys_.keys();
    if (keys.size() < 2 || !(keys.back() > keys.front())) {
      table_.assign(1, color_at(0));
      return;
    }
    first_ = keys.front();
    per_second_ = (kEntries - 1) / (keys.back() - keys.front());
    for (int i = 0; i < kEntries; ++i) {
      const KeyPlace place = find_key(keys, first_ + static_cast<float>(i) / per_second_);
      const ParticleColor a = color_at(place.first), b = color_at(place.second);
      table_.push_back(
          {between_colors(a.color, b.color, place.part), a.opacity + (b.opacity - a.opacity) * place.part});
    }
  }
  [[nodiscard]] bool empty() const { return table_.empty(); }
  [[nodiscard]] bool has_opacity() const { return with_opacity_ && !with_opacity_->empty(); }
  [[nodiscard]] const ParticleColor& of(const ShownParticle& one) const {
    const float place = (keys_.time_of(one) - first_) * per_second_ + 0.5F;
    const auto last = static_cast<float>(table_.size() - 1);
    return table_[static_cast<std::size_t>(std::fmin(std::fmax(place, 0.0F), last))];
  }

 private:
  static constexpr int kEntries = 256;
  [[nodiscard]] std::size_t count() const {
    return with_opacity_ ? with_opacity_->size() : colors_ ? colors_->size() : 0;
  }
  [[nodiscard]] ParticleColor color_at(std::size_t i) const {
    if (!with_opacity_) return {(*colors_)[i], 1};
    const ColorRGBA& one = (*with_opacity_)[i];
    return {{one.r, one.g, one.b}, std::clamp(one.a, 0.0F, 1.0F)};
  }

  const MFColor* colors_;
  const MFColorRGBA* with_opacity_;
  RampKeys keys_;
  float first_ = 0, per_second_ = 0;
  std::vector<ParticleColor> table_;
};

/// Texture coordinates over time: fields texCoord and texCoordKey. There is no interpolation between keys.
class CoordinateRamp {
 public:
  CoordinateRamp(const SceneGraph& scene, NodeId system, std::size_t corners)
      : points_(property_field<MFVec2f>(scene, system, "texCoord", "point")),
        corners_(corners),
        keys_(scene, system, "texCoordKey", points_ ? points_->size() / corners : 0) {}

  [[nodiscard]] Corners of(const ShownParticle& one) const {
    const std::span<const float> keys = keys_.keys();
    if (keys.empty()) return kWholeTexture;
    const auto after = std::upper_bound(keys.begin(), keys.end(), keys_.time_of(one));
    const auto place = static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - keys.begin() - 1, 0));
    Corners found = kWholeTexture;
    for (std::size_t i = 0; i < corners_; ++i) found[i] = (*points_)[place * corners_ + i];
    return found;
  }

 private:
  const MFVec2f* points_;
  std::size_t corners_;
  RampKeys keys_;
};

/// Arrays of a mesh that are filled in order.
struct MeshArrays {
  MeshArrays(Mesh& mesh, std::size_t count, std::size_t index_count, const ColorRamp& ramp, bool textured)
      : target(mesh), vertices(count), indices(index_count) {
    positions = mesh.positions.prepare(vertices);
    index = mesh.indices.prepare(indices);
    if (!ramp.empty()) colors = mesh.colors.prepare(vertices);
    if (ramp.has_opacity()) opacities = mesh.opacities.prepare(vertices);
    if (textured) coordinates = mesh.texture_coordinates.prepare(vertices);
  }
  void add_vertex(const glm::vec3& position, const ParticleColor* color, const glm::vec2& coordinate) {
    *positions++ = position;
    target.bounds.add(position);
    if (coordinates) *coordinates++ = coordinate;
    if (!color) return;
    if (colors) *colors++ = color->color;
    if (opacities) *opacities++ = color->opacity;
  }
  void finish() const {
    target.positions.commit(vertices);
    target.indices.commit(indices);
    if (colors) target.colors.commit(vertices);
    if (opacities) target.opacities.commit(vertices);
    if (coordinates) target.texture_coordinates.commit(vertices);
  }

  Mesh& target;
  std::size_t vertices, indices;
  glm::vec3* positions = nullptr;
  std::uint32_t* index = nullptr;
  Color* colors = nullptr;
  float* opacities = nullptr;
  glm::vec2* coordinates = nullptr;
};

const ParticleColor* color_of(const ColorRamp& ramp, const ShownParticle& one) {
  return ramp.empty() ? nullptr : &ramp.of(one);
}

void add_points(Mesh& mesh, std::span<const ShownParticle> particles, const ColorRamp& ramp) {
  mesh.primitive = Mesh::Primitive::points;
  MeshArrays arrays(mesh, particles.size(), particles.size(), ramp, false);
  for (std::uint32_t i = 0; const ShownParticle& one : particles) {
    arrays.add_vertex(one.position, color_of(ramp, one), {});
    *arrays.index++ = i++;
  }
  arrays.finish();
}

// Adds lines along the velocities; the height of a particle is its length.
void add_lines(Mesh& mesh, std::span<const ShownParticle> particles, const ColorRamp& ramp,
               const CoordinateRamp* textures) {
  mesh.primitive = Mesh::Primitive::lines;
  MeshArrays arrays(mesh, particles.size() * 2, particles.size() * 2, ramp, textures != nullptr);
  for (std::uint32_t i = 0; const ShownParticle& one : particles) {
    const float speed = glm::length(one.velocity);
    const glm::vec3 direction = speed > 0 ? one.velocity / speed : glm::vec3(0, 1, 0);
    const glm::vec3 half = direction * (one.size.y / 2);
    const Corners corners = textures ? textures->of(one) : kWholeTexture;
    const ParticleColor* const color = color_of(ramp, one);
    arrays.add_vertex(one.position - half, color, corners[0]);
    arrays.add_vertex(one.position + half, color, corners[1]);
    for (int end = 0; end < 2; ++end) *arrays.index++ = i++;
  }
  arrays.finish();
}

// Adds quads: in the XY plane, or, for sprites, facing the viewer.
void add_quads(Mesh& mesh, std::span<const ShownParticle> particles, const ColorRamp& ramp,
               const CoordinateRamp* textures, const ParticleView* facing) {
  constexpr std::array<std::uint32_t, 6> kQuad = {0, 1, 2, 0, 2, 3};
  MeshArrays arrays(mesh, particles.size() * 4, particles.size() * kQuad.size(), ramp, textures != nullptr);
  const glm::vec3 viewer = facing ? glm::vec3(facing->viewer) : glm::vec3(0);
  const glm::vec3 upwards = facing ? glm::vec3(facing->up) : glm::vec3(0, 1, 0);
  for (std::uint32_t first = 0; const ShownParticle& one : particles) {
    glm::vec3 right(1, 0, 0), up(0, 1, 0);
    if (facing) {
      const glm::vec3 normal = viewer - one.position, across = glm::cross(upwards, normal);
      const float length = glm::dot(across, across);
      if (length > 0 && std::isfinite(length)) {
        right = across / std::sqrt(length);
        up = glm::normalize(glm::cross(normal, right));
      }
    }
    right *= one.size.x / 2;
    up *= one.size.y / 2;
    const Corners corners = textures ? textures->of(one) : kWholeTexture;
    const ParticleColor* const color = color_of(ramp, one);
    arrays.add_vertex(one.position - right - up, color, corners[0]);
    arrays.add_vertex(one.position + right - up, color, corners[1]);
    arrays.add_vertex(one.position + right + up, color, corners[2]);
    arrays.add_vertex(one.position - right + up, color, corners[3]);
    for (const std::uint32_t corner : kQuad) *arrays.index++ = first + corner;
    first += 4;
  }
  arrays.finish();
}

template <class T>
void repeat(Array<T>& to, const Array<T>& from, std::size_t times) {
  if (from.empty()) return;
  T* next = to.prepare(from.size() * times);
  for (std::size_t i = 0; i < times; ++i) next = std::copy(from.begin(), from.end(), next);
  to.commit(from.size() * times);
}

// Adds a copy of a geometry for each particle.
void add_copies(Mesh& mesh, std::span<const ShownParticle> particles, const ColorRamp& ramp, const Mesh& geometry,
                const glm::vec3& scale) {
  const std::size_t vertices = geometry.positions.size();
  particles =
      particles.first(std::min(particles.size(), kMaxParticleIndices / std::max(geometry.indices.size(), vertices)));
  mesh.primitive = geometry.primitive;
  mesh.solid = geometry.solid;
  mesh.lit = geometry.lit;
  mesh.pictured = geometry.pictured;
  mesh.translucent = geometry.translucent;
  MeshArrays arrays(mesh, particles.size() * vertices, particles.size() * geometry.indices.size(), ramp, false);
  const glm::vec3 origin(geometry.origin);
  for (std::uint32_t first = 0; const ShownParticle& one : particles) {
    const glm::vec3 place = one.position + origin;
    const ParticleColor* const color = color_of(ramp, one);
    for (const glm::vec3& position : geometry.positions) arrays.add_vertex(place + position * scale, color, {});
    for (const std::uint32_t corner : geometry.indices) *arrays.index++ = first + corner;
    first += static_cast<std::uint32_t>(vertices);
  }
  arrays.finish();
  repeat(mesh.normals, geometry.normals, particles.size());
  repeat(mesh.texture_coordinates, geometry.texture_coordinates, particles.size());
  repeat(mesh.fog_depths, geometry.fog_depths, particles.size());
  for (const CoordinateSet& set : geometry.coordinate_sets)
    repeat(mesh.coordinate_sets.emplace_back(), set, particles.size());
  if (!ramp.empty()) return;
  repeat(mesh.colors, geometry.colors, particles.size());
  repeat(mesh.opacities, geometry.opacities, particles.size());
}

}  // namespace

ParticleShape particle_shape(const SceneGraph& scene, NodeId system) {
  const SFString* const given = system_field<SFString>(scene, system, "geometryType");
  const std::string_view name = given ? given->view() : std::string_view();
  if (name == "LINE") return ParticleShape::line;
  if (name == "POINT") return ParticleShape::point;
  if (name == "SPRITE") return ParticleShape::sprite;
  if (name == "GEOMETRY") return ParticleShape::geometry;
  return ParticleShape::quad;  // also TRIANGLE, which looks the same
}

Mesh particle_mesh(const SceneGraph& scene, NodeId system, const ParticleView& view) {
  Mesh mesh;
  ParticleSimulation* const simulation = scene.particles().of(system);
  if (!simulation) return mesh;
  const ParticleShape shape = particle_shape(scene, system);
  const std::span<const ShownParticle> particles = simulation->shown();
  if (particles.empty() || (shape == ParticleShape::geometry && (!view.geometry || view.geometry->empty())))
    return mesh;
  const ColorRamp ramp(scene, system);
  const CoordinateRamp textures(scene, system, shape == ParticleShape::line ? 2 : 4);
  const CoordinateRamp* const used = view.texture_coordinates ? &textures : nullptr;
  mesh.solid = false;
  mesh.lit = shape != ParticleShape::line && shape != ParticleShape::point;
  switch (shape) {
    case ParticleShape::point:
      add_points(mesh, particles, ramp);
      break;
    case ParticleShape::line:
      add_lines(mesh, particles, ramp, used);
      break;
    case ParticleShape::quad:
      add_quads(mesh, particles, ramp, used, nullptr);
      break;
    case ParticleShape::sprite:
      add_quads(mesh, particles, ramp, used, &view);
      break;
    case ParticleShape::geometry:
      add_copies(mesh, particles, ramp, *view.geometry, view.scale);
      break;
  }
  mesh.translucent =
      mesh.translucent || std::any_of(mesh.opacities.begin(), mesh.opacities.end(), [](float a) { return a < 1; });
  return mesh;
}

Box particle_region(const SceneGraph& scene, NodeId system) {
  const SFVec3f* const center = system_field<SFVec3f>(scene, system, "bboxCenter");
  const SFVec3f* const size = system_field<SFVec3f>(scene, system, "bboxSize");
  if (center && size && size->x >= 0 && size->y >= 0 && size->z >= 0)
    return {*center - *size * 0.5F, *center + *size * 0.5F};
  const ParticleSimulation* const simulation = scene.particles().of(system);
  return simulation ? simulation->expected_bounds() : Box{};
}

}  // namespace gs::vrml
