#include "qnv/codecs/values/labels/decode/label_volume.h"

#include "qnv/codecs/values/stored_code.h"
#include "qnv/codecs/values/values_vectors.h"
#include "qnv/sampling/volume/label_vectors.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <memory>
#include <utility>
#include <variant>

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

int finest_label_level(const ValueGrid& grid, std::size_t most_vectors) {
  // Maximum number of decoded labels per permitted vector.
  constexpr std::uint64_t kLabelsPerVector = 8;
  const std::uint64_t most = std::max<std::uint64_t>(kLabelsPerVector * most_vectors, 4096);
  int level = 0;
  while (level < 31) {
    const Extent part = low_extent(grid.dimensions, level);
    if (std::uint64_t{part[0]} * part[1] * part[2] <= most) break;
    ++level;
  }
  return level;
}

std::size_t most_label_vectors(const ValueGrid& grid, int level, std::size_t most_vectors) {
  const double all = static_cast<double>(sample_count(low_extent(grid.dimensions, level)));
  return std::min(most_vectors, static_cast<std::size_t>(std::ceil(kShownFraction * all)));
}

Volume label_surface(std::shared_ptr<const VolumeValues> values, GeometryBase base, std::size_t most_vectors) {
  GradientOptions options;
  options.fraction = kShownFraction;
  options.vectors = std::min<std::uint64_t>(most_vectors, options.vectors);
  options.range = base.description.value_range;
  auto found = label_vectors(values->source, options);
  auto* const vectors = std::get_if<Volume>(&found);
  Volume made = vectors ? std::move(*vectors) : Volume(GeometryBase());
  made.values = std::move(values);
  base.description.spacing = made.description.spacing;
  base.description.total = made.description.total;
  static_cast<GeometryBase&>(made) = std::move(base);
  return made;
}

std::uint32_t background_label(const LabelPalette& palette, VoxelType stored) {
  return palette.index(is_integer(stored) ? 0u : code_of(0.0f)).value_or(0);
}

void label_numbers(std::span<std::uint32_t> labels, const LabelPalette& palette, VoxelType stored) {
  const bool integers = is_integer(stored);
  std::uint32_t before = 0;
  const auto number_of = [&](std::uint32_t label) {
    const std::uint32_t code = palette.code(label);
    return integers ? code : std::bit_cast<std::uint32_t>(number_of_code(code));
  };
  std::uint32_t number = number_of(0);
  for (std::uint32_t& label : labels) {
    if (label != before) {
      before = label;
      number = number_of(label);
    }
    label = number;
  }
}

std::shared_ptr<VolumeValues> described_labels(const ValueGrid& grid, const Description& about, int level) {
  auto made = std::make_shared<VolumeValues>();
  made->source.layout = label_layout(grid, about, level);
  made->range = about.value_range;
  made->level = level;
  made->stored = grid.stored;
  made->slope = grid.slope;
  made->intercept = grid.intercept;
  made->missing = grid.missing;
  return made;
}

void note_label_errors(const ValueGrid& grid, bool whole, std::optional<std::uint32_t> in_order, VolumeValues& values) {
  values.exact = values.level == 0 && whole;
  if (values.exact)
    values.wrong = 0.0f;
  else if (in_order)
    for (const ValueError& error : grid.errors)
      if (error.chunks <= *in_order) values.wrong = error.most;
}

std::shared_ptr<VolumeValues> label_values(const ValueGrid& grid, const Description& about, const LabelLevels& levels,
                                           int level, std::optional<std::uint32_t> in_order) {
  auto made = described_labels(grid, about, level);
  made->source.read = [labels = levels.labels(level, background_label(grid.palette, grid.stored)),
                       palette = grid.palette, stored = grid.stored,
                       numbers = std::vector<std::uint32_t>()](std::uint32_t z, std::span<std::byte> to) mutable {
    const std::size_t slice = std::size_t{labels->extent[0]} * labels->extent[1];
    if (z >= labels->extent[2] || to.size() != slice * sizeof(std::uint32_t)) return false;
    const auto first = labels->labels.begin() + static_cast<std::ptrdiff_t>(z * slice);
    numbers.assign(first, first + static_cast<std::ptrdiff_t>(slice));
    label_numbers(numbers, palette, stored);
    std::memcpy(to.data(), numbers.data(), to.size());
    return true;
  };
  made->bytes = std::uint64_t{4} * sample_count(made->source.layout.dimensions);
  note_label_errors(grid, levels.is_whole(), in_order, *made);
  return made;
}

}  // namespace gs::qnv::values
