#include "qnv/codecs/voxels/encode/encode_voxels.h"

#include "base/finite.h"
#include "qnv/base/morton.h"
#include "qnv/codecs/shared/stream_writer.h"
#include "qnv/codecs/voxels/voxels.h"
#include "qnv/sampling/volume/gradients.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace gs::qnv {
namespace {

// Maximum distance of a vector from the centre of its voxel, in voxel edges. A vector farther away is not on the
// lattice.
constexpr double kOffCentre = 0.05;
// Opacity that the encoder assumes: the default of renderers.
constexpr float kShownOpacity = 2;

// Quantisation steps, which cause no visible differences at first sight.
constexpr VoxelSteps kFine{20, 16, 6, {10, 10, 12}};

float middle_weight(const Volume& volume) {
  std::vector<float> weights;
  weights.reserve(volume.size());
  for (const float weight : volume.weights)
    if (weight > 0 && std::isfinite(weight)) weights.push_back(weight);
  if (weights.empty()) return 0;
  const auto middle = weights.begin() + static_cast<std::ptrdiff_t>(weights.size() / 2);
  std::nth_element(weights.begin(), middle, weights.end());
  return *middle;
}

VoxelLattice lattice_of(const VolumeVectors& volume) {
  VoxelLattice lattice;
  const VolumeLayout& layout = volume.layout;
  lattice.origin = glm::vec3(layout.origin);
  lattice.axes = layout.axes;
  lattice.dimensions = layout.dimensions;
  lattice.unit = middle_weight(volume.vectors);
  const std::uint32_t most = *std::max_element(layout.dimensions.begin(), layout.dimensions.end());
  while (lattice.depth < kDeepestLevel && std::uint32_t{1} << lattice.depth < most) ++lattice.depth;
  float longest = 0;
  for (const glm::vec3& axis : layout.axes) longest = std::max(longest, glm::length(axis));
  for (std::size_t i = 0; i < 3; ++i) {
    const float part = glm::length(layout.axes[i]) / longest * kLongestAxis;
    lattice.lengths[i] = static_cast<std::uint16_t>(std::clamp(std::round(part), 1.0f, float{kLongestAxis}));
  }
  return lattice;
}

// Returns the vectors on the lattice, except those that cannot be drawn. Returns an empty list if a vector is not on
// the lattice.
std::vector<LatticeVector> on_lattice(const VolumeVectors& volume, const VoxelLattice& lattice) {
  const glm::dmat3 axes(lattice.axes[0], lattice.axes[1], lattice.axes[2]), to_index = glm::inverse(axes);
  std::array<glm::vec3, 3> unit_axes;
  for (std::size_t i = 0; i < 3; ++i) unit_axes[i] = glm::normalize(lattice.axes[i]);
  std::vector<LatticeVector> out;
  out.reserve(volume.vectors.size());
  for (std::size_t i = 0; i < volume.vectors.size(); ++i) {
    const float weight = volume.vectors.weights[i];
    if (!finite(volume.vectors.positions[i]) || !finite(volume.vectors.normals[i]) || !(weight > 0) ||
        !std::isfinite(weight))
      continue;
    const glm::dvec3 at = to_index * (glm::dvec3(volume.vectors.positions[i]) - glm::dvec3(lattice.origin));
    std::array<std::uint32_t, 3> cell{};
    for (unsigned a = 0; a < 3; ++a) {
      const double whole = std::round(at[static_cast<int>(a)]);
      if (!(std::abs(at[static_cast<int>(a)] - whole) < kOffCentre * (1 + std::abs(whole) / 256)) || whole < 0 ||
          whole >= lattice.dimensions[a])
        return {};
      cell[a] = static_cast<std::uint32_t>(whole);
    }
    LatticeVector vector;
    vector.key = morton_encode(cell[0], cell[1], cell[2]);
    for (int a = 0; a < 3; ++a)
      vector.gradient[a] = glm::dot(volume.vectors.normals[i], unit_axes[static_cast<unsigned>(a)]) * weight;
    vector.magnitude = weight;
    vector.value = volume.vectors.classes[i];
    out.push_back(vector);
  }
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.key < b.key; });
  const auto same = [](const auto& a, const auto& b) { return a.key == b.key; };
  if (std::adjacent_find(out.begin(), out.end(), same) != out.end()) return {};
  return out;
}

