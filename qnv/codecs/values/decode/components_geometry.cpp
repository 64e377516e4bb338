#include "qnv/codecs/values/decode/components_geometry.h"

#include "qnv/codecs/values/values_vectors.h"
#include "qnv/sampling/volume/color_voxels.h"
#include "qnv/sampling/volume/component_values.h"
#include "qnv/sampling/volume/gradients.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv::values {

Geometry ComponentsGeometry::geometry(GeometryBase base, std::span<const std::unique_ptr<ValuesPart>> parts,
                                      const ShownComponent& shown) {
  if (parts.size() == 1) return parts.front()->geometry(std::move(base));
  int level = 0;
  for (const auto& part : parts) level = std::max(level, part->level());
  std::vector<std::shared_ptr<const VolumeValues>> all;
  for (std::size_t c = 0; c < parts.size(); ++c) {
    Description about = base.description;
    // Colour differences are not in the range of the colours.
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    if (luma_ && (c == 1 || c == 2)) about.value_range = {kNone, kNone};
    all.push_back(parts[c]->values(about, level));
  }
  if (colors_) {
    const auto values = color_values(all, luma_);
    if (!shown.chosen && !shown.magnitude) return colored(std::move(base), *parts.front(), values);
    all = values->components;
    base.description.transfer = default_transfer(kColorRange.first, kColorRange.second);
  }
  if (shown.magnitude) return magnitude(std::move(base), all);
  const std::size_t index = std::min<std::size_t>(shown.index, parts.size() - 1);
  Geometry geometry = one_of(std::move(base), *parts[index], all[index], level);
  auto values = std::make_shared<VolumeValues>(*all[index]);
  values->components = std::move(all);
  geometry.as<Volume>()->values = std::move(values);
  return geometry;
}

Geometry ComponentsGeometry::one_of(GeometryBase base, const ValuesPart& part,
                                    const std::shared_ptr<const VolumeValues>& values, int level) const {
  // A part shows vectors of its own level, and of brightness instead of red.
  return part.level() == level && !luma_ ? part.geometry(std::move(base)) : vectors_of(std::move(base), *values);
}

Geometry ComponentsGeometry::colored(GeometryBase base, const ValuesPart& first,
                                     const std::shared_ptr<const VolumeValues>& values) const {
  // The vectors of the brightness are updated where it changes.
  const bool own = luma_ && first.level() == values->level;
  Geometry geometry = own ? first.geometry(std::move(base)) : vectors_of(std::move(base), *values);
  auto& volume = *geometry.as<Volume>();
  if (own) color_vectors(values->source, volume, values->level > 0);
  volume.values = values;
  return geometry;
}

Geometry ComponentsGeometry::vectors_of(GeometryBase base, const VolumeValues& values) const {
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

Geometry ComponentsGeometry::magnitude(GeometryBase base, std::span<const std::shared_ptr<const VolumeValues>> all) {
  if (!length_) length_ = magnitude_of(all);
  base.description.value_range = (*length_)->range;
  base.description.transfer = default_transfer((*length_)->range.first, (*length_)->range.second);
  Geometry geometry = vectors_of(std::move(base), **length_);
  auto values = std::make_shared<VolumeValues>(**length_);
  values->components.assign(all.begin(), all.end());
  geometry.as<Volume>()->values = std::move(values);
  return geometry;
}

}  // namespace gs::qnv::values
