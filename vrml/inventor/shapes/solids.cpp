#include "vrml/inventor/item_types.h"
#include "vrml/inventor/shapes/geometries.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

// Cube, Sphere, Cone and Cylinder.
namespace gs::vrml::inventor {
namespace {

constexpr std::int32_t kSegments = 24;

/// Faces of a solid, for styles and parts that the VRML97 node cannot express.
struct SolidMesh {
  float size = 1;  // the largest coordinate
  MFVec3f points;
  FaceList faces;
  std::int32_t part = 0;

  /// Rounds a coordinate to five decimals of the size, so that its text is short.
  [[nodiscard]] float rounded(float coordinate) const {
    constexpr double kSteps = 1e5;
    return static_cast<float>(std::round(coordinate / double{size} * kSteps) * size / kSteps + 0.0);
  }
  std::int32_t add(float x, float y, float z) {
    const bool rounds = size > 0 && std::isfinite(size);
    points.push_back(rounds ? SFVec3f(rounded(x), rounded(y), rounded(z)) : SFVec3f(x, y, z));
    return static_cast<std::int32_t>(points.size()) - 1;
  }
  void face(std::initializer_list<std::int32_t> corners) {
    for (const std::int32_t corner : corners) faces.corner(corner, corner, -1);
    faces.end_face(part);
  }
  /// Adds a ring of points around the y axis, and returns its first point.
  std::int32_t ring(float radius, float y) {
    const auto first = static_cast<std::int32_t>(points.size());
    for (std::int32_t i = 0; i < kSegments; ++i) {
      const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(kSegments);
      add(radius * std::sin(angle), y, radius * std::cos(angle));
    }
    return first;
  }
  void band(std::int32_t lower, std::int32_t upper) {
    for (std::int32_t i = 0; i < kSegments; ++i) {
      const std::int32_t next = (i + 1) % kSegments;
      face({lower + i, lower + next, upper + next, upper + i});
    }
  }
  /// Adds triangles between a ring and a point above or below it.
  void cap(std::int32_t ring, std::int32_t apex, bool above) {
    for (std::int32_t i = 0; i < kSegments; ++i) {
      const std::int32_t a = ring + i, b = ring + (i + 1) % kSegments;
      above ? face({a, b, apex}) : face({b, a, apex});
    }
  }
  void disc(std::int32_t first, bool up) {
    for (std::int32_t i = 0; i < kSegments; ++i) {
      const std::int32_t corner = first + (up ? i : kSegments - 1 - i);
      faces.corner(corner, corner, -1);
    }
    faces.end_face(part);
  }
};

bool has_part(const Item& item, std::string_view part) {
  const std::string_view parts = item.word("parts");
  return parts.find("ALL") != std::string_view::npos || parts.find(part) != std::string_view::npos;
}

// Adds the faces of a solid with the normals that they have.
void add_mesh(Converter& converter, const Item& item, SolidMesh mesh, bool closed) {
  State state = converter.state();
  state.points = std::move(mesh.points);
  state.normals = {};
  state.texture_points = {};
  state.serials[static_cast<std::size_t>(Part::coordinates)] = item.serial;
  state.serials[static_cast<std::size_t>(Part::normals)] = 0;
  state.hints = {true, closed, true, 0.5F};
  state.serials[static_cast<std::size_t>(Part::hints)] = closed ? 1 : 2;
  const bool by_part =
      state.material_binding == Binding::per_part || state.material_binding == Binding::per_part_indexed;
  state.material_binding = by_part ? Binding::per_part : Binding::overall;
  add_faces(converter, item, state, mesh.faces, {{}, {}, {}, false});
}

// Adds a solid as a VRML97 node. Returns null if the style needs a mesh.
NodeId begin_solid(Converter& converter, const Item& item, std::string_view type, std::size_t material = 0) {
  const Look look = converter.looks().of(converter.state(), ShapeKind::faces, false, material);
  return begin_geometry(converter, item, converter.state(), look, type);
}

bool is_by_part(Converter& converter) {
  converter.read(Part::material_binding);
  const Binding binding = converter.state().material_binding;
  return (binding == Binding::per_part || binding == Binding::per_part_indexed) &&
         (converter.state().material.diffuse.size() > 1 || converter.state().material.emissive.size() > 1);
}

bool is_filled(Converter& converter) {
  converter.read(Part::draw_style);
  return converter.state().draw_style == DrawStyle::filled;
}

void apply_cube(Converter& converter, const Item& item) {
  const SFVec3f size(item.get<SFFloat>("width"), item.get<SFFloat>("height"), item.get<SFFloat>("depth"));
  if (is_filled(converter) && !is_by_part(converter)) {
    const NodeId box = begin_solid(converter, item, "Box");
    if (!box) return;
    converter.output().set(box, "size", size);
    return converter.output().end(box);
  }
  SolidMesh mesh;
  const SFVec3f half = size * 0.5F;
  mesh.size = std::max({half.x, half.y, half.z});
  for (const float z : {half.z, -half.z})
    for (const float y : {-half.y, half.y})
      for (const float x : {-half.x, half.x}) mesh.add(x, y, z);
  // Front, back, left, right, top, bottom.
  constexpr std::int32_t kFaces[6][4] = {{0, 1, 3, 2}, {5, 4, 6, 7}, {4, 0, 2, 6},
                                         {1, 5, 7, 3}, {2, 3, 7, 6}, {4, 5, 1, 0}};
  for (const auto& f : kFaces) {
    mesh.face({f[0], f[1], f[2], f[3]});
    ++mesh.part;
  }
  add_mesh(converter, item, std::move(mesh), true);
}

void apply_sphere(Converter& converter, const Item& item) {
  const float radius = item.get<SFFloat>("radius");
  if (is_filled(converter)) {
    const NodeId sphere = begin_solid(converter, item, "Sphere");
    if (!sphere) return;
    converter.output().set(sphere, "radius", radius);
    return converter.output().end(sphere);
  }
  constexpr std::int32_t kBands = kSegments / 2;
  SolidMesh mesh;
  mesh.size = radius;
  const std::int32_t south = mesh.add(0, -radius, 0), north = mesh.add(0, radius, 0);
  std::int32_t below = -1;
  for (std::int32_t i = 1; i < kBands; ++i) {
    const float angle = std::numbers::pi_v<float> * (static_cast<float>(i) / static_cast<float>(kBands) - 0.5F);
    const std::int32_t ring = mesh.ring(radius * std::cos(angle), radius * std::sin(angle));
    if (below >= 0)
      mesh.band(below, ring);
    else
      mesh.cap(ring, south, false);
    below = ring;
  }
  mesh.cap(below, north, true);
  add_mesh(converter, item, std::move(mesh), true);
}

void apply_cylinder(Converter& converter, const Item& item) {
  const bool sides = has_part(item, "SIDES"), top = has_part(item, "TOP"), bottom = has_part(item, "BOTTOM");
  const float radius = item.get<SFFloat>("radius"), height = item.get<SFFloat>("height");
  const bool closed = sides && top && bottom;
  if (is_filled(converter) && closed) {
    const bool parts = is_by_part(converter);
    for (std::size_t part = 0; part < (parts ? 3U : 1U); ++part) {
      const NodeId node = begin_solid(converter, item, "Cylinder", part);
      if (!node) return;
      Output& output = converter.output();
      output.set(node, "radius", radius);
      output.set(node, "height", height);
      if (parts) {
        output.set(node, "side", part == 0);
        output.set(node, "top", part == 1);
        output.set(node, "bottom", part == 2);
      }
      output.end(node);
    }
    return;
  }
  SolidMesh mesh;
  mesh.size = std::max(radius, height / 2);
  const std::int32_t lower = mesh.ring(radius, -height / 2), upper = mesh.ring(radius, height / 2);
  if (sides) mesh.band(lower, upper);
  ++mesh.part;
  if (top) mesh.disc(upper, true);
  ++mesh.part;
  if (bottom) mesh.disc(lower, false);
  add_mesh(converter, item, std::move(mesh), closed);
}

void apply_cone(Converter& converter, const Item& item) {
  const bool sides = has_part(item, "SIDES"), bottom = has_part(item, "BOTTOM");
  const float radius = item.get<SFFloat>("bottomRadius"), height = item.get<SFFloat>("height");
  const bool closed = sides && bottom;
  if (is_filled(converter) && closed) {
    const bool parts = is_by_part(converter);
    for (std::size_t part = 0; part < (parts ? 2U : 1U); ++part) {
      const NodeId node = begin_solid(converter, item, "Cone", part);
      if (!node) return;
      Output& output = converter.output();
      output.set(node, "bottomRadius", radius);
      output.set(node, "height", height);
      if (parts) {
        output.set(node, "side", part == 0);
        output.set(node, "bottom", part == 1);
      }
      output.end(node);
    }
    return;
  }
  SolidMesh mesh;
  mesh.size = std::max(radius, height / 2);
  const std::int32_t lower = mesh.ring(radius, -height / 2), apex = mesh.add(0, height / 2, 0);
  if (sides) mesh.cap(lower, apex, true);
  ++mesh.part;
  if (bottom) mesh.disc(lower, false);
  add_mesh(converter, item, std::move(mesh), closed);
}

constexpr ItemRow kSolidRows[] = {
    {"Cube", ItemClass::shape, false, apply_cube, "SFFloat width 2 SFFloat height 2 SFFloat depth 2"},
    {"Sphere", ItemClass::shape, false, apply_sphere, "SFFloat radius 1"},
    {"Cone", ItemClass::shape, false, apply_cone, "SFBitMask parts ALL SFFloat bottomRadius 1 SFFloat height 2"},
    {"Cylinder", ItemClass::shape, false, apply_cylinder, "SFBitMask parts ALL SFFloat radius 1 SFFloat height 2"},
};

}  // namespace

std::span<const ItemRow> solid_rows() { return kSolidRows; }

}  // namespace gs::vrml::inventor
