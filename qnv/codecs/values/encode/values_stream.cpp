#include "qnv/codecs/values/encode/values_stream.h"

#include "qnv/codecs/values/cube_runs.h"
#include "qnv/codecs/values/encode/encode_values.h"
#include "qnv/codecs/values/encode/sampled_volume.h"
#include "qnv/codecs/values/encode/write_values.h"
#include "qnv/codecs/values/stored_code.h"
#include "qnv/codecs/values/values_vectors.h"
#include "qnv/sampling/volume/gradients.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
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

Box box_of_run(const VolumeLayout& layout, const values::StoredRun& run) {
  const values::Extent cubes = values::cube_extent(layout.dimensions);
  const std::uint64_t slice = std::uint64_t{cubes[0]} * cubes[1];
  const auto first = static_cast<std::uint32_t>(run.first / slice),
             last = static_cast<std::uint32_t>((run.first + run.count - 1) / slice);
  return box_of(layout, {0, 0, first * values::kCubeEdge},
                {layout.dimensions[0], layout.dimensions[1], (last - first + 1) * values::kCubeEdge}, 0);
}

/// Parts of a stream in the order of their chunks.
struct StreamParts {
  std::vector<values::StoredRun> gaps;
  std::vector<values::StoredCluster> clusters;
  std::vector<values::StoredRun> remainders;
};

/// Chunks of a values stream, with payloads in a store.
class ValuesChunks final : public ChunkList {
 public:
  ValuesChunks(const VolumeLayout& layout, const SpillStore& store, const StreamParts& parts)
      : layout_(layout),
        store_(store),
        parts_(parts),
        blocks_(layout.dimensions, values::level_count(layout.dimensions)) {
    for (const values::StoredCluster& cluster : parts.clusters)
      most_gain_ = std::max(most_gain_, static_cast<double>(cluster.gain));
  }

  [[nodiscard]] std::size_t size() const override {
    return parts_.gaps.size() + parts_.clusters.size() + parts_.remainders.size();
  }
  [[nodiscard]] std::optional<OutgoingChunk> chunk(std::size_t i) const override {
    OutgoingChunk chunk;
    chunk.entry.parent = 0xffffffff;
    const Place place = place_of(i);
    chunk.payload.resize(place.run ? place.run->bytes : place.cluster->bytes);
    if (!store_.read(place.run ? place.run->offset : place.cluster->offset, chunk.payload)) return std::nullopt;
    if (place.run) {
      chunk.type = i < parts_.gaps.size() ? ChunkType::gaps : ChunkType::remainders;
      // A lost chunk of gaps leaves wrong values where there are none.
      if (chunk.type == ChunkType::gaps) chunk.gain = most_gain_;
      chunk.entry.box = box_of_run(layout_, *place.run);
      return chunk;
    }
    const values::BlockPlace block = blocks_.place(place.cluster->block);
    chunk.type = ChunkType::values;
    chunk.entry.box = box_of(layout_, block.first, block.size, block.level);
    chunk.entry.level = static_cast<std::uint8_t>(block.level);
    chunk.gain = static_cast<double>(place.cluster->gain);
    chunk.chain = place.cluster->block;
    if (place.cluster->index == 0 && block.level == 1)
      chunk.entry.vectors =
          static_cast<std::uint32_t>(kShownFraction * static_cast<double>(values::sample_count(block.size)));
    return chunk;
  }

 private:
  /// Part of the stream that a chunk holds: a run or a cluster.
  struct Place {
    const values::StoredRun* run = nullptr;
    const values::StoredCluster* cluster = nullptr;
  };
  [[nodiscard]] Place place_of(std::size_t i) const {
    if (i < parts_.gaps.size()) return {&parts_.gaps[i], nullptr};
    i -= parts_.gaps.size();
    if (i < parts_.clusters.size()) return {nullptr, &parts_.clusters[i]};
    return {&parts_.remainders[i - parts_.clusters.size()], nullptr};
  }

  const VolumeLayout& layout_;
  const SpillStore& store_;
  const StreamParts& parts_;
  values::BlockLayout blocks_;
  double most_gain_ = 0;
};

/// Reads a volume batch by batch. Calls take(batch) for each. Returns an error if the source fails, or if cancelled.
template <class Take>
std::optional<EncodeError> each_batch(values::SampleReader& reader, const VolumeLayout& layout, bool codes,
                                      Progress* progress, Take&& take) {
  values::SampleBatch batch;
  const std::uint32_t depth = layout.dimensions[2];
  if (progress) {
    progress->stage = "sampling";
    progress->done = 0;
    progress->total = depth;
  }
  for (std::uint32_t z = 0; z < depth; z += values::kBatchSlices) {
    if (is_cancelled(progress)) return EncodeError{"cancelled"};
    if (auto problem = reader.read(z, std::min(values::kBatchSlices, depth - z), codes, batch)) return problem;
    take(batch);
    if (progress) progress->done = z + batch.count;
  }
  return std::nullopt;
}

// Adds the layers of a batch to an encoder of runs.
template <class Number>
void add_layers(std::span<const Number> numbers, const VolumeLayout& layout, values::RunEncoder<Number>& encoder) {
  const std::size_t layer = slice_voxels(layout) * values::kCubeEdge;
  for (std::size_t at = 0; at < numbers.size(); at += layer)
    encoder.add(numbers.subspan(at, std::min(layer, numbers.size() - at)));
}

