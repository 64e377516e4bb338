#include "app/encode/mesh_stream.h"

#include "app/encode/surface_corners.h"
#include "app/formats/mesh/stl_binary.h"
#include "app/formats/ply/ply_source.h"
#include "app/formats/ply/ply_table.h"
#include "base/finite.h"
#include "qnv/base/description.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

constexpr std::uint64_t kPutAsideRuns = 20;      // number of runs to read before memory is released; 65 MB of facets
constexpr std::size_t kColorsLookedAt = 65'536;  // number of facets to check for colours
const qnv::Rgb8 kPlainGrey{204, 204, 204};       // default Material.diffuseColor (VRML97 6.27)

std::uint64_t runs_of(std::uint64_t faces) { return (faces + MeshStream::kRunFaces - 1) / MeshStream::kRunFaces; }

std::optional<MeshStream> stl_stream(std::span<const std::byte> bytes, const PutAside& put_aside) {
  const auto stl = BinaryStl::open(bytes);
  if (!stl) return std::nullopt;
  MeshStream stream;
  stream.faces = stl->size();
  const bool colored = stl->has_colors(kColorsLookedAt);
  const qnv::Rgb8 plain = stl->object_color()
                              ? to_rgb8({stl->object_color()->r, stl->object_color()->g, stl->object_color()->b})
                              : kPlainGrey;
  const auto read = [put_aside, stl = *stl, colored, plain](std::uint64_t run, const qnv::TriangleSink& sink) {
    TriangleBatches batches(sink);
    const auto first = static_cast<std::size_t>(run * MeshStream::kRunFaces);
    const std::size_t end = std::min<std::size_t>(stl.size(), first + MeshStream::kRunFaces);
    for (std::size_t i = first; i < end; ++i) {
      qnv::Rgb8 color = plain;
      if (colored) {
        const vrml::Color c = stl.color(i);
        color = to_rgb8({c.r, c.g, c.b});
      }
      if (!batches.add({stl.corners(i), {}, {color, color, color}})) return false;
    }
    if (put_aside && (run + 1) % kPutAsideRuns == 0) put_aside(BinaryStl::kDataStart + end * BinaryStl::kFacetBytes);
    return batches.flush();
  };
  stream.source = {runs_of(stream.faces), read};
  return stream;
}

/// Column of a property in rows of fixed size.
struct RowColumn {
  std::size_t offset = 0;
  PlyType type = PlyType::float32;
};

/// Returns the columns of three properties, or nullopt if a property is missing.
std::optional<std::array<RowColumn, 3>> columns_of(const PlyElement& element,
                                                   const std::array<std::string_view, 3>& names) {
  std::array<RowColumn, 3> columns;
  unsigned found = 0;
  std::size_t offset = 0;
  for (const PlyProperty& property : element.properties) {
    for (std::size_t i = 0; i < names.size(); ++i)
      if (property.name == names[i]) {
        columns[i] = {offset, property.type};
        found |= 1u << i;
      }
    offset += size_of(property.type);
  }
  return found == 7 ? std::optional(columns) : std::nullopt;
}

/// Vertices of a binary PLY file. They are read from the file when needed.
template <bool big>
class VertexRows {
 public:
  VertexRows(PlyTable table, const std::array<RowColumn, 3>& places)
      : table_(std::move(table)), stride_(table_.element.least_row_bytes()), places_(places) {
    if (auto named = columns_of(table_.element, {"red", "green", "blue"}))
      colors_ = *named;
    else if (auto diffuse = columns_of(table_.element, {"diffuse_red", "diffuse_green", "diffuse_blue"}))
      colors_ = *diffuse;
  }
  [[nodiscard]] std::size_t size() const { return table_.rows; }
  [[nodiscard]] bool has_colors() const { return colors_.has_value(); }
  [[nodiscard]] glm::dvec3 place(std::size_t row) const {
    glm::dvec3 p;
    for (std::size_t i = 0; i < 3; ++i) p[static_cast<int>(i)] = number(row, places_[i]);
    return p;
  }
  [[nodiscard]] qnv::Rgb8 color(std::size_t row) const {
    std::array<float, 3> parts{};
    for (std::size_t i = 0; i < 3; ++i) {
      const RowColumn& column = (*colors_)[i];
      const double most = column.type == PlyType::uint8 ? 255 : column.type == PlyType::uint16 ? 65535 : 1;
      parts[i] = static_cast<float>(number(row, column) / most);
    }
    return to_rgb8({parts[0], parts[1], parts[2]});
  }
  /// Returns true if the file has double coordinates, which triangles cannot store exactly.
  [[nodiscard]] bool wide() const { return places_[0].type == PlyType::float64; }

