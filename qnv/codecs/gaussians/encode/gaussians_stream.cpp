#include "qnv/codecs/gaussians/encode/gaussians_stream.h"

#include "qnv/codecs/gaussians/encode/merge_tree.h"
#include "qnv/codecs/gaussians/encode/splat_clusters.h"
#include "qnv/codecs/gaussians/harmonics_code.h"
#include "qnv/codecs/shared/outgoing_chunk.h"
#include "qnv/codecs/shared/stream_writer.h"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gs::qnv {
namespace gaussians {
namespace {

// Share of the Gaussians that are less important than those with the finest steps.
constexpr double kLessImportant = 0.6;
// Points are details of this size, relative to MergeTree::detail().
constexpr double kPoint = 1.0 / 16;
// Most lattice steps along the longest edge of the box, so that codes of places stay below their limit.
constexpr double kMostSteps = 1 << 21;
// Coded bytes of harmonics at which a chunk ends. One leaf adds less than the difference to kMostClusterBytes.
constexpr std::size_t kHarmonicsEnd = 900;

bool finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// Returns an error if the source cannot be encoded.
std::optional<EncodeError> problem_of(const Gaussians& source) {
  if (source.empty()) return EncodeError{"the source has no Gaussians; expected at least one"};
  if (source.degree < 0 || source.degree > Gaussians::kMaxDegree)
    return EncodeError{"the spherical harmonics have degree " + std::to_string(source.degree) + "; expected 0 to 3"};
  if (source.size() > std::numeric_limits<std::uint32_t>::max() / 4)
    return EncodeError{"there are " + std::to_string(source.size()) + " Gaussians; expected at most 2^30"};
  for (std::size_t i = 0; i < source.size(); ++i) {
    const glm::vec4& q = source.rotations[i];
    if (!finite(source.positions[i]) || !finite(source.scales[i]) || !finite(source.bases[i]) ||
        !std::isfinite(q.x + q.y + q.z + q.w) || !std::isfinite(source.opacities[i]))
      return EncodeError{"Gaussian " + std::to_string(i) + " is not finite; expected finite numbers"};
  }
  return std::nullopt;
}

Precision precision_of(const Gaussians& source, const Box& box, float detail) {
  Precision precision;
  precision.box = box;
  const glm::vec3 size = precision.box.size();
  const double edge = std::max({size.x, size.y, size.z});
  precision.finest = scale_code(std::max(detail * kPoint, edge / kMostSteps));
  std::vector<int> all(source.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::array<int, 3> scales{};
    for (std::size_t k = 0; k < 3; ++k) scales[k] = scale_code(source.scales[i][static_cast<int>(k)]);
    std::ranges::sort(scales, std::ranges::greater{});
    all[i] = importance(scales, opacity_code(source.opacities[i]));
  }
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(kLessImportant * static_cast<double>(all.size() - 1));
  std::ranges::nth_element(all, middle);
  precision.important = std::clamp<int>(*middle, -32768, 32767);
  return precision;
}

/// Returns the bounds of the Gaussians, cut by the box of the stream.
Box box_of(std::span<const SplatNode> nodes, const Box& whole) {
  constexpr float kReach = 3;  // standard deviations
  Box box;
  for (const SplatNode& node : nodes) {
    const glm::vec3 reach(kReach * static_cast<float>(scale_of(node.scales[0])));
    const glm::vec3 lower = node.position - reach, upper = node.position + reach;
    box.add(glm::max(lower, whole.lower));
    box.add(glm::min(upper, whole.upper));
  }
  return box;
}

/// Appends the chunks with the harmonics of a cluster.
void add_harmonics(const Gaussians& source, const EncodedCluster& cluster, const Precision& precision,
                   const DirectoryEntry& entry, std::vector<OutgoingChunk>& chunks) {
  const std::size_t per = harmonic_count(source.degree);
  std::vector<const SplatNode*> leaves;
  for (const SplatNode& node : cluster.nodes)
    if (node.leaf) leaves.push_back(&node);
  for (std::size_t first = 0; first < leaves.size();) {
    BinaryEncoder encoder;
    Writer writer{encoder};
    HarmonicModels models;
    std::size_t last = first;
    for (; last < leaves.size() && encoder.size() < kHarmonicsEnd; ++last) {
      std::array<std::array<int, 3>, harmonic_count(Gaussians::kMaxDegree)> codes{};
      const double step = harmonic_step(*leaves[last], precision);
      for (std::size_t k = 0; k < per; ++k) {
        const glm::vec3& own = source.harmonics[cluster.sources[last] * per + k];
        if (finite(own)) codes[k] = color_code(own, step);
      }
      code_harmonics(writer, models, source.degree, codes);
    }
    OutgoingChunk chunk;
    chunk.type = ChunkType::harmonics;
    chunk.payload = pack(
        HarmonicsHead{cluster.head.id, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last - first)},
        encoder.finish());
    chunk.entry = entry;
    chunk.entry.vectors = 0;
    chunks.push_back(std::move(chunk));
    first = last;
  }
}

/// Adds the gain of each chunk to that of its parent, which it needs.
void add_gains(std::vector<OutgoingChunk>& chunks) {
  for (std::size_t i = chunks.size(); i-- > 1;)
    if (chunks[i].entry.parent < i) chunks[chunks[i].entry.parent].gain += chunks[i].gain;
}

}  // namespace
}  // namespace gaussians

