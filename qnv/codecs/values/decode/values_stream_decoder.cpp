#include "qnv/codecs/shared/decoder.h"
#include "qnv/codecs/values/cube_runs.h"
#include "qnv/codecs/values/decode/cell_vectors.h"
#include "qnv/codecs/values/decode/level_layout.h"
#include "qnv/codecs/values/decode/values_decoder.h"
#include "qnv/codecs/values/decode/values_part.h"
#include "qnv/codecs/values/stored_code.h"
#include "qnv/codecs/values/values_vectors.h"
#include "qnv/sampling/volume/gradients.h"
#include "qnv/sampling/volume/volume_values.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv {
namespace {

using values::Extent;

constexpr std::int32_t kMissingSample = std::numeric_limits<std::int32_t>::min();
// Assumed samples per block, which limits the number of blocks. Border blocks may have fewer.
constexpr std::size_t kBlockSamples = 512;

/// Numbers of a decoded volume, 4 bytes each. `Number` is std::int32_t or float.
template <class Number>
VolumeSource source_of(VolumeLayout layout, std::vector<Number> numbers) {
  const auto data = std::make_shared<const std::vector<Number>>(std::move(numbers));
  const std::size_t slice = std::size_t{layout.dimensions[0]} * layout.dimensions[1];
  return {std::move(layout), [data, slice](std::uint32_t z, std::span<std::byte> to) {
            if ((z + std::size_t{1}) * slice > data->size() || to.size() != slice * sizeof(Number)) return false;
            std::memcpy(to.data(), data->data() + z * slice, to.size());
            return true;
          }};
}

/// Samples as a volume. Any thread may read it.
VolumeSource source_of(values::SampledGrid grid) {
  VolumeLayout layout = grid.layout;
  return {std::move(layout), [grid = std::move(grid)](std::uint32_t z, std::span<std::byte> to) {
            const auto [nx, ny, nz] = grid.samples.extent();
            std::vector<std::int32_t> slice(std::size_t{nx} * ny);
            if (z >= nz || to.size() != slice.size() * sizeof(std::int32_t)) return false;
            grid.read({{0, 0, z}, {nx, ny, 1}}, slice.data());
            std::memcpy(to.data(), slice.data(), to.size());
            return true;
          }};
}

/// Decoder of the values payload. Its geometry are the gradient vectors of the decoded values, and the values.
class ValuesStreamDecoder final : public values::ValuesPart {
 public:
  ValuesStreamDecoder(const StreamHeader& header, std::size_t most_vectors)
      : grid_(header.grid),
        most_vectors_(most_vectors),
        finest_(values::level_for(grid_.dimensions, most_vectors)),
        decoder_(grid_.dimensions, finest_, most_blocks(most_vectors)) {}

  void add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange>) override {
    const values::Added added = type == ChunkType::values       ? add_cluster(payload)
                                : type == ChunkType::gaps       ? add_gaps(payload)
                                : type == ChunkType::remainders ? add_remainders(payload)
                                                                : values::Added::refused;
    if (added == values::Added::refused) ++count_.refused;
    if (added == values::Added::dropped) count_.full = true;
    if (added == values::Added::taken || added == values::Added::waits) ++received_;
    if (added == values::Added::taken) {
      ++count_.taken;
      values_.reset();
    }
    in_order_ = in_order_ && (added == values::Added::taken || added == values::Added::repeated);
  }
  void leave_order() override { in_order_ = false; }
  [[nodiscard]] DecodeCount count() const override { return count_; }
  [[nodiscard]] std::size_t vectors() const override {
    const double all =
        static_cast<double>(values::sample_count(values::low_extent(grid_.dimensions, decoder_.level())));
    return std::min(most_vectors_, static_cast<std::size_t>(std::ceil(kShownFraction * all)));
  }
  [[nodiscard]] Geometry geometry(GeometryBase base) const override {
    Description& about = base.description;
    if (!values_ || !has_vectors_) decode(about, decoder_.level(), true);
    Volume shown = vectors_ ? cell_vectors() : all_vectors(about);
    about.spacing = shown.description.spacing;
    about.total = shown.description.total;
    static_cast<GeometryBase&>(shown) = std::move(base);
    shown.values = values_;
    return shown;
  }

  [[nodiscard]] int level() const override { return decoder_.level(); }
  [[nodiscard]] std::shared_ptr<const VolumeValues> values(const Description& about, int level) const override {
    if (!values_ || values_->level != level) decode(about, level, false);
    return values_;
  }

  void join_series(ValuesPart* before) override {
    state_.emplace();
    if (before) decoder_.refer(before->coefficients());
  }
  void set_state(const values::StepState& state) override {
    state_ = state;
    values_.reset();
  }
  void rest() override {
    decoder_.decode_ready();
    decoder_.rest();
    samples_ = {};
    samples_level_ = -1;
    vectors_.reset();
    values_.reset();
    missing_.reset();
    remainders_ = {};
    gap_cubes_ = remainder_cubes_ = 0;
  }
  [[nodiscard]] values::ValuesDecoder& coefficients() override { return decoder_; }

