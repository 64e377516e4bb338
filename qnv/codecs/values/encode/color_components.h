#pragma once

#include "qnv/codecs/shared/encode_options.h"
#include "qnv/sampling/volume/volume.h"

#include <optional>
#include <variant>
#include <vector>

namespace gs::qnv::values {

/// Component of a voxel to encode.
struct PlannedComponent {
  VolumeSource source;
  ValueTolerance tolerance;
  double weight = 0;  // of its squared error, beside those of other components; 0 means that of its unit
};

/// Components to encode, of a volume with one or several numbers per voxel.
struct ComponentPlan {
  std::vector<PlannedComponent> components;
  bool colors = false, luma = false;  // the components are colours; in the form of brightness and differences
};

/// Plans the components of a source. Colours become brightness and differences if these take fewer bytes in a box in
/// the middle of the volume; `luma` decides instead if it is given. Returns an error if the source fails.
[[nodiscard]] std::variant<ComponentPlan, EncodeError> plan_components(const VolumeSource& source,
                                                                       const ValueTolerance& tolerance,
                                                                       std::optional<bool> luma = {});

}  // namespace gs::qnv::values
