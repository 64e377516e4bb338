#include "vrml/inventor/item_types.h"
#include "vrml/inventor/shapes/geometries.h"

#include <algorithm>
#include <span>
#include <utility>

// Shapes of polygons: sets of faces, strips of triangles and meshes of quadrilaterals.
namespace gs::vrml::inventor {
namespace {

OwnIndices own_indices(const Item& item) {
  return {item.get<MFInt32>("materialIndex"), item.get<MFInt32>("normalIndex"), item.get<MFInt32>("textureCoordIndex"),
          true};
}

void apply_indexed_faces(Converter& converter, const Item& item) {
  const State state = state_of_shape(converter, item);
  FaceList faces;
  faces.index = item.get<MFInt32>("coordIndex");
  OwnIndices own = own_indices(item);
  const bool is_default = faces.index.size() == 1 && faces.index[0] == 0;
  if (!is_default) add_faces(converter, item, state, faces, own);
}

/// Runs of consecutive vertices in a shape without indices, from `startIndex` on. A length of -1 takes all remaining
/// vertices.
struct Runs {
  std::size_t next = 0, left = 0;
  /// Returns the length of the next run, limited to the vertices that are left.
  std::size_t take(std::int32_t number) {
    const std::size_t length = number < 0 ? left : std::min(left, static_cast<std::size_t>(number));
    left -= length;
    return length;
  }
};

Runs runs_of(const Item& item, const State& state) {
  const auto start = static_cast<std::size_t>(std::max(item.get<SFInt32>("startIndex"), 0));
  return {start, state.points.size() - std::min(start, state.points.size())};
}

// Reports whether memory for the indices of `corners` corners may be used.
bool admits(Converter& converter, const Item& item, std::size_t corners) {
  return converter.sink().limits().admits_string(corners * 3 * sizeof(std::int32_t), item.location);
}

void apply_faces(Converter& converter, const Item& item) {
  const State state = state_of_shape(converter, item);
  Runs runs = runs_of(item, state);
  if (!admits(converter, item, runs.left)) return;
  FaceList faces;
  auto at = static_cast<std::int32_t>(runs.next);
  std::int32_t number = 0, face = 0;
  for (const std::int32_t length : item.get<MFInt32>("numVertices")) {
    const std::size_t count = runs.take(length);
    if (count == 0) break;
    for (std::size_t i = 0; i < count; ++i) faces.corner(at++, number++, -1);
    faces.end_face(face++);
  }
  add_faces(converter, item, state, faces, {{}, {}, {}, false});
}

/// Corner of a strip: its coordinate, its number in the shape, and its entry in the shape's indices.
struct Corner {
  std::int32_t coordinate, number, entry;
};

// Adds the triangles of a strip. Every second one turns around, so that all have the same orientation.
void add_strip(FaceList& faces, std::span<const Corner> strip, std::int32_t part, std::int32_t& face) {
  for (std::size_t i = 2; i < strip.size(); ++i) {
    const bool odd = i % 2 == 1;
    for (const std::size_t at : {odd ? i - 1 : i - 2, odd ? i - 2 : i - 1, i})
      faces.corner(strip[at].coordinate, strip[at].number, strip[at].entry);
    faces.end_face(part);
    faces.face.push_back(face++);
  }
}

void apply_strips(Converter& converter, const Item& item) {
  const State state = state_of_shape(converter, item);
  Runs runs = runs_of(item, state);
  if (!admits(converter, item, 4 * runs.left)) return;
  FaceList faces;
  auto at = static_cast<std::int32_t>(runs.next);
  std::int32_t number = 0, part = 0, face = 0;
  std::vector<Corner> strip;
  for (const std::int32_t length : item.get<MFInt32>("numVertices")) {
    const std::size_t count = runs.take(length);
    if (count == 0) break;
    strip.clear();
    for (std::size_t i = 0; i < count; ++i) strip.push_back({at++, number++, -1});
    add_strip(faces, strip, part++, face);
  }
  add_faces(converter, item, state, faces, {{}, {}, {}, false});
}

void apply_indexed_strips(Converter& converter, const Item& item) {
  const State state = state_of_shape(converter, item);
  const MFInt32& index = item.get<MFInt32>("coordIndex");
  if (!admits(converter, item, 4 * index.size())) return;
  FaceList faces;
  std::int32_t number = 0, part = 0, face = 0;
  std::vector<Corner> strip;
  for (std::size_t i = 0; i <= index.size(); ++i) {
    if (i < index.size() && index[i] >= 0) {
      strip.push_back({index[i], number++, static_cast<std::int32_t>(i)});
      continue;
    }
    add_strip(faces, strip, part++, face);
    strip.clear();
  }
  add_faces(converter, item, state, faces, own_indices(item));
}

void apply_triangles(Converter& converter, const Item& item) {
  const State state = state_of_shape(converter, item);
  const MFInt32& index = item.get<MFInt32>("coordIndex");
  if (!admits(converter, item, 2 * index.size())) return;
  FaceList faces;
  std::int32_t number = 0, face = 0;
  for (std::size_t i = 0; i + 3 <= index.size(); i += 3) {
    for (std::size_t j = i; j < i + 3; ++j) faces.corner(index[j], number++, static_cast<std::int32_t>(j));
    faces.end_face(face++);
  }
  add_faces(converter, item, state, faces, own_indices(item));
}

void apply_quads(Converter& converter, const Item& item) {
  const State state = state_of_shape(converter, item);
  const Runs runs = runs_of(item, state);
  const auto columns = static_cast<std::size_t>(std::max(item.get<SFInt32>("verticesPerRow"), 0));
  const auto rows = std::min(static_cast<std::size_t>(std::max(item.get<SFInt32>("verticesPerColumn"), 0)),
                             columns > 0 ? runs.left / columns : 0);
  if (columns < 2 || rows < 2 || !admits(converter, item, 4 * rows * columns)) return;
  FaceList faces;
  std::int32_t face = 0;
  for (std::size_t row = 0; row + 1 < rows; ++row)
    for (std::size_t column = 0; column + 1 < columns; ++column) {
      const std::size_t first = row * columns + column;
      for (const std::size_t at : {first, first + columns, first + columns + 1, first + 1})
        faces.corner(static_cast<std::int32_t>(runs.next + at), static_cast<std::int32_t>(at), -1);
      faces.end_face(static_cast<std::int32_t>(row));
      faces.face.push_back(face++);
    }
  add_faces(converter, item, state, faces, {{}, {}, {}, false});
}

constexpr std::string_view kIndexedFields = R"(
  MFInt32 coordIndex 0
  MFInt32 materialIndex -1
  MFInt32 normalIndex -1
  MFInt32 textureCoordIndex -1
  SFNode vertexProperty)";
constexpr std::string_view kRunFields = "SFInt32 startIndex 0 MFInt32 numVertices -1 SFNode vertexProperty";

constexpr ItemRow kFaceRows[] = {
    {"IndexedFaceSet", ItemClass::shape, false, apply_indexed_faces, kIndexedFields},
    {"IndexedTriangleStripSet", ItemClass::shape, false, apply_indexed_strips, kIndexedFields},
    {"IndexedTriangleSet IndexedTriangleMesh", ItemClass::shape, false, apply_triangles, kIndexedFields},
    {"FaceSet", ItemClass::shape, false, apply_faces, kRunFields},
    {"TriangleStripSet", ItemClass::shape, false, apply_strips, kRunFields},
    {"QuadMesh", ItemClass::shape, false, apply_quads,
     "SFInt32 startIndex 0 SFInt32 verticesPerColumn 1 SFInt32 verticesPerRow 1 SFNode vertexProperty"},
};

}  // namespace

std::span<const ItemRow> face_rows() { return kFaceRows; }

}  // namespace gs::vrml::inventor