std::variant<EncodedStream, EncodeError> encode_gaussians(const Gaussians& source, const EncodeOptions& options,
                                                          Progress* progress) {
  using namespace gaussians;
  if (auto problem = problem_of(source)) return std::move(*problem);
  const EncodeError cancelled{"cancelled"};
  const auto tree = MergeTree::build(source, options.threads, progress);
  if (!tree) return cancelled;
  StreamHeader header;
  header.payload = Payload::gaussians;
  header.description = source.description;
  for (const glm::vec3& p : source.positions) header.description.box.add(p);
  add_metadata(options.metadata, header.description);
  header.colored = true;
  header.color = source.color;
  Precision precision = precision_of(source, header.description.box, tree->detail());
  precision.steps = std::clamp(options.splat_steps, -GaussianCoding::kMostSteps, GaussianCoding::kMostSteps);
  header.cube = Cube::around(header.description.box);
  header.gaussians = {precision.important, precision.finest, precision.steps, source.degree, source.antialiased};
  std::vector<OutgoingChunk> chunks, harmonics;
  std::size_t shown = 0, bytes = 0;
  const auto take = [&](EncodedCluster&& cluster) {
    OutgoingChunk chunk;
    chunk.type = ChunkType::gaussians;
    chunk.payload = pack(cluster.head, cluster.bytes);
    chunk.entry.level = static_cast<std::uint8_t>(std::min<std::uint32_t>(cluster.head.level, 255));
    chunk.entry.parent = cluster.head.parent;
    chunk.entry.vectors = static_cast<std::uint32_t>(cluster.nodes.size());
    chunk.entry.box = box_of(cluster.nodes, precision.box);
    chunk.replaced = cluster.head.parent == ClusterHead::kNoParent ? 0 : cluster.replaced;
    chunk.gain = std::max(cluster.gain, 0.0);
    shown += cluster.nodes.size() - chunk.replaced;
    bytes += chunk.payload.size();
    if (source.degree > 0) {
      DirectoryEntry entry = chunk.entry;
      entry.parent = cluster.head.id;
      add_harmonics(source, cluster, precision, entry, harmonics);
    }
    chunks.push_back(std::move(chunk));
    return (options.vectors == 0 || shown < options.vectors) && (options.max_bytes == 0 || bytes < options.max_bytes);
  };
  if (!encode_clusters(source, *tree, precision, take, progress)) return cancelled;
  add_gains(chunks);
  for (OutgoingChunk& chunk : harmonics) chunks.push_back(std::move(chunk));
  const Protection protection = options.parity ? equal_protection(options) : Protection{Protection::Kind::unequal};
  return write_stream(std::move(header), std::move(chunks), options.max_bytes, protection);
}

}  // namespace gs::qnv
