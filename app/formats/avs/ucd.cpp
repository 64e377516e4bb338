#include "app/formats/avs/ucd_mesh.h"
#include "app/formats/common/content_type.h"
#include "app/formats/common/mesh_asset.h"
#include "base/text.h"

#include <algorithm>
#include <cmath>

namespace gs::app {
namespace {

// Crease angle in radians. Edges with a smaller angle are smooth.
constexpr float kUcdCreaseAngle = 0.5f;
constexpr std::int8_t kNoCorner = -1;

using LocalFace = std::array<std::int8_t, 4>;

// Faces of the cells as corner indices, counterclockwise from outside. The node order of AVS is the top first, then the
// bottom, both counterclockwise from above. The top of a tetrahedron or pyramid is one node.
constexpr LocalFace kTriangle[] = {{0, 1, 2, kNoCorner}};
constexpr LocalFace kQuadrilateral[] = {{0, 1, 2, 3}};
constexpr LocalFace kTetrahedron[] = {
    {0, 1, 2, kNoCorner}, {0, 2, 3, kNoCorner}, {0, 3, 1, kNoCorner}, {1, 3, 2, kNoCorner}};
constexpr LocalFace kPyramid[] = {
    {0, 1, 2, kNoCorner}, {0, 2, 3, kNoCorner}, {0, 3, 4, kNoCorner}, {0, 4, 1, kNoCorner}, {1, 4, 3, 2}};
constexpr LocalFace kPrism[] = {{0, 1, 2, kNoCorner}, {5, 4, 3, kNoCorner}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}};
constexpr LocalFace kHexahedron[] = {{0, 1, 2, 3}, {7, 6, 5, 4}, {0, 4, 5, 1},
                                     {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0}};

std::span<const LocalFace> faces_of(UcdType type) {
  static constexpr std::span<const LocalFace> kFaces[] = {{},           {},       kTriangle, kQuadrilateral,
                                                          kTetrahedron, kPyramid, kPrism,    kHexahedron};
  return kFaces[static_cast<std::size_t>(type)];
}

struct Face {
  std::array<std::int32_t, 4> corners{}, key{};  // `key` has the same corners in ascending order
  std::uint32_t cell = 0;
  bool solid = false;  // true for a face of a cell with a volume
  bool inner = false;  // true if two such cells share the face
};

constexpr std::size_t kBetweenLooks = std::size_t{1} << 17;  // steps between two checks for cancellation

std::vector<Face> collect(const UcdMesh& mesh, ImportContext& context) {
  std::vector<Face> faces;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    if (c % kBetweenLooks == 0) context.draw(0);
    const UcdCell& cell = mesh.cells[c];
    for (const LocalFace& local : faces_of(cell.type)) {
      Face face;
      face.cell = static_cast<std::uint32_t>(c);
      face.solid = cell.type >= UcdType::tetrahedron;
      for (std::size_t k = 0; k < 4; ++k) {
        const std::int32_t node = local[k] == kNoCorner ? kFaceEnd : cell.corners[static_cast<std::size_t>(local[k])];
        face.corners[k] = local[k] != kNoCorner && node < 0 ? kBadIndex : node;
      }
      face.key = face.corners;
      std::sort(face.key.begin(), face.key.end());
      faces.push_back(face);
    }
  }
  return faces;
}

void mark_inner(std::vector<Face>& faces, ImportContext& context) {
  std::vector<std::size_t> order;
  std::size_t steps = 0;
  for (std::size_t i = 0; i < faces.size(); ++i)
    if (faces[i].solid) order.push_back(i);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (++steps % kBetweenLooks == 0) context.draw(0);
    return faces[a].key < faces[b].key;
  });
  for (std::size_t i = 1; i < order.size(); ++i)
    if (faces[order[i]].key == faces[order[i - 1]].key) faces[order[i]].inner = faces[order[i - 1]].inner = true;
}

/// Returns the colour of row `i`. A missing row counts as NaN.
vrml::Color color_at(const ColorKey& key, std::span<const float> values, std::size_t i) {
  return key.color_of(i < values.size() ? static_cast<double>(values[i]) : NAN);
}