 private:
  [[nodiscard]] static std::size_t most_blocks(std::size_t most_vectors) {
    return std::max<std::size_t>(values::kSamplesPerVector * most_vectors, 4096) / kBlockSamples + 64;
  }
  [[nodiscard]] std::uint64_t samples_of(int level) const {
    const Extent part = values::low_extent(grid_.dimensions, level);
    return std::uint64_t{part[0]} * part[1] * part[2];
  }

  values::Added add_cluster(std::span<const std::byte> payload) {
    const auto cluster = values::parse_cluster(payload, decoder_.refers());
    return cluster ? decoder_.add(*cluster) : values::Added::refused;
  }

  // Counts the cubes of all runs. Returns false above twice the cubes of the volume. Valid runs do not overlap; the
  // limit bounds the work for invalid streams.
  bool count_cubes(const values::CubeRun& run, std::uint64_t& cubes) const {
    const Extent all = values::cube_extent(grid_.dimensions);
    cubes += run.count;
    return cubes <= 2 * (std::uint64_t{all[0]} * all[1] * all[2]);
  }

  values::Added add_gaps(std::span<const std::byte> payload) {
    if (!grid_.gaps) return values::Added::refused;
    if (finest_ > 0) return values::Added::dropped;
    const auto run = values::parse_run(payload);
    if (!run || !count_cubes(*run, gap_cubes_)) return values::Added::refused;
    // Earlier values keep their own gaps.
    missing_ = missing_ ? std::make_shared<std::vector<std::uint8_t>>(*missing_)
                        : std::make_shared<std::vector<std::uint8_t>>(static_cast<std::size_t>(samples_of(0)));
    vectors_.reset();
    return values::decode_gaps(*run, grid_.dimensions, *missing_) ? values::Added::taken : values::Added::refused;
  }

  values::Added add_remainders(std::span<const std::byte> payload) {
    if (!grid_.exact && grid_.correction == 0) return values::Added::refused;
    if (finest_ > 0) return values::Added::dropped;
    const auto run = values::parse_run(payload);
    if (!run || !count_cubes(*run, remainder_cubes_)) return values::Added::refused;
    if (remainders_.empty()) remainders_.assign(static_cast<std::size_t>(samples_of(0)), 0);
    return values::decode_remainders(*run, grid_.dimensions, remainders_) ? values::Added::taken
                                                                          : values::Added::refused;
  }

  /// Reports whether all chunks were received, so that the last error holds. Repeated ones may be missing.
  [[nodiscard]] bool complete() const {
    if (state_) return !grid_.errors.empty() && state_->complete;
    return !grid_.errors.empty() && received_ >= grid_.errors.back().chunks && count_.refused == 0;
  }

  /// Returns the vectors of the changed cells and of those before.
  [[nodiscard]] Volume cell_vectors() const {
    Volume shown((GeometryBase()));
    vectors_->fill(samples_, shown);
    shown.description.total = vectors_->total();
    shown.description.spacing = values::smallest_step(samples_.layout);
    return shown;
  }

  /// Returns the vectors of all values.
  [[nodiscard]] Volume all_vectors(const Description& about) const {
    GradientOptions options;
    options.fraction = kShownFraction;
    options.vectors = std::min<std::uint64_t>(most_vectors_, options.vectors);
    options.range = about.value_range;
    auto found = gradient_vectors(values_->source, options);
    if (auto* const volume = std::get_if<Volume>(&found)) return std::move(*volume);
    GeometryBase none;
    none.description = about;
    return Volume(std::move(none));
  }

  /// Sets `values_`, and with `vectors` also `vectors_` if the values are samples without remainders.
  void decode(const Description& about, int level, bool vectors) const {
    auto values = std::make_shared<VolumeValues>();
    values->level = level;
    values->whole = grid_.dimensions;
    values->range = about.value_range;
    values->stored = grid_.stored;
    values->slope = grid_.slope;
    values->intercept = grid_.intercept;
    values->missing = grid_.missing;
    note_error(*values);
    VolumeLayout layout = values::level_layout(grid_, about, values->level);
    std::vector<values::SampleBox> changed;
    values::SampleBricks bricks = decoder_.bricks(values->level, changed);
    values->bytes = bricks.bytes();
    if (missing_ && values->level == 0) layout.missing = kMissingSample;
    if (values->level != samples_level_) vectors_.reset();
    samples_level_ = values->level;
    samples_ = {std::move(bricks), std::move(layout), values->level == 0 ? missing_ : nullptr};
    // Corrections refer to the samples after all chunks.
    const bool corrected = grid_.correction != 0 && !remainders_.empty() && values->level == 0 && complete();
    if ((values->exact && grid_.exact) || corrected) {
      values->source = corrected ? corrected_source() : exact_source();
      vectors_.reset();
    } else {
      // Bricks of finer levels start from the samples of coarse ones, which therefore keep all their bits.
      if (values->level == 0)
        samples_.limits = values::sample_limits(about.value_range, samples_.layout.slope, samples_.layout.intercept);
      if (vectors)
        update_vectors(changed, about);
      else
        vectors_.reset();
      values->source = source_of(samples_);
    }
    has_vectors_ = vectors;
    values_ = std::move(values);
  }

