#pragma once

#include "qnv/codecs/values/decode/values_part.h"
#include "qnv/container/container.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

namespace gs::qnv::values {

/// Geometry of a volume with one or several numbers per voxel: one of them, their magnitude, or colours. Keeps what it
/// computed until something changes. One thread at a time.
class ComponentsGeometry {
 public:
  /// `most_vectors` is that of one component.
  ComponentsGeometry(const ValueGrid& grid, std::size_t most_vectors)
      : colors_(grid.colors), luma_(grid.luma), most_vectors_(most_vectors) {}

  /// Notes that the decoders of the components have new data.
  void change() { length_.reset(); }
  [[nodiscard]] Geometry geometry(GeometryBase base, std::span<const std::unique_ptr<ValuesPart>> parts,
                                  const ShownComponent& shown);

 private:
  [[nodiscard]] Geometry one_of(GeometryBase base, const ValuesPart& part,
                                const std::shared_ptr<const VolumeValues>& values, int level) const;
  [[nodiscard]] Geometry colored(GeometryBase base, const ValuesPart& first,
                                 const std::shared_ptr<const VolumeValues>& values) const;
  [[nodiscard]] Geometry vectors_of(GeometryBase base, const VolumeValues& values) const;
  [[nodiscard]] Geometry magnitude(GeometryBase base, std::span<const std::shared_ptr<const VolumeValues>> all);

  const bool colors_, luma_;
  const std::size_t most_vectors_;
  std::optional<std::shared_ptr<const VolumeValues>> length_;  // null after a change
};

}  // namespace gs::qnv::values
