#include "app/formats/volume/held_values.h"

#include "qnv/sampling/volume/color_voxels.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

/// Voxels in memory, with their share of a budget.
struct VoxelsInMemory {
  std::vector<std::byte> bytes;
  Share share;
};

/// Copies one number of each voxel into memory.
std::optional<qnv::VolumeSource> held_component(const qnv::VolumeSource& source, const WorldBudget& budget,
                                                const Progress& progress) {
  const qnv::VolumeLayout& layout = source.layout;
  const std::uint64_t slice = qnv::slice_voxels(layout) * qnv::size_of(layout.type);
  const auto voxels = std::make_shared<VoxelsInMemory>(VoxelsInMemory{{}, Share(budget, Resource::volumes)});
  if (!voxels->share.grow(slice * layout.dimensions[2])) return std::nullopt;
  voxels->bytes.resize(static_cast<std::size_t>(slice * layout.dimensions[2]));
  for (std::uint32_t z = 0; z < layout.dimensions[2]; ++z) {
    if (progress.cancelled) return std::nullopt;
    if (!source.read(
            z, std::span(voxels->bytes).subspan(static_cast<std::size_t>(slice * z), static_cast<std::size_t>(slice))))
      return std::nullopt;
  }
  qnv::VolumeSource copy;
  copy.layout = layout;
  copy.read = [voxels, slice, count = layout.dimensions[2]](std::uint32_t z, std::span<std::byte> to) {
    if (z >= count || to.size() != slice) return false;
    std::memcpy(to.data(), voxels->bytes.data() + slice * z, to.size());
    return true;
  };
  return copy;
}

/// Describes values that are those of the original volume.
std::shared_ptr<qnv::VolumeValues> exact_values(qnv::VolumeSource source) {
  const auto values = std::make_shared<qnv::VolumeValues>();
  const qnv::VolumeLayout& layout = source.layout;
  values->stored = layout.type;
  values->slope = layout.slope;
  values->intercept = layout.intercept;
  values->missing = layout.missing;
  values->exact = true;
  values->error = 0.0f;
  float least = std::numeric_limits<float>::infinity(), most = -least;
  std::vector<float> slice(qnv::slice_voxels(layout));
  std::vector<std::byte> scratch;
  for (std::uint32_t z = 0; z < layout.dimensions[2]; ++z) {
    if (!qnv::read_slice(source, z, scratch, slice)) break;
    for (const float value : slice) {
      least = std::min(least, value == value ? value : least);
      most = std::max(most, value == value ? value : most);
    }
  }
  if (least <= most) values->range = {least, most};
  values->bytes = qnv::voxel_count(layout) * qnv::size_of(layout.type);
  values->source = std::move(source);
  return values;
}

}  // namespace

std::shared_ptr<const qnv::VolumeValues> hold_values(const qnv::VolumeSource& source, const WorldBudget& budget,
                                                     const Progress& progress) {
  if (source.components.empty()) {
    auto copy = held_component(source, budget, progress);
    return copy ? exact_values(std::move(*copy)) : nullptr;
  }
  std::vector<qnv::VolumeSource> copies;
  for (const qnv::VolumeSource& component : source.components) {
    auto copy = held_component(component, budget, progress);
    if (!copy) return nullptr;
    copies.push_back(std::move(*copy));
  }
  std::vector<std::shared_ptr<const qnv::VolumeValues>> components;
  std::uint64_t bytes = 0;
  for (const qnv::VolumeSource& copy : copies) {
    components.push_back(exact_values(copy));
    bytes += components.back()->bytes;
  }
  qnv::VolumeSource main = copies.front();
  if (source.layout.colors) {
    main = qnv::color_source(copies);
  } else {
    main.layout.metadata = source.layout.metadata;
    main.components = copies;
  }
  const auto values = exact_values(std::move(main));
  values->components = std::move(components);
  values->bytes = bytes;
  return values;
}

}  // namespace gs::app
