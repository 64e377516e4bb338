#include "qnv/codecs/shared/decoder.h"
#include "qnv/codecs/shared/steps_decoder.h"
#include "qnv/codecs/shared/volume_series.h"
#include "qnv/codecs/values/labels/decode/label_levels.h"
#include "qnv/codecs/values/labels/decode/label_slices.h"
#include "qnv/codecs/values/labels/decode/label_volume.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace gs::qnv {
namespace {

// Maximum number of chunks that are kept.
constexpr std::size_t kMostLabelChunks = std::size_t{1} << 24;

/// Received steps of labels. Keeps all runs, and decodes the chain of steps up to the one that is shown.
class LabelSteps final : public VolumeSeries, public std::enable_shared_from_this<LabelSteps> {
 public:
  LabelSteps(const StreamHeader& header, std::size_t most_vectors)
      : header_(header),
        most_vectors_(most_vectors),
        finest_(values::finest_label_level(header.grid, most_vectors)),
        layout_(header.grid.dimensions),
        runs_(header.steps.times.size()) {}

  void add(ChunkType type, std::span<const std::byte> payload) {
    const std::lock_guard lock(mutex_);
    auto run = values::parse_label_run(type == ChunkType::labels ? payload : std::span<const std::byte>());
    std::uint64_t step = runs_.size();
    if (run && run->level < layout_.orders.size()) step = values::take_step(*run, layout_.orders[run->level].codes());
    // Later steps keep the labels of earlier ones, but the first of a chain has all of them.
    if (step >= runs_.size() || count_.taken >= kMostLabelChunks || (step % kChainSteps == 0 && run->differs)) {
      ++count_.refused;
      in_order_ = false;
      return;
    }
    if (run->level < finest_) {
      count_.full = true;
      in_order_ = false;
      return;
    }
    const std::pair key(static_cast<int>(run->level), run->first);
    const auto [place, added] = runs_[static_cast<std::size_t>(step)].emplace(key, std::move(*run));
    if (!added) return;  // repeated
    ++count_.taken;
    ++revision_;
    if (step < first_ || step >= first_ + decoded_ || !levels_) return;
    // Later steps of the chain may have other labels there.
    if (step + 1 == first_ + decoded_)
      (void)levels_->add(place->second);
    else
      levels_.reset();
  }
  void leave_order() {
    const std::lock_guard lock(mutex_);
    in_order_ = false;
  }
  [[nodiscard]] DecodeCount count() const {
    const std::lock_guard lock(mutex_);
    return count_;
  }

  [[nodiscard]] std::span<const double> times() const override { return header_.steps.times; }
  [[nodiscard]] std::uint64_t revision() const override { return revision_; }
  [[nodiscard]] Geometry step(const ShownComponent& shown) override {
    return geometry({header_.description, header_.color}, shown);
  }
  [[nodiscard]] Geometry geometry(GeometryBase base, const ShownComponent& shown) {
    const std::lock_guard lock(mutex_);
    const std::uint32_t step = step_number(shown.step, times());
    decode(step);
    bool whole = true;
    for (std::size_t s = first_; s <= step; ++s) whole = whole && runs_[s].size() >= header_.steps.chunks[s];
    const auto in_order = in_order_ ? std::optional(static_cast<std::uint32_t>(count_.taken)) : std::nullopt;
    auto made = values::label_values(header_.grid, base.description, *levels_, levels_->level(), in_order);
    made->wrong.reset();
    values::note_label_errors(header_.grid, whole, in_order, *made);
    made->step = step;
    made->times = header_.steps.times;
    Volume shown_volume = values::label_surface(std::move(made), std::move(base), most_vectors_);
    shown_volume.series = shared_from_this();
    return shown_volume;
  }
  [[nodiscard]] std::size_t vectors() const { return values::most_label_vectors(header_.grid, finest_, most_vectors_); }

 private:
  // Decodes the chain up to a step.
  void decode(std::uint32_t step) {
    const std::size_t first = step / kChainSteps * kChainSteps;
    if (first != first_ || first + decoded_ > step + std::size_t{1}) levels_.reset();
    if (!levels_) {
      levels_.emplace(header_.grid.dimensions, header_.grid.palette.size(), finest_);
      first_ = first;
      decoded_ = 0;
    }
    for (; first_ + decoded_ <= step; ++decoded_) {
      levels_->begin_step();
      for (const auto& [key, run] : runs_[first_ + decoded_]) (void)levels_->add(run);
    }
  }

  const StreamHeader header_;
  const std::size_t most_vectors_;
  const int finest_;
  const values::LabelLayout layout_;
  mutable std::mutex mutex_;
  std::vector<std::map<std::pair<int, std::uint64_t>, values::LabelRun>> runs_;  // by step, then by level and code
  bool in_order_ = true;                                                         // no chunk was lost or refused so far
  DecodeCount count_;
  std::atomic<std::uint64_t> revision_{0};
  std::optional<values::LabelLevels> levels_;  // of the last decoded step; null after a change of an earlier one
  std::size_t first_ = 0, decoded_ = 0;        // begin of the chain; number of its steps in levels_
};

}  // namespace

std::unique_ptr<Decoder> make_label_series_decoder(const StreamHeader& header, std::size_t most_vectors) {
  return std::make_unique<StepsDecoder<LabelSteps>>(header, most_vectors);
}

}  // namespace gs::qnv
