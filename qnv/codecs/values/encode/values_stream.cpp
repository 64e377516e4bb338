#include "qnv/codecs/values/encode/values_stream.h"

#include "qnv/codecs/values/encode/color_components.h"
#include "qnv/codecs/values/encode/component_encoder.h"
#include "qnv/codecs/values/encode/values_chunks.h"
#include "qnv/codecs/values/encode/write_values.h"
#include "qnv/sampling/volume/color_voxels.h"
#include "qnv/sampling/volume/gradients.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>

namespace gs::qnv {
namespace {

Description describe(const VolumeSource& source, const std::pair<float, float>& range, const EncodeOptions& options) {
  const VolumeLayout& layout = source.layout;
  Description about = volume_description(layout);
  about.value_range = range;
  about.transfer = default_transfer(range.first, range.second);
  add_metadata(options.metadata, about);
  return about;
}

// Returns an error unless the steps of a time series have one grid, and times that ascend.
std::optional<EncodeError> check_steps(const VolumeSource& source) {
  if (source.steps.empty()) return std::nullopt;
  const std::size_t numbers = std::max<std::size_t>(source.components.size(), 1);
  if (source.steps.size() < 2 || source.steps.size() > kMaxSteps || source.steps.size() * numbers > kMaxStepComponents)
    return EncodeError{"the time series has " + std::to_string(source.steps.size()) + " steps of " +
                       std::to_string(numbers) + " numbers; expected 2 to " + std::to_string(kMaxSteps) +
                       " steps, and at most " + std::to_string(kMaxStepComponents) + " numbers per voxel in all steps"};
  if (source.times.size() != source.steps.size() ||
      !std::ranges::all_of(source.times, [](double time) { return std::isfinite(time); }) ||
      std::ranges::adjacent_find(source.times, std::greater_equal<>()) != source.times.end())
    return EncodeError{"the times of the steps do not ascend; expected a later time for each step"};
  const VolumeLayout& first = source.steps.front().layout;
  for (std::size_t s = 0; s < source.steps.size(); ++s) {
    const VolumeSource& step = source.steps[s];
    const VolumeLayout& layout = step.layout;
    if (layout.dimensions != first.dimensions || layout.type != first.type || layout.slope != first.slope ||
        layout.intercept != first.intercept || layout.missing != first.missing || layout.labels ||
        layout.colors != first.colors || step.components.size() != source.steps.front().components.size())
      return EncodeError{"step " + std::to_string(s) +
                         " differs from step 0 in its size, type, scale or numbers per voxel, or has labels; expected "
                         "steps of one grid"};
  }
  return std::nullopt;
}

}  // namespace

std::variant<EncodedStream, EncodeError> encode_values(const VolumeSource& source, const EncodeOptions& options,
                                                       Progress* progress) {
  if (source.components.size() > kMaxValueComponents)
    return EncodeError{"each voxel has " + std::to_string(source.components.size()) + " numbers; expected at most " +
                       std::to_string(kMaxValueComponents) + ", or --component with one of them"};
  if (auto problem = check_steps(source)) return std::move(*problem);
  const std::span<const VolumeSource> steps = source.steps.empty() ? std::span(&source, 1) : std::span(source.steps);
  std::vector<values::ComponentPlan> plans;
  for (const VolumeSource& step : steps) {
    auto planned = values::plan_components(step, options.tolerance,
                                           // With a limited size, differences are worth it: most of them are small.
                                           !plans.empty()           ? std::optional(plans.front().luma)
                                           : options.max_bytes != 0 ? std::optional(true)
                                                                    : std::nullopt);
    if (auto* problem = std::get_if<EncodeError>(&planned)) return std::move(*problem);
    plans.push_back(std::move(std::get<values::ComponentPlan>(planned)));
  }
  const values::ComponentPlan& plan = plans.front();
  const std::size_t count = plan.components.size();
  MemoryStore memory;
  SpillStore& store = options.spill ? *options.spill : memory;
  StreamHeader header;
  header.kind = Kind::volume;
  header.payload = Payload::values;
  if (!source.steps.empty()) header.steps = {source.times, std::vector<std::uint32_t>(steps.size() * count, 0)};
  std::vector<values::ComponentParts> parts(steps.size() * count);
  std::pair<float, float> range{0, 0};
  for (std::size_t c = 0; c < count; ++c) {
    EncodeOptions own = options;
    own.tolerance = plan.components[c].tolerance;
    std::vector<VolumeSource> sources;
    for (const values::ComponentPlan& step : plans) sources.push_back(step.components[c].source);
    auto made = values::encode_component(sources, c, header, count == 1, own, store, progress);
    if (auto* problem = std::get_if<EncodeError>(&made)) return std::move(*problem);
    auto& component = std::get<values::EncodedComponent>(made);
    component.grid.components = static_cast<std::uint16_t>(count);
    if (plan.colors) component.grid.stored = VoxelType::u8;
    range = c == 0 ? component.range
                   : std::pair(std::min(range.first, component.range.first),
                               std::max(range.second, component.range.second));
    for (std::size_t s = 0; s < steps.size(); ++s) {
      values::ComponentParts& own_parts = parts[s * count + c];
      own_parts = std::move(component.steps[s]);
      if (plan.components[c].weight > 0) own_parts.weight = plan.components[c].weight;
      if (count == 1) own_parts.weight = 1;
      if (!header.steps.chunks.empty()) header.steps.chunks[s * count + c] = own_parts.chunks();
    }
    if (c == 0)
      header.grid = std::move(component.grid);
    else
      header.more_grids.push_back(std::move(component.grid));
  }
  header.description = describe(plan.components.front().source, plan.colors ? kColorRange : range, options);
  if (plan.colors) header.description.transfer = color_transfer();
  header.grid.colors = plan.colors;
  header.grid.luma = plan.luma;
  header.cube = Cube::around(header.description.box);
  const ValueGrid grid = header.grid;
  return write_values(std::move(header), values::ValuesChunks(grid, store, parts), options, "values");
}

}  // namespace gs::qnv
