#include "app/formats/common/content_type.h"
#include "app/formats/common/mesh_asset.h"
#include "app/formats/common/text_cursor.h"

#include <array>
#include <bit>
#include <cctype>
#include <cstring>
#include <map>
#include <numbers>
#include <optional>
#include <string>

namespace gs::app {
namespace {

constexpr std::string_view kFirstLine = "# Micro AVS Geom:";

enum class Primitive : std::uint8_t { polygons, polyhedron, strip, mesh, lines, polyline, unsupported, none };

struct PrimitiveName {
  std::string_view name;
  Primitive primitive;
};
constexpr PrimitiveName kPrimitives[] = {
    {"disjoint polygon", Primitive::polygons},
    {"polyhedron", Primitive::polyhedron},
    {"polytri", Primitive::strip},
    {"mesh", Primitive::mesh},
    {"disjoint line", Primitive::lines},
    {"polyline", Primitive::polyline},
    {"sphere", Primitive::unsupported},
    {"circle", Primitive::unsupported},
    {"column", Primitive::unsupported},
    {"label", Primitive::unsupported},
    {"revolution", Primitive::unsupported},
};

Primitive primitive_named(std::string_view line) {
  for (const PrimitiveName& entry : kPrimitives)
    if (entry.name == line) return entry.primitive;
  return Primitive::none;
}

/// Data that each vertex has. A keyword of the file selects it.
struct VertexKind {
  bool normals = false, colors = false, height_only = false;
};
std::optional<VertexKind> vertex_kind_named(std::string_view word) {
  if (word == "vertex") return VertexKind{};
  if (word == "color") return VertexKind{false, true, false};
  if (word == "normal") return VertexKind{true, false, false};
  if (word == "normal_and_color") return VertexKind{true, true, false};
  if (word == "scalar") return VertexKind{false, false, true};
  return std::nullopt;
}

bool is_step(std::string_view line) {
  return line.starts_with("step") && line.size() > 4 && std::isdigit(static_cast<unsigned char>(line[4]));
}

class AvsGeometryImporter {
 public:
  AvsGeometryImporter(std::span<const std::byte> bytes, MeshBuilder& builder)
      : cursor_(bytes), lines_(cursor_.next), builder_(builder) {}

  void run() {
    int steps = 0;
    std::string_view text;
    while (next_line(text)) {
      if (is_step(text) && ++steps > 1) {
        builder_.note("only the first step is read", location());
        break;
      }
      const Primitive primitive = primitive_named(text);
      // Lines without a primitive are skipped: the number of steps at the start, and the data of unsupported
      // primitives.
      if (primitive == Primitive::none) continue;
      std::string_view name;
      if (primitive == Primitive::unsupported) {
        builder_.warn("primitives of type " + std::string(text) + " are left out", location());
        continue;
      }
      if (!next_line(name)) {
        fail("expected the name of the primitive");
        return;
      }
      Geometry geometry;
      const bool whole = read(primitive, geometry);
      build(std::move(geometry), primitive, name);
      if (!whole) return;
    }
    if (!any_) builder_.warn("no geometry in the file");
  }

 private:
  /// Reads the next line that is neither empty nor a comment. Trims it.
  bool next_line(std::string_view& text) {
    while (cursor_.skip_space()) {
      start_ = cursor_.next;
      text = trimmed(cursor_.line());
      if (!text.starts_with('#')) return true;
    }
    return false;
  }
  SourceLocation location() { return lines_.location(start_); }
  bool fail(std::string message) {
    start_ = cursor_.next;
    builder_.fail(std::move(message), location());
    return false;
  }

  bool number(float& value) { return cursor_.skip_space() && cursor_.number(value); }
  /// Reads a number of items. Fails if that many items of `bytes` bytes each exceed the rest of the file.
  bool count(std::size_t& value, std::size_t bytes = 2) {
    double number = 0;
    if (!cursor_.skip_space() || !cursor_.number(number)) return fail("expected a whole number");
    const auto left = static_cast<double>(cursor_.end - cursor_.next);
    if (!(number >= 0 && number <= left / static_cast<double>(bytes) + 1))
      return fail("the file ends before this number");
    value = static_cast<std::size_t>(number);
    return true;
  }

