#pragma once

#include "base/parallel.h"
#include "qnv/codecs/shared/encode_options.h"
#include "qnv/codecs/values/encode/values_chunks.h"
#include "qnv/container/container.h"

#include <cstdint>
#include <span>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv::values {

/// Component of a volume, or of all steps of a time series, while it is encoded.
struct EncodedComponent {
  ValueGrid grid;
  std::vector<ComponentParts> steps;
  std::pair<float, float> range{0, 0};  // of the values of all steps
};

/// Encodes one component into a store. `steps` are the volume, or all steps of a time series, with equal grids.
/// `component` is its number. `header` has everything but the description and the grid. `alone` states that there are
/// no other components. Returns an error if a source or the store fails, for volumes without values or with too many
/// voxels, or if cancelled. With EncodeOptions::ranks, all ranks return the same.
[[nodiscard]] std::variant<EncodedComponent, EncodeError> encode_component(std::span<const VolumeSource> steps,
                                                                           std::size_t component, StreamHeader header,
                                                                           bool alone, const EncodeOptions& options,
                                                                           SpillStore& store, Progress* progress);

}  // namespace gs::qnv::values