 private:
  [[nodiscard]] double number(std::size_t row, const RowColumn& column) const {
    const std::byte* const from = table_.data.data() + row * stride_ + column.offset;
    return with_type(column.type, [&](auto kind) { return static_cast<double>(load<decltype(kind), big>(from)); });
  }

  PlyTable table_;
  std::size_t stride_;
  std::array<RowColumn, 3> places_;
  std::optional<std::array<RowColumn, 3>> colors_;
};

bool lists_corners(const PlyProperty& property) {
  return property.is_list && (property.name == "vertex_indices" || property.name == "vertex_index");
}

/// Calls `each` with the corners of each face. Returns false once `each` does. Leaves `source` after the read faces.
template <bool big, class Each>
bool for_each_face(PlyBinarySource<big>& source, const PlyElement& element, const Each& each) {
  std::vector<std::int32_t> corners;
  for (std::uint64_t row = 0; row < element.count; ++row) {
    for (const PlyProperty& property : element.properties) {
      std::size_t length = 1;
      if (property.is_list) {
        std::int32_t announced = 0;
        if (!source.read_index(property.count_type, announced) || announced == kBadIndex) return true;
        length = static_cast<std::size_t>(announced);
        if (!source.may_hold(property.type, length)) return true;
      }
      if (lists_corners(property)) {
        corners.resize(length);
        if (!source.read_indices(property.type, corners)) return true;
      } else if (source.may_hold(property.type, length)) {
        source.advance(length * size_of(property.type));
      } else {
        return true;
      }
    }
    if (!each(corners)) return false;
    corners.clear();
  }
  return true;
}

/// Faces of a binary PLY file, in runs. If the size of the data says that all faces are triangles, a run has a known
/// offset. Otherwise, finding a run reads the sizes of all faces before it.
template <bool big>
class FaceRuns {
 public:
  /// `data` starts at the first face.
  FaceRuns(std::span<const std::byte> data, PlyElement faces, bool last) : data_(data), faces_(std::move(faces)) {
    std::size_t row = 0, lists = 0;
    for (const PlyProperty& property : faces_.properties) {
      row +=
          lists_corners(property) ? size_of(property.count_type) + 3 * size_of(property.type) : size_of(property.type);
      lists += property.is_list ? 1 : 0;
    }
    if (last && lists == 1 && data.size() / row == faces_.count && data.size() % row == 0) triangle_bytes_ = row;
  }

  /// Calls `each` with the corners of each face of a run. Returns false once `each` does, or at a face that is no
  /// triangle although the size of the data says so.
  template <class Each>
  bool for_each(std::uint64_t run, const Each& each) {
    PlyElement some = faces_;
    const std::uint64_t first = run * MeshStream::kRunFaces;
    some.count = std::min(MeshStream::kRunFaces, faces_.count - std::min(faces_.count, first));
    PlyBinarySource<big> source(data_.subspan(start_of(run)));
    return for_each_face(source, some, [&](std::span<const std::int32_t> corners) {
      return (triangle_bytes_ == 0 || corners.size() == 3) && each(corners);
    });
  }

 private:
  std::size_t start_of(std::uint64_t run) {
    if (triangle_bytes_ > 0)
      return static_cast<std::size_t>(
          std::min<std::uint64_t>(data_.size(), run * MeshStream::kRunFaces * triangle_bytes_));
    while (starts_.size() <= run) {
      PlyElement some = faces_;
      some.count = MeshStream::kRunFaces;
      PlyBinarySource<big> source(data_.subspan(starts_.back()));
      (void)for_each_face(source, some, [](std::span<const std::int32_t>) { return true; });
      starts_.push_back(data_.size() - source.bytes().size());
    }
    return starts_[static_cast<std::size_t>(run)];
  }

