#include "qnv/codecs/values/encode/values_stream.h"

#include "qnv/codecs/shared/stream_writer.h"
#include "qnv/codecs/values/cube_runs.h"
#include "qnv/codecs/values/encode/encode_values.h"
#include "qnv/codecs/values/encode/sampled_volume.h"
#include "qnv/codecs/values/stored_code.h"
#include "qnv/codecs/values/values_vectors.h"
#include "qnv/sampling/volume/gradients.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>

namespace gs::qnv {
namespace {

using values::SampledVolume;

Description describe(const VolumeSource& source, const SampledVolume& volume, const EncodeOptions& options) {
  const VolumeLayout& layout = source.layout;
  Description about;
  about.two_sided = true;
  about.origin = layout.base;
  about.box = voxel_box(layout);
  about.spacing = std::min({glm::length(layout.axes[0]), glm::length(layout.axes[1]), glm::length(layout.axes[2])});
  about.value_range = volume.value_range;
  about.transfer = default_transfer(volume.value_range.first, volume.value_range.second);
  about.metadata = layout.metadata;
  add_metadata(options.metadata, about);
  return about;
}

OutgoingChunk chunk_of(ChunkType type, std::vector<std::byte> payload, const Box& box) {
  OutgoingChunk chunk;
  chunk.type = type;
  chunk.payload = std::move(payload);
  chunk.entry.parent = 0xffffffff;
  chunk.entry.box = box;
  return chunk;
}

// Box of voxels from `first`, with the reach of the wavelets.
Box box_of(const VolumeLayout& layout, const values::Extent& first, const values::Extent& size, int level) {
  const double reach = std::ldexp(4.0, std::max(level - 1, 0));
  std::array<std::array<double, 2>, 3> ends{};
  for (std::size_t a = 0; a < 3; ++a)
    ends[a] = {std::max(0.0, first[a] - reach),
               std::min(layout.dimensions[a] - 1.0, static_cast<double>(first[a]) + size[a] + reach)};
  Box box;
  for (unsigned c = 0; c < 8; ++c)
    box.add(voxel_position(layout, ends[0][c & 1], ends[1][c >> 1 & 1], ends[2][c >> 2]));
  return box;
}

Box box_of_run(const VolumeLayout& layout, const values::CubeRun& run) {
  const values::Extent cubes = values::cube_extent(layout.dimensions);
  const std::uint64_t slice = std::uint64_t{cubes[0]} * cubes[1];
  const auto first = static_cast<std::uint32_t>(run.first / slice),
             last = static_cast<std::uint32_t>((run.first + run.count - 1) / slice);
  return box_of(layout, {0, 0, first * values::kCubeEdge},
                {layout.dimensions[0], layout.dimensions[1], (last - first + 1) * values::kCubeEdge}, 0);
}

// Returns the bytes of `room` that remain for clusters beside their parity.
std::size_t room_for_clusters(std::size_t room, const Protection& protection) {
  if (protection.kind == Protection::Kind::none) return room;
  // The first groups are small and have more parity than the others.
  const bool equal = protection.kind == Protection::Kind::equal;
  const double all = static_cast<double>(room),
               of_first = equal ? std::min(4000.0, all / 2) : std::min(1500.0, all / 4);
  return std::max<std::size_t>(1, static_cast<std::size_t>((all - of_first) / (1 + parity_share(protection))));
}

}  // namespace

std::variant<EncodedStream, EncodeError> encode_values(const VolumeSource& source, const EncodeOptions& options,
                                                       Progress* progress) {
  auto sampled = values::sample_volume(source, options.tolerance, progress);
  if (auto* problem = std::get_if<EncodeError>(&sampled)) return std::move(*problem);
  auto& volume = std::get<SampledVolume>(sampled);
  const VolumeLayout& layout = source.layout;
  StreamHeader header;
  header.kind = Kind::volume;
  header.payload = Payload::values;
  header.description = describe(source, volume, options);
  header.cube = Cube::around(header.description.box);
  header.grid = std::move(volume.grid);
  if (!sound(header.grid))
    return EncodeError{"the voxels are too many, too large or too far apart; expected at most 2^31 voxels"};

  std::vector<OutgoingChunk> chunks;
  if (header.grid.gaps)
    for (const values::CubeRun& run : values::encode_gaps(volume.missing, layout.dimensions))
      chunks.push_back(chunk_of(ChunkType::gaps, pack(run), box_of_run(layout, run)));
  const std::size_t before = chunks.size();
  const Protection protection = options.parity ? equal_protection(options) : Protection{Protection::Kind::unequal};
  values::ValuesLimit limit{volume.most_error, 0};
  if (options.max_bytes != 0) {
    std::size_t used = encode_header(header).size() + 12 * ValueGrid::kMaxValueErrors;
    for (const OutgoingChunk& chunk : chunks) used += chunk.payload.size() + kChunkHeaderBytes + kDirectoryEntryBytes;
    limit.max_bytes = options.max_bytes > used ? room_for_clusters(options.max_bytes - used, protection) : 1;
  }
  auto encoded = values::encode_values(volume.samples, layout.dimensions, limit, options.threads, progress);
  if (!encoded) return EncodeError{"cancelled"};
  const values::BlockLayout blocks(layout.dimensions, values::level_count(layout.dimensions));
  for (std::size_t i = 0; i < encoded->clusters.size(); ++i) {
    const values::Cluster& cluster = encoded->clusters[i];
    const values::BlockPlace place = blocks.place(cluster.block);
    OutgoingChunk chunk =
        chunk_of(ChunkType::values, pack(cluster), box_of(layout, place.first, place.size, place.level));
    chunk.entry.level = static_cast<std::uint8_t>(place.level);
    chunk.gain = encoded->gains[i];
    chunk.chain = cluster.block;
    if (cluster.index == 0 && place.level == 1)
      chunk.entry.vectors =
          static_cast<std::uint32_t>(kShownFraction * static_cast<double>(values::sample_count(place.size)));
    chunks.push_back(std::move(chunk));
  }
  for (ValueError error : encoded->errors) {
    const auto unit = static_cast<float>(std::abs(header.grid.unit));
    error.chunks += static_cast<std::uint32_t>(before);
    error.most = error.most * unit + volume.rounding;
    error.rms = std::hypot(error.rms * unit, volume.rounding / std::sqrt(3.0f));
    header.grid.errors.push_back(error);
  }
  std::vector<std::uint32_t>& remainders = header.grid.exact ? volume.codes : encoded->corrections;
  if (header.grid.exact) {
    const values::StoredCodes codes(header.grid);
    for (std::size_t i = 0; i < remainders.size(); ++i)
      remainders[i] = header.grid.gaps && volume.missing[i] != 0 ? 0 : remainders[i] - codes(volume.samples[i]);
    header.grid.errors.back().most = volume.rounding;
  } else if (!remainders.empty()) {
    header.grid.correction = values::correction_step(volume.most_error);
    for (std::size_t i = 0; i < volume.missing.size(); ++i)
      if (volume.missing[i] != 0) remainders[i] = 0;
  }
  if (!remainders.empty()) {
    for (const values::CubeRun& run : values::encode_remainders(remainders, layout.dimensions))
      chunks.push_back(chunk_of(ChunkType::remainders, pack(run), box_of_run(layout, run)));
    const auto end = static_cast<std::uint32_t>(chunks.size());
    if (!header.grid.exact)
      header.grid.errors.back().chunks = end;
    else if (header.grid.errors.back().chunks < end)
      header.grid.errors.push_back({end, 0, 0});
  }
  // A lost chunk of gaps leaves wrong values where there are none.
  if (!encoded->gains.empty())
    for (OutgoingChunk& chunk : std::span(chunks).first(before)) chunk.gain = std::ranges::max(encoded->gains);
  EncodedStream stream = write_stream(std::move(header), std::move(chunks), options.max_bytes, protection);
  if (options.max_bytes != 0 && stream.bytes.size() > options.max_bytes)
    return EncodeError{"a stream of the coarsest values has " + std::to_string(stream.bytes.size()) +
                       " bytes; expected at most " + std::to_string(options.max_bytes)};
  return stream;
}

}  // namespace gs::qnv
