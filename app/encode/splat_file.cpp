#include "app/encode/splat_file.h"

#include "app/formats/ply/ply_table.h"
#include "app/formats/splats/splats.h"
#include "qnv/codecs/gaussians/encode/gaussians_stream.h"

#include <algorithm>
#include <charconv>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

// Number of rows per piece.
constexpr std::size_t kPieceRows = std::size_t{1} << 15;

/// Rows of a file, and the callback that releases them from memory.
struct SplatRows {
  PlyTable table;
  std::size_t start = 0;  // offset of the rows in the file
  PutAside put_aside;

  /// Calls take(splats) for all pieces. Returns false if a call does, or if a piece cannot be read.
  bool read(const std::function<bool(const qnv::Gaussians&)>& take) const {
    const std::size_t row = table.element.least_row_bytes();
    for (std::size_t first = 0; first < table.rows; first += kPieceRows) {
      PlyTable piece;
      piece.header = table.header;
      piece.element = table.element;
      piece.rows = std::min(kPieceRows, table.rows - first);
      piece.element.count = piece.rows;
      piece.data = table.data.subspan(first * row, piece.rows * row);
      SplatModel model;
      if (read_splats(piece, model, own_budget())) return false;
      const qnv::Gaussians splats = vectors_of_splats(model);
      if (!splats.empty() && !take(splats)) return false;
      if (put_aside) put_aside(start + (first + piece.rows) * row);
    }
    return true;
  }
};

/// Merges the metadata of a piece into that of the file: adds counts, and keeps the first of other texts.
void add_piece(std::vector<std::pair<std::string, std::string>>& all,
               const std::vector<std::pair<std::string, std::string>>& piece) {
  for (const auto& [key, value] : piece) {
    const auto same = std::ranges::find(all, key, [](const auto& pair) { return pair.first; });
    std::uint64_t more = 0, before = 0;
    const auto number = std::from_chars(value.data(), value.data() + value.size(), more);
    const bool counts = number.ec == std::errc() && number.ptr == value.data() + value.size();
    if (same == all.end())
      all.emplace_back(key, value);
    else if (counts &&
             std::from_chars(same->second.data(), same->second.data() + same->second.size(), before).ec == std::errc())
      same->second = std::to_string(before + more);
  }
}

}  // namespace

std::optional<SplatFile> open_splat_file(std::span<const std::byte> bytes, const PutAside& put_aside) {
  return open_splat_file(bytes, qnv::kMostWholeGaussians, put_aside);
}

std::optional<SplatFile> open_splat_file(std::span<const std::byte> bytes, std::size_t more_than,
                                         const PutAside& put_aside) {
  if (!is_splats_ply(bytes)) return std::nullopt;
  const auto header = ply_header_of(bytes);
  if (!header || header->format == PlyFormat::ascii) return std::nullopt;
  auto opened = open_ply_table(bytes, "vertex");
  auto* const table = std::get_if<PlyTable>(&opened);
  if (!table || table->rows <= more_than) return std::nullopt;
  const auto start = static_cast<std::size_t>(table->data.data() - bytes.data());
  const auto rows = std::make_shared<const SplatRows>(SplatRows{std::move(*table), start, put_aside});
  SplatFile file;
  qnv::GaussianSource& source = file.source;
  qnv::Description& description = source.base.description;
  WideBox box;
  const bool good = rows->read([&](const qnv::Gaussians& splats) {
    source.degree = splats.degree;
    source.antialiased = splats.antialiased;
    source.count += splats.size();
    const qnv::Description& own = splats.description;
    description.two_sided = own.two_sided;
    description.total += own.total;
    box.add(own.origin + glm::dvec3(own.box.lower));
    box.add(own.origin + glm::dvec3(own.box.upper));
    add_piece(description.metadata, own.metadata);
    return true;
  });
  const auto kept = [](const auto& pair) { return pair.first == kSplatsAsDiscs; };
  if (!good || source.count == 0 || std::ranges::none_of(description.metadata, kept)) return std::nullopt;
  if (rows->table.element.count > rows->table.rows)
    description.metadata.emplace_back("splats missing", std::to_string(rows->table.element.count - rows->table.rows));
  description.origin = qnv::local_origin(box);
  description.box.add(glm::vec3(box.lower - description.origin));
  description.box.add(glm::vec3(box.upper - description.origin));
  source.read = [rows, origin = description.origin](const std::function<bool(const qnv::Gaussians&)>& take) {
    return rows->read([&](const qnv::Gaussians& splats) {
      if (splats.description.origin == origin) return take(splats);
      qnv::Gaussians moved = splats;
      const glm::dvec3 move = splats.description.origin - origin;
      for (glm::vec3& p : moved.positions) p = glm::vec3(glm::dvec3(p) + move);
      return take(moved);
    });
  };
  return file;
}

}  // namespace gs::app
