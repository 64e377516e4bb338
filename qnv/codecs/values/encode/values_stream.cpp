#include "qnv/codecs/values/encode/values_stream.h"

#include "qnv/codecs/values/chunk_places.h"
#include "qnv/codecs/values/cube_runs.h"
#include "qnv/codecs/values/encode/color_components.h"
#include "qnv/codecs/values/encode/encode_values.h"
#include "qnv/codecs/values/encode/sampled_volume.h"
#include "qnv/codecs/values/encode/values_chunks.h"
#include "qnv/codecs/values/encode/write_values.h"
#include "qnv/codecs/values/stored_code.h"
#include "qnv/sampling/volume/color_voxels.h"
#include "qnv/sampling/volume/gradients.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>

namespace gs::qnv {
namespace {

using values::SampledVolume;

Description describe(const VolumeSource& source, const std::pair<float, float>& range, const EncodeOptions& options) {
  const VolumeLayout& layout = source.layout;
  Description about = volume_description(layout);
  about.value_range = range;
  about.transfer = default_transfer(range.first, range.second);
  add_metadata(options.metadata, about);
  return about;
}

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

// Returns the size that is left for the clusters of one component, beside their parity.
std::size_t room_for_clusters(const StreamHeader& header, std::span<const values::StoredRun> gaps,
                              std::size_t max_bytes, const Protection& protection) {
  std::size_t used = encode_header(header).size() + 12 * ValueGrid::kMaxValueErrors;
  for (const values::StoredRun& run : gaps) used += run.bytes + kChunkHeaderBytes + values::kMostPlaceBytes;
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

/// Component of a volume while it is encoded.
struct EncodedComponent {
  ValueGrid grid;
  values::ComponentParts parts;
  std::pair<float, float> range{0, 0};
};

// Encodes one component into a store. `header` has everything but its grid.
std::variant<EncodedComponent, EncodeError> encode_component(const VolumeSource& source, StreamHeader header,
                                                             const EncodeOptions& options, SpillStore& store,
                                                             Progress* progress) {
  auto sampled = values::sample_volume(source, options.tolerance, progress);
  if (auto* problem = std::get_if<EncodeError>(&sampled)) return std::move(*problem);
  auto& volume = std::get<SampledVolume>(sampled);
  const VolumeLayout& layout = source.layout;
  EncodedComponent made;
  made.range = volume.value_range;
  made.grid = volume.grid;
  header.grid = volume.grid;
  header.description = describe(source, made.range, options);
  header.cube = Cube::around(header.description.box);
  ValueGrid& grid = made.grid;
  values::ComponentParts& parts = made.parts;
  if (!sound(grid))
    return EncodeError{"the voxels are too many, too large or too far apart; expected at most 2^31 voxels"};
  values::SampleReader reader(source, volume, options.threads);
  if (grid.gaps)
    if (auto problem = encode_gaps(reader, layout, store, parts.gaps, progress)) return std::move(*problem);
  const std::size_t before = parts.gaps.size();
  values::ValuesLimit limit{volume.most_error, 0};
  if (options.max_bytes != 0)
    limit.max_bytes = room_for_clusters(header, parts.gaps, options.max_bytes, values_protection(options));
  auto encoding =
      values::encode_values([&](std::uint32_t first, std::uint32_t count,
                                values::SampleBatch& batch) { return reader.read(first, count, false, batch); },
                            layout.dimensions, limit, store, options.threads, progress);
  if (auto* problem = std::get_if<EncodeError>(&encoding)) return std::move(*problem);
  auto& encoded = std::get<values::EncodedValues>(encoding);
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
    else
      grid.errors.back() = {end, 0, 0};  // all remainders are 0
  }
  parts.weight = grid.unit * grid.unit;
  return made;
}

}  // namespace

std::variant<EncodedStream, EncodeError> encode_values(const VolumeSource& source, const EncodeOptions& options,
                                                       Progress* progress) {
  if (source.components.size() > kMaxValueComponents)
    return EncodeError{"each voxel has " + std::to_string(source.components.size()) + " numbers; expected at most " +
                       std::to_string(kMaxValueComponents) + ", or --component with one of them"};
  // With a limited size, differences are worth it: most of them are small.
  auto planned =
      values::plan_components(source, options.tolerance, options.max_bytes != 0 ? std::optional(true) : std::nullopt);
  if (auto* problem = std::get_if<EncodeError>(&planned)) return std::move(*problem);
  const auto& plan = std::get<values::ComponentPlan>(planned);
  const std::size_t count = plan.components.size();
  MemoryStore memory;
  SpillStore& store = options.spill ? *options.spill : memory;
  StreamHeader header;
  header.kind = Kind::volume;
  header.payload = Payload::values;
  std::vector<values::ComponentParts> parts;
  std::pair<float, float> range{0, 0};
  for (const values::PlannedComponent& one : plan.components) {
    EncodeOptions own = options;
    own.tolerance = one.tolerance;
    auto made = encode_component(one.source, header, own, store, progress);
    if (auto* problem = std::get_if<EncodeError>(&made)) return std::move(*problem);
    auto& component = std::get<EncodedComponent>(made);
    component.grid.components = static_cast<std::uint16_t>(count);
    if (plan.colors) component.grid.stored = VoxelType::u8;
    if (one.weight > 0) component.parts.weight = one.weight;
    const bool first = parts.empty();
    range =
        first ? component.range
              : std::pair(std::min(range.first, component.range.first), std::max(range.second, component.range.second));
    if (first)
      header.grid = std::move(component.grid);
    else
      header.more_grids.push_back(std::move(component.grid));
    parts.push_back(std::move(component.parts));
  }
  if (count == 1) parts.front().weight = 1;
  header.description = describe(plan.components.front().source, plan.colors ? kColorRange : range, options);
  if (plan.colors) header.description.transfer = color_transfer();
  header.grid.colors = plan.colors;
  header.grid.luma = plan.luma;
  header.cube = Cube::around(header.description.box);
  const ValueGrid grid = header.grid;
  return write_values(std::move(header), values::ValuesChunks(grid, store, parts), options, "values");
}

}  // namespace gs::qnv
