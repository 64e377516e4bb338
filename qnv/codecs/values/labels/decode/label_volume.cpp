#include "qnv/codecs/values/labels/decode/label_volume.h"

#include "qnv/codecs/values/stored_code.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <memory>
#include <utility>

namespace gs::qnv::values {

namespace {

VolumeLayout label_layout(const ValueGrid& grid, const Description& about, int level) {
  VolumeLayout layout;
  layout.dimensions = low_extent(grid.dimensions, level);
  layout.origin = grid.origin;
  for (std::size_t a = 0; a < 3; ++a) {
    int steps = 0;  // an axis of one voxel stays as it is
    while (steps < level && low_extent(grid.dimensions, steps)[a] > 1) ++steps;
    const double size = std::ldexp(1.0, steps);
    layout.origin += glm::dvec3(grid.axes[a]) * ((size - 1) / 2);
    layout.axes[a] = grid.axes[a] * static_cast<float>(size);
  }
  layout.base = about.origin;
  layout.metadata = about.metadata;
  layout.slope = grid.slope;
  layout.intercept = grid.intercept;
  layout.missing = grid.missing;
  layout.labels = true;
  layout.big_endian = std::endian::native == std::endian::big;
  layout.type = !is_integer(grid.stored)        ? VoxelType::f32
                : grid.stored == VoxelType::u32 ? VoxelType::u32
                                                : VoxelType::i32;
  return layout;
}

}  // namespace

VolumeSource label_source(const ValueGrid& grid, const Description& about, const LabelLevels& levels, int level) {
  const std::uint32_t zero = is_integer(grid.stored) ? 0u : code_of(0.0f);
  LabelGrid labels = levels.labels(level, grid.palette.index(zero).value_or(0));
  std::uint32_t before = 0, code = grid.palette.code(0);
  for (std::uint32_t& label : labels.labels) {
    if (label != before) {
      before = label;
      code = grid.palette.code(label);
    }
    label = is_integer(grid.stored) ? code : std::bit_cast<std::uint32_t>(number_of_code(code));
  }
  VolumeSource source;
  source.layout = label_layout(grid, about, level);
  const std::size_t slice = std::size_t{source.layout.dimensions[0]} * source.layout.dimensions[1];
  source.read = [data = std::make_shared<const std::vector<std::uint32_t>>(std::move(labels.labels)), slice](
                    std::uint32_t z, std::span<std::byte> to) {
    if ((z + std::size_t{1}) * slice > data->size() || to.size() != slice * sizeof(std::uint32_t)) return false;
    std::memcpy(to.data(), data->data() + z * slice, to.size());
    return true;
  };
  return source;
}

std::shared_ptr<VolumeValues> label_values(const ValueGrid& grid, const Description& about, const LabelLevels& levels,
                                           int level, std::optional<std::uint32_t> in_order) {
  auto made = std::make_shared<VolumeValues>();
  made->source = label_source(grid, about, levels, level);
  made->range = about.value_range;
  made->level = level;
  made->stored = grid.stored;
  made->slope = grid.slope;
  made->intercept = grid.intercept;
  made->missing = grid.missing;
  made->bytes = std::uint64_t{4} * sample_count(made->source.layout.dimensions);
  made->exact = level == 0 && levels.is_whole();
  if (made->exact)
    made->wrong = 0.0f;
  else if (in_order)
    for (const ValueError& error : grid.errors)
      if (error.chunks <= *in_order) made->wrong = error.most;
  return made;
}

}  // namespace gs::qnv::values
