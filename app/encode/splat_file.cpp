#include "app/encode/splat_file.h"

#include "app/formats/content_types.h"
#include "app/formats/splats/splats.h"
#include "base/gzip.h"
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

/// Splats of a file, and the callback that releases them from memory.
struct FilePieces {
  SplatRows rows;
  std::size_t bytes = 0;  // size of the file
  PutAside put_aside;

  /// Calls take(splats) for all pieces. Returns false if a call does, or if a piece cannot be read.
  bool read(const std::function<bool(const qnv::Gaussians&)>& take) const {
    for (std::size_t first = 0; first < rows.count; first += kPieceRows) {
      const std::size_t count = std::min(kPieceRows, rows.count - first);
      SplatModel model;
      if (rows.read(first, count, own_budget(), model)) return false;
      const qnv::Gaussians splats = vectors_of_splats(model);
      if (!splats.empty() && !take(splats)) return false;
      if (put_aside) put_aside(std::min(bytes, rows.start + (first + count) * rows.row_bytes));
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

std::optional<SplatFile> open_splat_file(std::string_view path, std::span<const std::byte> bytes,
                                         const PutAside& put_aside) {
  return open_splat_file(path, bytes, qnv::kMostWholeGaussians, put_aside);
}

std::optional<SplatFile> open_splat_file(std::string_view path, std::span<const std::byte> bytes, std::size_t more_than,
                                         const PutAside& put_aside) {
  if (is_gzip(bytes)) return std::nullopt;
  const ContentType& type = content_type_of(path, first_bytes(bytes));
  if (!type.open_rows) return std::nullopt;
  auto opened = type.open_rows(bytes, own_budget());
  auto* const rows = std::get_if<SplatRows>(&opened);
  if (!rows || rows->count <= more_than) return std::nullopt;
  const auto pieces = std::make_shared<const FilePieces>(FilePieces{std::move(*rows), bytes.size(), put_aside});
  SplatFile file;
  qnv::GaussianSource& source = file.source;
  qnv::Description& description = source.base.description;
  WideBox box;
  const bool good = pieces->read([&](const qnv::Gaussians& splats) {
    source.degree = splats.degree;
    source.antialiased = splats.antialiased;
    source.count += splats.size();
    const qnv::Description& own = splats.description;
    description.two_sided = own.two_sided;
    // As in an import, so that the sum has the same rounding.
    for (const float area : splats.weights) description.total += static_cast<double>(area);
    box.add(own.origin + glm::dvec3(own.box.lower));
    box.add(own.origin + glm::dvec3(own.box.upper));
    add_piece(description.metadata, own.metadata);
    return true;
  });
  const auto kept = [](const auto& pair) { return pair.first == kSplatsAsDiscs; };
  if (!good || source.count == 0 || std::ranges::none_of(description.metadata, kept)) return std::nullopt;
  if (pieces->rows.announced > pieces->rows.count)
    description.metadata.emplace_back("splats missing", std::to_string(pieces->rows.announced - pieces->rows.count));
  description.origin = qnv::local_origin(box);
  description.box.add(glm::vec3(box.lower - description.origin));
  description.box.add(glm::vec3(box.upper - description.origin));
  source.read = [pieces, origin = description.origin](const std::function<bool(const qnv::Gaussians&)>& take) {
    return pieces->read([&](const qnv::Gaussians& splats) {
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
