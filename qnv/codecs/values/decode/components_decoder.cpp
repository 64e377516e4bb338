#include "qnv/codecs/values/block_places.h"
#include "qnv/codecs/values/component_number.h"
#include "qnv/codecs/values/cube_runs.h"
#include "qnv/codecs/values/decode/values_part.h"
#include "qnv/codecs/values/values_vectors.h"
#include "qnv/sampling/volume/color_voxels.h"
#include "qnv/sampling/volume/component_values.h"
#include "qnv/sampling/volume/gradients.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv {
namespace {

/// Decoder of a stream with several numbers per voxel: one decoder for each. It shows one of them, or their magnitude.
class ComponentsDecoder final : public Decoder {
 public:
  ComponentsDecoder(const StreamHeader& header, std::size_t most_vectors)
      : most_vectors_(std::max<std::size_t>(1, most_vectors / header.grid.components)),
        colors_(header.grid.colors),
        luma_(header.grid.luma) {
    const values::Extent extent = header.grid.dimensions, cubes = values::cube_extent(extent);
    counts_ = {values::BlockLayout(extent, values::level_count(extent)).count(),
               std::uint64_t{cubes[0]} * cubes[1] * cubes[2]};
    for (std::size_t c = 0; c < header.grid.components; ++c) {
      StreamHeader one = header;
      if (c > 0) one.grid = header.more_grids[c - 1];
      one.grid.components = 1;
      one.grid.colors = one.grid.luma = false;
      one.more_grids.clear();
      parts_.push_back(values::make_values_part(one, most_vectors_));
    }
  }

  void add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing) override {
    const auto split = values::without_component(payload, type == ChunkType::values ? counts_.blocks : counts_.cubes);
    if (!split || split->component >= parts_.size())
      ++refused_;
    else
      parts_[split->component]->add(type, split->payload, missing);
    length_.reset();
  }
  [[nodiscard]] DecodeCount count() const override {
    DecodeCount all;
    for (const auto& part : parts_) all += part->count();
    all.refused += refused_;
    return all;
  }
  [[nodiscard]] std::size_t vectors() const override {
    std::size_t most = 0;
    for (const auto& part : parts_) most = std::max(most, part->vectors());
    return most;
  }
  [[nodiscard]] Geometry geometry(GeometryBase base) const override {
    int level = 0;
    for (const auto& part : parts_) level = std::max(level, part->level());
    std::vector<std::shared_ptr<const VolumeValues>> all;
    for (std::size_t c = 0; c < parts_.size(); ++c) all.push_back(part_values(c, base.description, level));
    if (colors_) {
      const auto values = color_values(all, luma_);
      if (!shown_.chosen && !shown_.magnitude) return colored(std::move(base), values);
      all = values->components;
      base.description.transfer = default_transfer(kColorRange.first, kColorRange.second);
    }
    if (shown_.magnitude) return magnitude(std::move(base), std::move(all));
    const std::size_t index = std::min<std::size_t>(shown_.index, parts_.size() - 1);
    // A part shows vectors of its own level, and of brightness instead of red.
    Geometry geometry =
        parts_[index]->level() == level && !luma_ ? parts_[index]->geometry(base) : vectors_of(base, *all[index]);
    auto& volume = *geometry.as<Volume>();
    auto values = std::make_shared<VolumeValues>(*all[index]);
    values->components = std::move(all);
    volume.values = std::move(values);
    return geometry;
  }
  void show(const ShownComponent& component) override { shown_ = component; }

 private:
  [[nodiscard]] std::shared_ptr<const VolumeValues> part_values(std::size_t c, Description about, int level) const {
    // Colour differences are not in the range of the colours.
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    if (luma_ && (c == 1 || c == 2)) about.value_range = {kNone, kNone};
    return parts_[c]->values(about, level);
  }
  [[nodiscard]] Geometry colored(GeometryBase base, const std::shared_ptr<const VolumeValues>& values) const {
    // The vectors of the brightness are updated where it changes.
    const bool own = luma_ && parts_.front()->level() == values->level;
    Geometry geometry = own ? parts_.front()->geometry(std::move(base)) : vectors_of(std::move(base), *values);
    auto& volume = *geometry.as<Volume>();
    if (own) color_vectors(values->source, volume, values->level > 0);
    volume.values = values;
    return geometry;
  }
  [[nodiscard]] Geometry vectors_of(GeometryBase base, const VolumeValues& values) const {
    GradientOptions options;
    options.fraction = kShownFraction;
    options.vectors = std::min<std::uint64_t>(most_vectors_, options.vectors);
    options.range = values.range;
    auto found = gradient_vectors(values.source, options);
    Volume volume((GeometryBase()));
    if (auto* const made = std::get_if<Volume>(&found)) volume = std::move(*made);
    base.description.spacing = volume.description.spacing;
    base.description.total = volume.description.total;
    static_cast<GeometryBase&>(volume) = std::move(base);
    return volume;
  }
  [[nodiscard]] Geometry magnitude(GeometryBase base, std::vector<std::shared_ptr<const VolumeValues>> all) const {
    if (!length_) length_ = magnitude_of(all);
    base.description.value_range = (*length_)->range;
    base.description.transfer = default_transfer((*length_)->range.first, (*length_)->range.second);
    Geometry geometry = vectors_of(std::move(base), **length_);
    auto values = std::make_shared<VolumeValues>(**length_);
    values->components = std::move(all);
    geometry.as<Volume>()->values = std::move(values);
    return geometry;
  }

  const std::size_t most_vectors_;  // of one component
  const bool colors_, luma_;
  values::ComponentCounts counts_;
  std::vector<std::unique_ptr<values::ValuesPart>> parts_;
  ShownComponent shown_;
  std::size_t refused_ = 0;                                            // chunks of no component
  mutable std::optional<std::shared_ptr<const VolumeValues>> length_;  // null after a change
};

}  // namespace

std::unique_ptr<Decoder> make_components_decoder(const StreamHeader& header, std::size_t most_vectors) {
  return std::make_unique<ComponentsDecoder>(header, most_vectors);
}

}  // namespace gs::qnv