  std::span<const std::byte> data_;
  PlyElement faces_;
  std::size_t triangle_bytes_ = 0;      // bytes of each face; 0 if the sizes of faces may differ
  std::vector<std::size_t> starts_{0};  // offsets of the runs that were found
};

template <bool big>
std::optional<MeshStream> ply_stream(std::span<const std::byte> bytes, PlyTable table) {
  const auto places = columns_of(table.element, {"x", "y", "z"});
  if (!places) return std::nullopt;
  std::size_t at = 0;
  while (at < table.header.elements.size() && table.header.elements[at].name != "vertex") ++at;
  if (at + 1 >= table.header.elements.size() || table.header.elements[at + 1].name != "face") return std::nullopt;
  const PlyElement faces = table.header.elements[at + 1];
  if (std::ranges::none_of(faces.properties, lists_corners)) return std::nullopt;
  const bool last = at + 2 == table.header.elements.size();
  if (table.rows < table.element.count) return std::nullopt;
  const std::byte* const after = table.data.data() + table.rows * table.element.least_row_bytes();
  const std::span<const std::byte> data = bytes.subspan(static_cast<std::size_t>(after - bytes.data()));
  const std::size_t least = std::max<std::size_t>(1, faces.least_row_bytes());
  MeshStream stream;
  stream.faces = std::min<std::uint64_t>(faces.count, data.size() / least);
  const auto rows = std::make_shared<const VertexRows<big>>(std::move(table), *places);
  WideBox box;
  for (std::size_t i = 0; i < rows->size(); ++i)
    if (const glm::dvec3 p = rows->place(i); finite(p)) box.add(p);
  if (!box.empty()) stream.size = glm::vec3(box.upper - box.lower);
  // Only double coordinates gain precision from another origin.
  if (rows->wide()) stream.origin = qnv::local_origin(box);
  const auto runs = std::make_shared<FaceRuns<big>>(data, faces, last);
  const auto read = [rows, runs, origin = stream.origin](std::uint64_t run, const qnv::TriangleSink& sink) {
    TriangleBatches batches(sink);
    std::array<glm::vec3, 3> positions{};
    std::array<qnv::Rgb8, 3> colors{kPlainGrey, kPlainGrey, kPlainGrey};
    const bool whole = runs->for_each(run, [&](std::span<const std::int32_t> corners) {
      if (corners.size() < 3) return true;
      for (const std::int32_t corner : corners)
        if (corner < 0 || static_cast<std::size_t>(corner) >= rows->size()) return true;
      const auto take = [&](std::size_t to, std::size_t from) {
        const auto row = static_cast<std::size_t>(corners[from]);
        positions[to] = glm::vec3(rows->place(row) - origin);
        if (rows->has_colors()) colors[to] = rows->color(row);
      };
      take(0, 0);
      for (std::size_t k = 2; k < corners.size(); ++k) {
        take(1, k - 1);
        take(2, k);
        if (!batches.add({positions, {}, colors})) return false;
      }
      return true;
    });
    return whole && batches.flush();
  };
  stream.source = {runs_of(stream.faces), read};
  return stream;
}

}  // namespace

std::optional<MeshStream> open_mesh_stream(std::span<const std::byte> bytes, const PutAside& put_aside) {
  constexpr std::string_view kPly = "ply";
  if (bytes.size() < kPly.size()) return std::nullopt;
  if (std::string_view(reinterpret_cast<const char*>(bytes.data()), kPly.size()) != kPly)
    return stl_stream(bytes, put_aside);
  const auto header = ply_header_of(bytes);
  if (!header || header->format == PlyFormat::ascii) return std::nullopt;
  auto opened = open_ply_table(bytes, "vertex");
  auto* const table = std::get_if<PlyTable>(&opened);
  if (!table) return std::nullopt;
  return header->format == PlyFormat::big_endian ? ply_stream<true>(bytes, std::move(*table))
                                                 : ply_stream<false>(bytes, std::move(*table));
}

}  // namespace gs::app