  bool read(Primitive primitive, Geometry& geometry) {
    bool smooth = false;
    if (primitive == Primitive::polygons || primitive == Primitive::polyhedron) {
      const std::string_view word = cursor_.word();
      if (word != "facet" && word != "smooth") return fail("expected facet or smooth");
      smooth = word == "smooth";
    }
    const auto kind = vertex_kind_named(cursor_.word());
    if (!kind || (kind->height_only && primitive != Primitive::mesh))
      return fail("expected the contents of a vertex: vertex, color, normal or normal_and_color");
    kind_ = *kind;
    if (smooth || primitive == Primitive::strip || primitive == Primitive::mesh)
      geometry.crease_angle = std::numbers::pi_v<float>;
    (void)positions_.take();
    (void)normals_.take();
    (void)colors_.take();
    (void)index_.take();
    welded_.clear();
    bool whole = false;
    if (primitive == Primitive::polygons) whole = read_polygons(smooth && !kind_.normals && !kind_.colors);
    if (primitive == Primitive::polyhedron) whole = read_polyhedron();
    if (primitive == Primitive::strip) whole = read_strip();
    if (primitive == Primitive::mesh) whole = read_mesh();
    if (primitive == Primitive::lines || primitive == Primitive::polyline) whole = read_lines(primitive);
    geometry.positions = positions_.take();
    geometry.normals = normals_.take();
    geometry.colors = colors_.take();
    geometry.coord_index = index_.take();
    return whole;
  }

  struct Vertex {
    glm::vec3 position{0}, normal{0}, color{0};
  };
  bool read_vertex(Vertex& vertex) {
    for (int k = 0; k < 3; ++k)
      if (!number(vertex.position[k])) return fail("expected three numbers for a vertex");
    for (int k = 0; k < 3 && kind_.normals; ++k)
      if (!number(vertex.normal[k])) return fail("expected three numbers for a normal");
    for (int k = 0; k < 3 && kind_.colors; ++k)
      if (!number(vertex.color[k])) return fail("expected three numbers for a colour");
    return true;
  }
  void add(const Vertex& vertex) {
    positions_.push(vertex.position);
    if (kind_.normals) normals_.push(vertex.normal);
    if (kind_.colors) colors_.push({vertex.color.x, vertex.color.y, vertex.color.z});
  }
  bool vertex() {
    Vertex vertex;
    if (!read_vertex(vertex)) return false;
    add(vertex);
    return true;
  }
  bool vertices(std::size_t number) {
    for (std::size_t i = 0; i < number; ++i)
      if (!vertex()) return false;
    return true;
  }
  void corner(std::size_t i) {
    index_.push(i < static_cast<std::size_t>(kBadIndex) ? static_cast<std::int32_t>(i) : kBadIndex);
  }

  /// Reads polygons with separate vertices. `weld` merges vertices at equal positions, for smooth shading.
  bool read_polygons(bool weld) {
    std::size_t polygons = 0;
    if (!count(polygons)) return false;
    for (std::size_t i = 0; i < polygons; ++i) {
      std::size_t corners = 0;
      if (!count(corners)) return false;
      for (std::size_t k = 0; k < corners; ++k) {
        Vertex read;
        if (!read_vertex(read)) {
          index_.drop(k);
          return false;
        }
        const std::size_t next = positions_.size();
        const glm::vec3 p = read.position;
        const std::array<std::uint32_t, 3> bits = {std::bit_cast<std::uint32_t>(p.x), std::bit_cast<std::uint32_t>(p.y),
                                                   std::bit_cast<std::uint32_t>(p.z)};
        const std::size_t place = weld ? welded_.try_emplace(bits, next).first->second : next;
        if (place == next) add(read);
        corner(place);
      }
      index_.push(kFaceEnd);
    }
    return true;
  }

  /// Reads vertices, then faces. The vertex numbers of faces start at 1.
  bool read_polyhedron() {
    std::size_t number = 0, faces = 0;
    if (!count(number) || !vertices(number) || !count(faces)) return false;
    for (std::size_t i = 0; i < faces; ++i) {
      std::size_t corners = 0;
      if (!count(corners)) return false;
      for (std::size_t k = 0; k < corners; ++k) {
        double at = 0;
        if (!cursor_.skip_space() || !cursor_.number(at)) {
          index_.drop(k);
          return fail("expected the number of a vertex");
        }
        index_.push(at >= 1 && at < kBadIndex ? static_cast<std::int32_t>(at) - 1 : kBadIndex);
      }
      index_.push(kFaceEnd);
    }
    return true;
  }

