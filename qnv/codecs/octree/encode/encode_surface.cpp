#include "qnv/codecs/octree/encode/encode_surface.h"

#include "qnv/base/voxels.h"
#include "qnv/codecs/lossless/encode/surface_tail.h"
#include "qnv/codecs/octree/packed.h"
#include "qnv/codecs/records/encode/encode_vectors.h"
#include "qnv/codecs/shared/encode_options.h"
#include "qnv/codecs/shared/shared_records.h"
#include "qnv/codecs/shared/stream_writer.h"
#include "qnv/codecs/shared/surface_header.h"
#include "qnv/mesh/survey.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace gs::qnv {
namespace {

constexpr std::size_t kMinVectors = 200'000, kMaxVectorsByDefault = 1'000'000;
// Average number of voxels that a plane intersects per voxel-face area, over all directions of the plane.
constexpr double kVoxelsPerArea = 1.5;
// Lower estimate of the bits per splat. A low value lets the stream use all of --max-bytes.
constexpr double kMinBitsPerVector = 3.5;

// Size of the octree before an exact mesh: the mesh's bytes divided by kBeforeMesh, but at least kMinBeforeMesh bytes.
constexpr std::size_t kBeforeMesh = 2, kMinBeforeMesh = 4000;

int level_for(double vectors, const SurfaceSurvey& s, const Cube& cube) {
  const double faces = s.area / (static_cast<double>(cube.edge) * cube.edge);
  int level = 1;
  while (level < kDeepestLevel && kVoxelsPerArea * faces * std::pow(4.0, level) < vectors) ++level;
  return level;
}

// Converts voxels to vectors at the mean position of the surface inside. A voxel that the surface cuts only at a corner
// has a small area. Therefore the voxels of each block of 4 x 4 x 4 share their total area evenly. No area is lost, and
// splats of equal size leave no gaps.
Splats splats_of(std::span<const Voxel> voxels, const Cube& cube, int level, const SurfaceSurvey& s) {
  Splats splats;
  const float edge = cube.edge / static_cast<float>(1 << level);
  std::size_t block = 0, block_end = 0;
  float share = 0;
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const Voxel& voxel = voxels[i];
    if (i == block_end) {
      double area = 0;
      for (block = i; block_end < voxels.size() && voxels[block_end].key >> 6 == voxel.key >> 6; ++block_end)
        area += voxels[block_end].moments.area;
      share = static_cast<float>(area / static_cast<double>(block_end - block));
    }
    const SurfaceMoments& m = voxel.moments;
    const float length = std::sqrt(glm::dot(m.normal, m.normal));
    if (!(m.area > 0) || !(length > 0)) continue;
    const glm::vec3 inside = m.position / m.area + 0.5f + voxel_cell(voxel.key);
    splats.positions.push_back(cube.lower + inside * edge);
    splats.normals.push_back(m.normal / length);
    splats.weights.push_back(share * edge * edge);
    if (!s.colored) continue;
    const glm::vec3 c = m.color / m.area + 0.5f;
    splats.colors.push_back({static_cast<std::uint8_t>(std::clamp(c.x, 0.0f, 255.0f)),
                             static_cast<std::uint8_t>(std::clamp(c.y, 0.0f, 255.0f)),
                             static_cast<std::uint8_t>(std::clamp(c.z, 0.0f, 255.0f))});
  }
  splats.color = s.mean_color();
  return splats;
}

std::vector<OutgoingChunk> packed_chunks(std::vector<Voxel> voxels, int level, StreamHeader& header,
                                         const EncodeOptions& options, Progress* progress) {
  PackedOptions packed;
  packed.vectors = options.vectors;
  packed.colored = header.colored;
  packed.threads = options.threads;
  if (options.max_bytes != 0) packed.max_bytes = payload_budget(header, options.max_bytes);
  std::vector<OutgoingChunk> chunks;
  for (EncodedCluster& cluster : encode_packed(std::move(voxels), level, header.cube, packed, progress)) {
    OutgoingChunk chunk;
    chunk.replaced = cluster.divided;
    chunk.type = ChunkType::packed;
    chunk.entry.level = static_cast<std::uint8_t>(cluster.header.level + cluster.header.levels);
    chunk.entry.parent = cluster.header.parent;
    chunk.entry.vectors = cluster.voxels;
    chunk.entry.box = cluster.box;
    chunk.payload = std::move(cluster.payload);
    chunks.push_back(std::move(chunk));
  }
  return chunks;
}

/// Appends the exact mesh after the octree if the mesh is small enough; then shortens the octree. Returns false if the
/// source cannot be read.
bool append_mesh(const TriangleSource& source, const SurfaceSurvey& s, const EncodeOptions& options,
                 StreamHeader& header, std::vector<OutgoingChunk>& chunks) {
  const TexturedSurface* textured = options.textured;
  const bool asked = options.exact_bits > 0;
  if (!asked && (textured ? textured->triangles.size() : s.triangles) > kMaxChosenTriangles) return true;
  const displaced::Frame frame(s.box);
  exact::ExactMesh mesh;
  if (textured) {
    mesh = exact_mesh_of(*textured, frame, std::max(options.exact_bits, 0));
  } else {
    // Splits the surface where parts of different colours touch, so that colour borders stay sharp.
    displaced::MeshBuilder builder(s.colored, true);
    const bool read = source([&](std::span<const Triangle> triangles) {
      builder.add(triangles);
      return true;
    });
    if (!read) return false;
    mesh = exact_mesh_of(builder, frame, s.colored, std::max(options.exact_bits, 0));
  }
  SurfaceTail tail = tail_of(mesh, asked ? fewest_tail_bits(mesh) : first_tail_bits(mesh));
  if (textured) set_picture(tail, *textured);
  tail.parity = !asked;
  const std::size_t before = tail.bytes.size() + tail.picture_first,
                    most = std::max(kMinBeforeMesh, before / kBeforeMesh);
  if (tail.bytes.empty() || tail.size() > exact::kMaxTailBytes ||
      (options.max_bytes != 0 && tail.size() + most > options.max_bytes))
    return true;
  std::size_t bytes = 0, kept = 0;
  for (; kept < chunks.size() && (kept == 0 || bytes + chunks[kept].payload.size() <= most); ++kept)
    bytes += chunks[kept].payload.size();
  chunks.resize(kept);
  header.meshed = true;
  append_tail(tail, s.box, chunks);
  return true;
}

