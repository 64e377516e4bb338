#include "render/splat/splat_pieces.h"

#include "render/scene/color_ramps.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace gs::render {
namespace {

constexpr unsigned kDeepestLevel = 10;  // levels from this on are red
constexpr std::size_t kAgeSteps = 64;

/// Returns the colour that distinguishes a piece of a stream. Returns nullopt for its own colours.
std::optional<qnv::Rgb8> tint_of(const qnv::Piece& piece, ColorBy color_by) {
  switch (color_by) {
    case ColorBy::level:
      return level_color(piece.level, kDeepestLevel);
    case ColorBy::chunk:
      return chunk_color(piece.chunk);
    case ColorBy::age:
      return age_color(static_cast<double>(piece.age));
    case ColorBy::own:
    case ColorBy::normal:
      break;
  }
  return std::nullopt;
}

/// Returns the first `count` vectors of a geometry as pieces. Each piece has one tint.
std::vector<SharedSplatPiece> prefix_of(const std::shared_ptr<const qnv::Splats>& splats, std::size_t count,
                                        ColorBy color_by) {
  const std::size_t all = splats->size();
  const float growth = count < all ? static_cast<float>(all) / static_cast<float>(count) : 1.0f;
  std::vector<SharedSplatPiece> pieces;
  const auto add = [&](std::size_t first, std::size_t end, const std::optional<qnv::Rgb8>& tint) {
    end = std::min(end, count);
    if (first < end) pieces.push_back({splats, first, end - first, growth, tint});
  };
  switch (color_by) {
    case ColorBy::level: {
      const unsigned deepest = octave_of(all == 0 ? 0 : all - 1);
      for (std::size_t first = 0, end = kFirstOctave; first < count; first = end, end *= 2)
        add(first, end, level_color(octave_of(first), deepest));
      break;
    }
    case ColorBy::chunk:
      for (std::size_t first = 0; first < count; first += kBlockVectors)
        add(first, first + kBlockVectors, chunk_color(static_cast<std::uint32_t>(first / kBlockVectors)));
      break;
    case ColorBy::age: {
      const std::size_t step = std::max<std::size_t>((all + kAgeSteps - 1) / kAgeSteps, 1);
      for (std::size_t first = 0; first < count; first += step)
        add(first, first + step,
            age_color(static_cast<double>(first) / static_cast<double>(std::max(all - step, step))));
      break;
    }
    case ColorBy::own:
    case ColorBy::normal:
      add(0, count, std::nullopt);
      break;
  }
  return pieces;
}

}  // namespace

std::optional<qnv::LodView> lod_view(const SplatView& view) {
  qnv::LodView lod;
  const glm::mat4 node_from_camera = glm::inverse(view.camera_from_node);
  const glm::mat4 transposed = glm::transpose(view.camera_from_node);
  lod.eye = glm::vec3(node_from_camera[3]);
  if (!std::isfinite(lod.eye.x + lod.eye.y + lod.eye.z)) return std::nullopt;
  // Distances and voxel edges are both in node units, so the scale does not matter.
  lod.pixels = 0.5f * static_cast<float>(view.height) / view.tangents.y;
  const glm::vec2 low = view.center - view.tangents, high = view.center + view.tangents;
  const std::array<glm::vec4, 5> planes{
      {{1, 0, low.x, 0}, {-1, 0, -high.x, 0}, {0, 1, low.y, 0}, {0, -1, -high.y, 0}, {0, 0, -1, -view.near_plane}}};
  for (std::size_t i = 0; i < planes.size(); ++i) lod.planes[i] = transposed * planes[i];
  return lod;
}

SplatCut cut_splats(const std::shared_ptr<const qnv::Geometry>& geometry, const SplatView& view,
                    const CutOptions& options) {
  SplatCut cut;
  if (const auto splats = qnv::shared_as<qnv::Splats>(geometry)) {
    const std::size_t all = splats->size();
    cut.pieces = prefix_of(splats, options.budget == 0 ? all : std::min(all, options.budget), options.color_by);
  }
  const auto* octree = geometry->as<qnv::OctreeSplats>();
  const std::shared_ptr<qnv::ChunkRequests>& requests = geometry->base().requests;
  if (!octree && !requests) return cut;
  auto looked = lod_view(view);
  if (!looked) return cut;
  qnv::LodView& lod = *looked;
  lod.budget = options.budget;
  lod.error_pixels = 1 / options.detail;
  lod.viewport = options.viewport;
  lod.most_decoded = options.most_decoded;
  lod.leave_backs = true;
  lod.each_chunk = options.color_by != ColorBy::own && options.color_by != ColorBy::normal;
  if (!octree) {
    requests->note(lod);
    return cut;
  }
  for (const qnv::Piece& piece : octree->stream->cut(lod))
    cut.pieces.push_back({piece.splats, piece.first, piece.count, 1, tint_of(piece, options.color_by)});
  cut.pending = octree->stream->pending();
  cut.decoded = octree->stream->statistics().decoded;
  return cut;
}

}  // namespace gs::render