// Stores the gaps of a volume, and lets `reader` fill them.
std::optional<EncodeError> encode_gaps(values::SampleReader& reader, const VolumeLayout& layout, SpillStore& store,
                                       std::vector<values::StoredRun>& runs, Progress* progress) {
  std::optional<EncodeError> problem;
  values::GapEncoder encoder(layout.dimensions,
                             [&](values::CubeRun&& run) { values::store_run(run, store, runs, problem); });
  if (auto failed = each_batch(reader, layout, false, progress, [&](const values::SampleBatch& batch) {
        reader.measure_gaps(batch);
        add_layers(std::span(batch.missing), layout, encoder);
      }))
    return failed;
  encoder.finish();
  reader.prepare_gaps();
  return problem;
}

// Stores the differences between the stored voxels and the samples.
std::optional<EncodeError> encode_codes(values::SampleReader& reader, const VolumeLayout& layout, const ValueGrid& grid,
                                        SpillStore& store, std::vector<values::StoredRun>& runs, Progress* progress) {
  std::optional<EncodeError> problem;
  values::RemainderEncoder encoder(layout.dimensions,
                                   [&](values::CubeRun&& run) { values::store_run(run, store, runs, problem); });
  const values::StoredCodes codes(grid);
  if (auto failed = each_batch(reader, layout, true, progress, [&](values::SampleBatch& batch) {
        for (std::size_t i = 0; i < batch.codes.size(); ++i)
          batch.codes[i] =
              !batch.missing.empty() && batch.missing[i] != 0 ? 0 : batch.codes[i] - codes(batch.samples[i]);
        add_layers(std::span<const std::uint32_t>(batch.codes), layout, encoder);
      }))
    return failed;
  encoder.finish();
  return problem;
}

// Returns the size that is left for the clusters, beside their parity.
std::size_t room_for_clusters(const StreamHeader& header, const StreamParts& parts, std::size_t max_bytes,
                              const Protection& protection) {
  std::size_t used = encode_header(header).size() + 12 * ValueGrid::kMaxValueErrors;
  for (const values::StoredRun& run : parts.gaps) used += run.bytes + kChunkHeaderBytes + kDirectoryEntryBytes;
  const std::size_t room = max_bytes > used ? max_bytes - used : 1;
  if (room == 1 || protection.kind == Protection::Kind::none) return room;
  // The first groups are small and have more parity than the others.
  const bool equal = protection.kind == Protection::Kind::equal;
  const double all = static_cast<double>(room),
               of_first = equal ? std::min(4000.0, all / 2) : std::min(1500.0, all / 4);
  return std::max<std::size_t>(1, static_cast<std::size_t>((all - of_first) / (1 + parity_share(protection))));
}

void set_errors(std::vector<ValueError> errors, std::size_t before, float rounding, ValueGrid& grid) {
  for (ValueError error : errors) {
    const auto unit = static_cast<float>(std::abs(grid.unit));
    error.chunks += static_cast<std::uint32_t>(before);
    error.most = error.most * unit + rounding;
    error.rms = std::hypot(error.rms * unit, rounding / std::sqrt(3.0f));
    grid.errors.push_back(error);
  }
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
  header.grid = volume.grid;
  ValueGrid& grid = header.grid;
  if (!sound(grid))
    return EncodeError{"the voxels are too many, too large or too far apart; expected at most 2^31 voxels"};

  MemoryStore memory;
  SpillStore& store = options.spill ? *options.spill : memory;
  values::SampleReader reader(source, volume, options.threads);
  StreamParts parts;
  if (grid.gaps)
    if (auto problem = encode_gaps(reader, layout, store, parts.gaps, progress)) return std::move(*problem);
  const std::size_t before = parts.gaps.size();
  values::ValuesLimit limit{volume.most_error, 0};
  if (options.max_bytes != 0)
    limit.max_bytes = room_for_clusters(header, parts, options.max_bytes, values_protection(options));
  auto made = values::encode_values([&](std::uint32_t first, std::uint32_t count,
                                        values::SampleBatch& batch) { return reader.read(first, count, false, batch); },
                                    layout.dimensions, limit, store, options.threads, progress);
  if (auto* problem = std::get_if<EncodeError>(&made)) return std::move(*problem);
  auto& encoded = std::get<values::EncodedValues>(made);
  parts.clusters = std::move(encoded.clusters);
  set_errors(std::move(encoded.errors), before, volume.rounding, grid);
  if (grid.exact) {
    if (auto problem = encode_codes(reader, layout, grid, store, parts.remainders, progress))
      return std::move(*problem);
    grid.errors.back().most = volume.rounding;
  } else if (!encoded.corrections.empty()) {
    parts.remainders = std::move(encoded.corrections);
    grid.correction = values::correction_step(volume.most_error);
  }
  if (!parts.remainders.empty() || grid.exact) {
    const auto end = static_cast<std::uint32_t>(before + parts.clusters.size() + parts.remainders.size());
    if (!grid.exact)
      grid.errors.back().chunks = end;
    else if (grid.errors.back().chunks < end)
      grid.errors.push_back({end, 0, 0});
  }
  return write_values(std::move(header), ValuesChunks(layout, store, parts), options, "values");
}

}  // namespace gs::qnv
