#pragma once

#include "qnv/codecs/shared/decoder.h"
#include "qnv/codecs/values/decode/values_decoder.h"
#include "qnv/container/value_grid.h"
#include "qnv/sampling/volume/volume_values.h"

#include <cstddef>
#include <memory>
#include <optional>

namespace gs::qnv::values {

/// Received part of a time series, as far as a step depends on it.
struct StepState {
  bool complete = false;              // all chunks of the step, and of the earlier ones of its chain
  std::optional<ValueError> error{};  // maximum error of all steps with the received prefix
};

/// Decoder of one component of a stream of values, or of a step of a time series.
class ValuesPart : public Decoder {
 public:
  /// Returns the level that geometry() shows.
  [[nodiscard]] virtual int level() const = 0;
  /// Returns the values of a level, without computing vectors. `level` must be at least that of the memory limit.
  [[nodiscard]] virtual std::shared_ptr<const VolumeValues> values(const Description& about, int level) const = 0;

  /// Makes this the step of a time series after `before`, which may be null for the first step of a chain.
  virtual void join_series(ValuesPart* before) = 0;
  virtual void set_state(const StepState& state) = 0;
  /// Drops all but the coefficients. Remainders and gaps must be added again before the step is shown.
  virtual void rest() = 0;
  /// Returns the decoder of the coefficients.
  [[nodiscard]] virtual ValuesDecoder& coefficients() = 0;
};

/// Makes the decoder of a stream with one component.
[[nodiscard]] std::unique_ptr<ValuesPart> make_values_part(const StreamHeader& header, std::size_t most_vectors);

}  // namespace gs::qnv::values