void build(const UcdMesh& mesh, MeshBuilder& builder) {
  constexpr std::uint64_t kMaxFaces = 6;
  builder.draw(mesh.cells.size() * kMaxFaces * sizeof(Face));
  std::vector<Face> faces = collect(mesh, builder);
  mark_inner(faces, builder);
  Geometry geometry;
  Appender<std::int32_t> index(builder);
  Appender<vrml::Color> colors(builder);
  const bool by_node = !mesh.node_values.empty(), by_cell = !by_node && !mesh.cell_values.empty();
  const std::vector<float>& values = by_node ? mesh.node_values : mesh.cell_values;
  const ColorKey key = color_key_over(values, viridis_colors(), by_node ? mesh.node_label : mesh.cell_label);
  for (const Face& face : faces) {
    if (face.inner) continue;
    for (const std::int32_t corner : face.corners)
      if (corner != kFaceEnd) index.push(corner);
    index.push(kFaceEnd);
    if (by_cell) colors.push(color_at(key, values, face.cell));
  }
  if (index.empty()) {
    builder.warn("no faces in the file");
    return;
  }
  for (std::size_t i = 0; by_node && i < mesh.nodes.size(); ++i) colors.push(color_at(key, values, i));
  geometry.positions = vrml::MFVec3f(std::span(mesh.nodes));
  geometry.coord_index = index.take();
  geometry.colors = colors.take();
  geometry.color_per_vertex = !by_cell;
  geometry.convex = false;  // quadrilaterals may be concave
  geometry.crease_angle = kUcdCreaseAngle;
  builder.add(std::move(geometry));
  if (by_node || by_cell) builder.set_color_key(key);
}

/// Imports the surface of an AVS UCD file (unstructured cell data) as one part. Reads ASCII, including the first step
/// of the MicroAVS form, and binary of both byte orders. The surface consists of triangles, quadrilaterals, and the
/// faces of tetrahedra, pyramids, prisms and hexahedra that only one cell has. Lines and points are skipped with a
/// note. Of cells with nodes on edges, only the corners are used.
///
/// The first scalar component of node data colours the vertices, with Viridis from minimum to maximum (see
/// color_key.h). Without node data, cell data colour the faces.
///
/// Memory is bounded by a multiple of the file size. A truncated text gives an error and its complete cells. Layout:
/// AVS Developer's Guide; binary as in VTK's reader.
void import_ucd(std::span<const std::byte> bytes, MeshBuilder& builder) {
  UcdMesh mesh;
  const bool binary = !bytes.empty() && bytes.front() == kUcdBinary;
  // Estimate for a text with the shortest lines. Includes nodes, cells, their numbers and their values.
  builder.draw(bytes.size() * (binary ? 3 : 5));
  if (const auto problem = binary ? read_ucd_binary(bytes, mesh) : read_ucd_text(bytes, mesh))
    builder.fail(problem->message, {problem->line, problem->line > 0 ? 1u : 0u});
  const auto thin = std::count_if(mesh.cells.begin(), mesh.cells.end(),
                                  [](const UcdCell& cell) { return cell.type <= UcdType::line; });
  if (thin > 0) builder.note(std::to_string(thin) + " cells that are points or lines are left out");
  build(mesh, builder);
}

// Detects ASCII UCD: comments, then a line of five integers. The comments alone do not suffice, because AVS fields may
// begin with such comments too.
bool is_ucd_text(std::span<const std::byte> bytes) {
  std::string_view text = text_of(bytes);
  while (text.starts_with('#')) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return false;
    text.remove_prefix(end + 1);
  }
  int numbers = 0;
  bool inside = false;
  for (const char c : text) {
    if (c == '\n') return numbers == 5;
    if (c == ' ' || c == '\t' || c == '\r') {
      inside = false;
      continue;
    }
    if (c < '0' || c > '9') return false;
    if (!inside) ++numbers;
    inside = true;
  }
  return false;
}

}  // namespace

std::string ucd_label(std::string_view name, std::string_view unit) {
  const auto tidied = [](std::string_view text) {
    std::string result;
    for (const char c : text.substr(0, 80))
      if (c >= 0x20 && c < 0x7F) result += c;
    while (result.ends_with(' ')) result.pop_back();
    return result.substr(std::min(result.find_first_not_of(' '), result.size()));
  };
  const std::string of = tidied(name), in = tidied(unit);
  return in.empty() ? of : of.empty() ? in : of + " (" + in + ")";
}

extern constinit const ContentType kUcdFormat =
    mesh_type("AVS UCD", "model/x-avs-ucd", ".inp .ucd ", is_ucd_text, read_mesh<import_ucd>);

}  // namespace gs::app
