#include "vrml/inventor/shapes/geometries.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <utility>

namespace gs::vrml::inventor {
namespace {

// Returns an identity of everything that an indexed geometry depends on.
std::string identity_of(Converter& converter, const Item& item, const State& state, const Look& look) {
  std::string key = "geometry " + std::to_string(item.serial);
  for (const Part part : {Part::coordinates, Part::normals, Part::normal_binding, Part::material_binding, Part::hints,
                          Part::draw_style}) {
    converter.read(part);
    key += ' ' + std::to_string(state.serial(part));
  }
  if (look.texture != 0)
    for (const Part part : {Part::texture_coordinates, Part::texture_function}) {
      converter.read(part);
      key += " t" + std::to_string(state.serial(part));
    }
  if (look.varies) key += " c" + std::to_string(look.colors_serial);
  return key;
}

std::string serial_of(const State& state, Part part) { return ' ' + std::to_string(state.serial(part)); }

void set_colors(Converter& converter, NodeId geometry, const Look& look, const std::optional<AttributeIndex>& index) {
  if (!index) return;
  set_property(converter, geometry, "color", "Color", "color", look.colors, ' ' + std::to_string(look.colors_serial));
  if (!index->per_vertex) converter.output().set(geometry, "colorPerVertex", false);
  if (!index->index.empty()) converter.output().set(geometry, "colorIndex", index->index);
}

void set_normals(Converter& converter, const Item& item, const State& state, NodeId geometry, const FaceList& faces,
                 const OwnIndices& own) {
  if (state.normals.empty()) return;
  const Binding binding = own.indexed ? state.normal_binding : without_index(state.normal_binding);
  const auto index = attribute_index(faces, binding, own.normal, state.normals.size(), false);
  if (!index) return converter.warn_once(item.location, "too few normals for the shape; computed normals instead");
  set_property(converter, geometry, "normal", "Normal", "vector", state.normals, serial_of(state, Part::normals));
  if (!index->per_vertex) converter.output().set(geometry, "normalPerVertex", false);
  if (!index->index.empty()) converter.output().set(geometry, "normalIndex", index->index);
}

// Texture coordinates of TextureCoordinatePlane: the position along each direction, in units of its length.
MFVec2f plane_coordinates(const MFVec3f& points, const TextureFunction& function) {
  const auto along = [](const SFVec3f& point, const SFVec3f& direction) {
    const float square = glm::dot(direction, direction);
    return square > 0 ? glm::dot(point, direction) / square : 0.0F;
  };
  MFVec2f result;
  result.reserve(points.size());
  for (const SFVec3f& point : points) result.push_back({along(point, function.s), along(point, function.t)});
  return result;
}

void set_texture_coordinates(Converter& converter, const Item& item, const State& state, NodeId geometry,
                             const FaceList& faces, const OwnIndices& own) {
  using Kind = TextureFunction::Kind;
  if (state.texture_function.kind == Kind::environment) {
    Output& output = converter.output();
    const NodeId generator =
        output.begin_x3d("TextureCoordinateGenerator", output.field(geometry, "texCoord"), item.location);
    if (generator) output.end(generator);  // mode SPHERE
    return;
  }
  if (state.texture_function.kind == Kind::plane) {
    if (!converter.sink().limits().admits_string(state.points.size() * sizeof(SFVec2f), item.location)) return;
    return set_property(converter, geometry, "texCoord", "TextureCoordinate", "point",
                        plane_coordinates(state.points, state.texture_function),
                        " plane" + serial_of(state, Part::coordinates) + serial_of(state, Part::texture_function));
  }
  if (state.texture_points.empty()) return;
  const Binding binding = own.indexed ? Binding::per_vertex_indexed : Binding::per_vertex;
  const auto index = attribute_index(faces, binding, own.texture, state.texture_points.size(), false);
  if (!index)
    return converter.warn_once(item.location,
                               "too few texture coordinates for the shape; computed texture coordinates instead");
  set_property(converter, geometry, "texCoord", "TextureCoordinate", "point", state.texture_points,
               serial_of(state, Part::texture_coordinates));
  if (!index->index.empty()) converter.output().set(geometry, "texCoordIndex", index->index);
}

// Returns the outlines of polygons as closed polylines.
FaceList outlines_of(const FaceList& faces) {
  FaceList lines;
  std::size_t first = 0;
  std::int32_t face = 0;
  const auto& index = faces.index;
  const auto close = [&](std::size_t end) {
    if (end <= first) return;
    for (std::size_t i = first; i <= end; ++i) {
      const std::size_t at = i == end ? first : i;
      lines.corner(index[at], faces.vertex.empty() ? index[at] : faces.vertex[at], static_cast<std::int32_t>(at));
    }
    lines.end_face(face);
    lines.face.push_back(face);
  };
  for (std::size_t i = 0; i < index.size(); ++i) {
    if (index[i] >= 0) continue;
    close(i);
    ++face;
    first = i + 1;
  }
  close(index.size());
  return lines;
}

}  // namespace

NodeId begin_geometry(Converter& converter, const Item& item, const State& state, const Look& look,
                      std::string_view geometry_type) {
  Output& output = converter.output();
  const auto target = output.target();
  if (!target) return {};
  const NodeId shape = output.begin("Shape", *target, item.location, item.name);
  if (!shape) return {};
  converter.looks().apply(shape, look, state, item.location);
  const NodeId geometry = output.begin(geometry_type, output.field(shape, "geometry"), item.location);
  output.end(shape);
  output.note_shape();
  return geometry;
}

void add_shape(Converter& converter, const Item& item, const State& state, const Look& look, NodeId geometry) {
  Output& output = converter.output();
  const auto target = output.target();
  if (!target) return;
  const NodeId shape = output.begin("Shape", *target, item.location);
  if (!shape) return;
  converter.looks().apply(shape, look, state, item.location);
  output.place(geometry, output.field(shape, "geometry"));
  output.end(shape);
  output.note_shape();
}

void add_faces(Converter& converter, const Item& item, const State& state, const FaceList& faces,
               const OwnIndices& own) {
  converter.read(Part::draw_style);
  converter.read(Part::coordinates);
  converter.read(Part::material_binding);
  if (faces.index.empty() || state.points.empty() || state.draw_style == DrawStyle::invisible) return;
  if (state.draw_style == DrawStyle::points) return add_points(converter, item, state, 0, state.points.size());
  if (state.draw_style == DrawStyle::lines) return add_lines(converter, item, state, outlines_of(faces), own);
  const Binding binding = own.indexed ? state.material_binding : without_index(state.material_binding);
  Look look = converter.looks().of(state, ShapeKind::faces, binding != Binding::overall);
  std::string identity;
  if (converter.may_repeat()) {
    identity = identity_of(converter, item, state, look);
    if (const NodeId known = converter.looks().property(identity))
      return add_shape(converter, item, state, look, known);
  }
  const NodeId geometry = begin_geometry(converter, item, state, look, "IndexedFaceSet");
  if (!geometry) return;
  converter.read(Part::hints);
  converter.read(Part::normals);
  converter.read(Part::normal_binding);
  Output& output = converter.output();
  set_property(converter, geometry, "coord", "Coordinate", "point", state.points, serial_of(state, Part::coordinates));
  output.set(geometry, "coordIndex", faces.index);
  if (look.varies)
    set_colors(converter, geometry, look, attribute_index(faces, binding, own.material, look.colors.size(), true));
  set_normals(converter, item, state, geometry, faces, own);
  if (look.texture != 0) {
    converter.read(Part::texture_coordinates);
    converter.read(Part::texture_function);
    set_texture_coordinates(converter, item, state, geometry, faces, own);
  }
  output.set(geometry, "ccw", state.hints.ccw);
  output.set(geometry, "solid", state.hints.solid);
  output.set(geometry, "convex", state.hints.convex);
  output.set(geometry, "creaseAngle", state.hints.crease_angle);
  output.end(geometry);
  if (!identity.empty()) converter.looks().property(identity) = geometry;
}

void add_lines(Converter& converter, const Item& item, const State& state, const FaceList& lines,
               const OwnIndices& own) {
  converter.read(Part::draw_style);
  converter.read(Part::coordinates);
  converter.read(Part::material_binding);
  if (lines.index.empty() || state.points.empty() || state.draw_style == DrawStyle::invisible) return;
  if (state.draw_style == DrawStyle::points) return add_points(converter, item, state, 0, state.points.size());
  const Binding binding = own.indexed ? state.material_binding : without_index(state.material_binding);
  const Look look = converter.looks().of(state, ShapeKind::lines, binding != Binding::overall);
  std::string identity;
  if (converter.may_repeat()) {
    identity = identity_of(converter, item, state, look);
    if (const NodeId known = converter.looks().property(identity))
      return add_shape(converter, item, state, look, known);
  }
  const NodeId geometry = begin_geometry(converter, item, state, look, "IndexedLineSet");
  if (!geometry) return;
  set_property(converter, geometry, "coord", "Coordinate", "point", state.points, serial_of(state, Part::coordinates));
  converter.output().set(geometry, "coordIndex", lines.index);
  if (look.varies)
    set_colors(converter, geometry, look, attribute_index(lines, binding, own.material, look.colors.size(), true));
  converter.output().end(geometry);
  if (!identity.empty()) converter.looks().property(identity) = geometry;
}

void add_points(Converter& converter, const Item& item, const State& state, std::size_t first, std::size_t count) {
  converter.read(Part::draw_style);
  converter.read(Part::coordinates);
  converter.read(Part::material_binding);
  if (state.draw_style == DrawStyle::invisible || first >= state.points.size()) return;
  count = std::min(count, state.points.size() - first);
  if (count == 0) return;
  Look look = converter.looks().of(state, ShapeKind::lines, state.material_binding != Binding::overall);
  const bool whole = first == 0 && count == state.points.size();
  const NodeId geometry = begin_geometry(converter, item, state, look, "PointSet");
  if (!geometry) return;
  std::string range;
  if (!whole) range = " from" + std::to_string(first) + ' ' + std::to_string(count);
  const MFVec3f points = whole ? state.points : MFVec3f(state.points.span().subspan(first, count));
  set_property(converter, geometry, "coord", "Coordinate", "point", points,
               serial_of(state, Part::coordinates) + range);
  if (look.varies) {
    MFColor colors;
    for (std::size_t i = 0; i < count; ++i) colors.push_back(look.colors[i % look.colors.size()]);
    set_property(converter, geometry, "color", "Color", "color", colors,
                 ' ' + std::to_string(look.colors_serial) + " first" + std::to_string(count));
  }
  converter.output().end(geometry);
}

State state_of_shape(Converter& converter, const Item& item) {
  State state = converter.state();
  if (const ItemPtr property = item.node("vertexProperty")) apply_vertex_property(converter, *property, state);
  return state;
}

}  // namespace gs::vrml::inventor