  void update_vectors(std::span<const values::SampleBox> changed, const Description& about) const {
    if (vectors_) return vectors_->update(samples_, changed);
    values::CellVectorOptions options;
    options.fraction = kShownFraction;
    options.most = most_vectors_;
    options.range = about.value_range;
    const std::array<glm::vec3, 3>& axes = samples_.layout.axes;
    vectors_.emplace(samples_.samples.extent(), glm::dmat3(axes[0], axes[1], axes[2]), options);
    const values::SampleBox all{{}, samples_.samples.extent()};
    vectors_->update(samples_, std::span(&all, 1));
  }

  [[nodiscard]] std::vector<std::int32_t> all_samples() const {
    std::vector<std::int32_t> samples(values::sample_count(samples_.samples.extent()));
    samples_.read({{}, samples_.samples.extent()}, samples.data());
    return samples;
  }

  [[nodiscard]] VolumeSource corrected_source() const {
    std::vector<std::int32_t> samples = all_samples();
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (!missing_ || (*missing_)[i] == 0)
        samples[i] =
            static_cast<std::int32_t>(static_cast<std::uint32_t>(samples[i]) + remainders_[i] * grid_.correction);
    return source_of(samples_.layout, std::move(samples));
  }

  void note_error(VolumeValues& values) const {
    const std::vector<ValueError>& errors = grid_.errors;
    if (values.level == 0 && complete()) {
      values.error = errors.back().most;
      values.rms = errors.back().rms;
      values.exact = errors.back().most == 0;
      return;
    }
    if (state_) {
      if (!state_->error) return;
      values.error = state_->error->most;
      values.rms = state_->error->rms;
      return;
    }
    // An entry holds if its chunks were received in order. Further chunks in order only reduce the error.
    if (!in_order_) return;
    for (const ValueError& error : errors)
      if (error.chunks <= received_) {
        values.error = error.most;
        values.rms = error.rms;
      }
  }

  // Returns the stored voxels, which the remainders restore.
  [[nodiscard]] VolumeSource exact_source() const {
    const values::StoredCodes codes(grid_);
    const std::vector<std::int32_t> samples = all_samples();
    VolumeLayout layout = samples_.layout;
    layout.missing.reset();
    layout.slope = grid_.slope;
    layout.intercept = grid_.intercept;
    const auto code = [&](std::size_t i) { return codes(samples[i]) + (remainders_.empty() ? 0 : remainders_[i]); };
    const auto gap = [&](std::size_t i) { return missing_ && (*missing_)[i] != 0; };
    if (!values::is_integer(grid_.stored)) {
      layout.type = VoxelType::f32;
      std::vector<float> numbers(samples.size());
      for (std::size_t i = 0; i < numbers.size(); ++i)
        numbers[i] = gap(i) ? std::numeric_limits<float>::quiet_NaN() : values::number_of_code(code(i));
      return source_of(std::move(layout), std::move(numbers));
    }
    layout.type = grid_.stored == VoxelType::u32 ? VoxelType::u32 : VoxelType::i32;
    std::vector<std::int32_t> numbers(samples.size());
    for (std::size_t i = 0; i < numbers.size(); ++i)
      numbers[i] = gap(i) ? kMissingSample : static_cast<std::int32_t>(code(i));
    if (missing_) layout.missing = layout.type == VoxelType::u32 ? 2147483648.0 : static_cast<double>(kMissingSample);
    return source_of(std::move(layout), std::move(numbers));
  }

  const ValueGrid grid_;
  const std::size_t most_vectors_;
  const int finest_;
  std::shared_ptr<std::vector<std::uint8_t>> missing_;  // of all voxels, or null
  std::vector<std::uint32_t> remainders_;
  std::uint64_t gap_cubes_ = 0, remainder_cubes_ = 0;
  std::uint32_t received_ = 0;
  bool in_order_ = true;  // no chunk was lost or refused so far
  DecodeCount count_;
  std::optional<values::StepState> state_;  // of a step of a time series
  // Results, made when they are asked for.
  mutable values::ValuesDecoder decoder_;
  mutable values::SampledGrid samples_;
  mutable int samples_level_ = -1;
  mutable bool has_vectors_ = false;                    // `vectors_` is that of `values_`
  mutable std::optional<values::CellVectors> vectors_;  // null if the values have remainders, or before the first ones
  mutable std::shared_ptr<const VolumeValues> values_;  // null after a change
};

}  // namespace

namespace values {

std::unique_ptr<ValuesPart> make_values_part(const StreamHeader& header, std::size_t most_vectors) {
  return std::make_unique<ValuesStreamDecoder>(header, most_vectors);
}

}  // namespace values

std::unique_ptr<Decoder> make_values_decoder(const StreamHeader& header, std::size_t most_vectors) {
  return std::make_unique<ValuesStreamDecoder>(header, most_vectors);
}

}  // namespace gs::qnv