// Returns the optical depth of each class, from the transfer function in `about`.
std::vector<float> depths_of(const Description& about) {
  std::vector<float> depths;
  const std::vector<TransferPoint>& points = about.transfer;
  for (int c = 0; c < 256 && !points.empty(); ++c) {
    const float value = static_cast<float>(c) / 255;
    std::size_t next = 0;
    while (next < points.size() && points[next].value < value) ++next;
    float opacity = points[std::min(next, points.size() - 1)].opacity;
    if (next > 0 && next < points.size() && points[next].value > points[next - 1].value)
      opacity = points[next - 1].opacity + (opacity - points[next - 1].opacity) * (value - points[next - 1].value) /
                                               (points[next].value - points[next - 1].value);
    depths.push_back(-kShownOpacity * std::log(1 - std::clamp(opacity, 0.0f, 0.999f)));
  }
  return depths;
}

}  // namespace

std::variant<EncodedStream, EncodeError> encode_voxels(const VolumeVectors& volume, const EncodeOptions& options,
                                                       Progress* progress) {
  const Volume& given = volume.vectors;
  const std::size_t size = given.size();
  if (given.normals.size() != size || given.weights.size() != size || given.classes.size() != size)
    return EncodeError{"the vectors are not from a volume; expected a normal, a magnitude and a class for each"};
  StreamHeader header;
  header.kind = Kind::volume;
  header.payload = Payload::voxels;
  header.lattice = lattice_of(volume);
  if (!sound(header.lattice))
    return EncodeError{size == 0
                           ? "no vectors to encode"
                           : "the voxels are too many, too large or too far apart; expected at most 65536 per axis"};
  std::vector<LatticeVector> vectors = on_lattice(volume, header.lattice);
  if (vectors.empty()) return EncodeError{"the vectors are not at the centres of voxels"};
  header.description = given.description;
  add_metadata(options.metadata, header.description);
  header.description.total = 0;
  header.description.box = voxel_box(volume.layout);
  for (const LatticeVector& vector : vectors) header.description.total += static_cast<double>(vector.magnitude);
  header.color = given.color;
  header.cube = Cube::around(header.description.box);
  VoxelsOptions voxels;
  voxels.steps = kFine;
  voxels.threads = options.threads;
  voxels.depth_of_class = depths_of(header.description);
  if (options.max_bytes != 0) voxels.max_bytes = payload_budget(header, options.max_bytes);
  if (progress) {
    progress->stage = "encoding";
    progress->done = progress->total = 0;
  }
  std::vector<EncodedCluster> clusters = encode_voxels(std::move(vectors), header.lattice, voxels, progress);
  if (progress && progress->cancelled) return EncodeError{"cancelled"};
  std::vector<OutgoingChunk> chunks;
  for (EncodedCluster& cluster : clusters) {
    OutgoingChunk chunk;
    chunk.type = ChunkType::voxels;
    chunk.entry.level = static_cast<std::uint8_t>(cluster.header.level + cluster.header.levels);
    chunk.entry.parent = cluster.header.parent;
    chunk.entry.vectors = cluster.voxels;
    chunk.entry.box = cluster.box;
    chunk.replaced = cluster.divided;
    chunk.payload = std::move(cluster.payload);
    chunks.push_back(std::move(chunk));
  }
  EncodedStream stream =
      write_stream(std::move(header), std::move(chunks), options.max_bytes, equal_protection(options));
  if (options.max_bytes != 0 && stream.bytes.size() > options.max_bytes)
    return EncodeError{"a stream of the coarsest voxels has " + std::to_string(stream.bytes.size()) +
                       " bytes; expected at most " + std::to_string(options.max_bytes)};
  return stream;
}

}  // namespace gs::qnv