  bool read_strip() {
    std::size_t number = 0;
    const bool whole = count(number) && vertices(number);
    for (std::size_t i = 2; i < positions_.size(); ++i) {
      const bool turned = i % 2 != 0;
      corner(turned ? i - 1 : i - 2);
      corner(turned ? i - 2 : i - 1);
      corner(i);
      index_.push(kFaceEnd);
    }
    return whole;
  }

  /// Reads rows of vertices. If the file has only heights, neighbouring vertices are one unit apart.
  bool read_mesh() {
    std::size_t columns = 0, rows = 0;
    if (!count(columns, 1) || !count(rows, 1)) return false;
    if (columns == 0 || rows > static_cast<std::size_t>(cursor_.end - cursor_.next) / columns + 1)
      return fail("the file ends before the end of the mesh");
    for (std::size_t row = 0; row < rows; ++row)
      for (std::size_t column = 0; column < columns; ++column) {
        glm::vec3 p(static_cast<float>(column), static_cast<float>(row), 0);
        if (kind_.height_only) {
          if (!number(p.z)) return fail("expected a height");
          positions_.push(p);
        } else if (!vertex()) {
          return false;
        }
        if (row == 0 || column == 0) continue;
        const std::size_t here = row * columns + column, below = here - columns;
        for (const std::size_t i : {below - 1, below, here, here - 1}) corner(i);
        index_.push(kFaceEnd);
      }
    return true;
  }

  bool read_lines(Primitive primitive) {
    std::size_t number = 0;
    const bool whole = count(number) && vertices(number);
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      corner(i);
      if (primitive == Primitive::lines && i % 2 == 1) index_.push(kFaceEnd);
    }
    (void)normals_.take();  // lines are unlit, so drop their normals
    return whole;
  }

  void build(Geometry geometry, Primitive primitive, std::string_view name) {
    if (geometry.coord_index.empty()) return;
    const bool line = primitive == Primitive::lines || primitive == Primitive::polyline;
    geometry.kind = line ? Geometry::Kind::lines : Geometry::Kind::faces;
    geometry.convex = primitive == Primitive::strip;
    if (builder_.add(std::move(geometry), line ? glowing({}) : Look{}, name)) any_ = true;
  }

  TextCursor cursor_;
  LineCounter lines_;
  MeshBuilder& builder_;
  const char* start_ = nullptr;
  VertexKind kind_;
  Appender<glm::vec3> positions_{builder_}, normals_{builder_};
  Appender<vrml::Color> colors_{builder_};
  Appender<std::int32_t> index_{builder_};
  std::map<std::array<std::uint32_t, 3>, std::size_t> welded_;  // by the bits of x, y, z, because NaN has no order
  bool any_ = false;
};

bool is_avs_geometry(std::span<const std::byte> bytes) {
  return bytes.size() >= kFirstLine.size() && std::memcmp(bytes.data(), kFirstLine.data(), kFirstLine.size()) == 0;
}

/// Imports an AVS text geometry file (MicroAVS MGF, `# Micro AVS Geom:`), one named part per primitive: disjoint
/// polygons, polyhedra, polytris and meshes as faces, disjoint lines and polylines as lines. Spheres, circles, columns,
/// revolutions and labels are skipped with a warning. Vertex normals and colours are kept. Of several steps, only the
/// first is read.
///
/// The format follows the MicroAVS manual (Cybernet). Binary AVS5 .geom files, an undocumented layout, give an error. A
/// truncated file gives an error and its complete part.
void import_avs_geometry(std::span<const std::byte> bytes, MeshBuilder& builder) {
  if (!is_avs_geometry(bytes)) {
    builder.fail(
        "not an AVS text geometry: expected '# Micro AVS Geom:' as the first line; the binary .geom files of AVS5 "
        "cannot be read, convert them to MicroAVS MGF, UCD or VRML first",
        {1, 1});
    return;
  }
  AvsGeometryImporter(bytes, builder).run();
}

}  // namespace

extern constinit const ContentType kAvsGeometryFormat = {.name = "AVS geometry",
                                                         .mime = "model/x-avs-geometry",
                                                         .extensions = ".mgf .geom .geo ",
                                                         .sniff = is_avs_geometry,
                                                         .content = ContentClass::mesh,
                                                         .read = read_mesh<import_avs_geometry>};

}  // namespace gs::app