/// Returns the voxels of a surface at a level on rank 0, else an empty list. Ranks share the triangles.
std::variant<std::vector<Voxel>, EncodeError> cut_voxels(EncodeRanks& shared, const TriangleSource& source,
                                                         const SurfaceSurvey& s, const Cube& cube, int level,
                                                         unsigned threads, Progress* progress) {
  if (progress) {
    progress->stage = "cutting";
    progress->done = 0;
    progress->total = s.triangles / shared.count();
  }
  SurfaceVoxelizer voxelizer(cube, level, threads);
  auto problem = read_share(
      shared, source,
      [&](std::span<const Triangle> triangles) {
        voxelizer.add(triangles);
        if (progress) progress->done += triangles.size();
        return true;
      },
      progress);
  if (problem) {
    if (problem->message == kUnreadable) problem->message += " again";
    return std::move(*problem);
  }
  auto merged = merged_records(shared, voxelizer.sums(), false);
  if (auto* failed = std::get_if<EncodeError>(&merged)) return std::move(*failed);
  return voxels_of(std::get<std::vector<VoxelSums>>(merged));
}

/// Encodes a surface with the payload `packed` or `records`. Only rank 0 returns the stream.
std::variant<EncodedStream, EncodeError> encode_as(Payload payload, const TriangleSource& source,
                                                   const EncodeOptions& options, Progress* progress) {
  if (progress) progress->stage = "reading";
  EncodeRanks shared(options);
  auto surveyed = survey_of(shared, source, progress);
  if (auto* failed = std::get_if<EncodeError>(&surveyed)) return std::move(*failed);
  const SurfaceSurvey& s = std::get<SurfaceSurvey>(surveyed);
  if (!s.sound()) return EncodeError{"no surface to encode; expected triangles with an area"};
  std::size_t vectors = options.vectors;
  if (vectors == 0)
    vectors = options.max_bytes != 0
                  ? static_cast<std::size_t>(static_cast<double>(options.max_bytes) * 8 / kMinBitsPerVector)
                  : std::clamp(s.triangles * 2, kMinVectors, kMaxVectorsByDefault);
  StreamHeader header = surface_header(payload, s, options);
  // Without a requested number or size, uses all voxels of a slightly coarser level.
  const bool asked = options.vectors != 0 || options.max_bytes != 0;
  const int level = level_for(static_cast<double>(vectors) * (asked ? 1.0 : 0.5), s, header.cube);
  auto cut = cut_voxels(shared, source, s, header.cube, level, options.threads, progress);
  if (auto* failed = std::get_if<EncodeError>(&cut)) return std::move(*failed);
  if (shared.rank() != 0) return EncodedStream{};
  std::vector<Voxel> voxels = std::move(std::get<std::vector<Voxel>>(cut));
  if (progress) {
    progress->stage = "encoding";
    progress->done = progress->total = 0;
  }
  if (payload == Payload::records) {
    Splats splats = splats_of(voxels, header.cube, level, s);
    splats.description = header.description;
    EncodeOptions rest = options;
    rest.vectors = vectors;
    return encode_vectors(splats, rest, progress);
  }
  std::vector<OutgoingChunk> chunks = packed_chunks(std::move(voxels), level, header, options, progress);
  if (is_cancelled(progress)) return EncodeError{"cancelled"};
  if (chunks.empty()) return EncodeError{"no surface to encode; expected triangles with an area"};
  if (options.exact_bits != 0 && !append_mesh(source, s, options, header, chunks))
    return EncodeError{is_cancelled(progress) ? "cancelled" : "the surface cannot be read again"};
  EncodedStream stream = write_stream(std::move(header), std::move(chunks), options.max_bytes);
  if (options.max_bytes != 0 && stream.bytes.size() > options.max_bytes)
    return EncodeError{"the coarsest picture has " + std::to_string(stream.bytes.size()) + " bytes; expected at most " +
                       std::to_string(options.max_bytes)};
  return stream;
}

}  // namespace

std::variant<EncodedStream, EncodeError> encode_surface(const TriangleSource& source, const EncodeOptions& options,
                                                        Progress* progress) {
  EncodeRanks shared(options);
  return result_of_first(shared, encode_as(Payload::packed, source, options, progress));
}

std::variant<EncodedStream, EncodeError> encode_surface_records(const TriangleSource& source,
                                                                const EncodeOptions& options, Progress* progress) {
  EncodeRanks shared(options);
  return result_of_first(shared, encode_as(Payload::records, source, options, progress));
}

}  // namespace gs::qnv
