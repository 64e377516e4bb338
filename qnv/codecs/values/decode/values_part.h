#pragma once

#include "qnv/codecs/shared/decoder.h"
#include "qnv/sampling/volume/volume_values.h"

#include <cstddef>
#include <memory>

namespace gs::qnv::values {

/// Decoder of one component of a stream of values.
class ValuesPart : public Decoder {
 public:
  /// Returns the level that geometry() shows.
  [[nodiscard]] virtual int level() const = 0;
  /// Returns the values of a level, without computing vectors. `level` must be at least that of the memory limit.
  [[nodiscard]] virtual std::shared_ptr<const VolumeValues> values(const Description& about, int level) const = 0;
};

/// Makes the decoder of a stream with one component.
[[nodiscard]] std::unique_ptr<ValuesPart> make_values_part(const StreamHeader& header, std::size_t most_vectors);

}  // namespace gs::qnv::values
