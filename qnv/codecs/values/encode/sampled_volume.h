#pragma once

#include "qnv/codecs/shared/encode_options.h"
#include "qnv/codecs/values/encode/gap_filling.h"
#include "qnv/codecs/values/encode/sample_batch.h"
#include "qnv/container/value_grid.h"
#include "qnv/sampling/volume/volume.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv::values {

/// Volume as integers for the transform. Its samples are read from the source when they are needed.
struct SampledVolume {
  ValueGrid grid;                // without errors
  std::uint32_t most_error = 0;  // permitted for the samples of a stream
  float rounding = 0;            // maximum error of the samples themselves, in the unit of the values
  std::pair<float, float> value_range{0, 0};
  double least = 0, most = 0;  // of the stored numbers
};

/// Reads a volume, or all steps of a time series, once and chooses the integers. Each rank reads a part. Float numbers
/// become multiples of a power of two that suits the permitted error. Returns an error if a source fails, for volumes
/// without values or with too many voxels, or if cancelled. Safe for untrusted values.
[[nodiscard]] std::variant<SampledVolume, EncodeError> sample_volume(std::span<const VolumeSource> steps,
                                                                     const ValueTolerance& tolerance, Ranks& ranks,
                                                                     Progress* progress);

/// Reader of the samples of a volume, a few slices at a time. `source` and `volume` must outlive it. One thread at a
/// time.
class SampleReader {
 public:
  SampleReader(const VolumeSource& source, const SampledVolume& volume, unsigned threads);

  /// Reads slices, and the codes of their stored voxels if `codes`. Missing voxels are filled after prepare_gaps();
  /// before, they are 0. Returns an error if the source fails.
  [[nodiscard]] std::optional<EncodeError> read(std::uint32_t first, std::uint32_t count, bool codes,
                                                SampleBatch& batch);
  /// Takes the slices of a volume with gaps, in order, before they are read to be encoded.
  void measure_gaps(const SampleBatch& batch) { filling_.measure(batch); }
  void prepare_gaps(Ranks& ranks);

 private:
  const VolumeSource& source_;
  const SampledVolume& volume_;
  unsigned threads_;
  bool fills_ = false;
  GapFilling filling_;
  std::vector<std::byte> stored_;
};

}  // namespace gs::qnv::values
