#include "qnv/codecs/shared/steps_decoder.h"
#include "qnv/codecs/shared/volume_series.h"
#include "qnv/codecs/values/component_number.h"
#include "qnv/codecs/values/decode/components_geometry.h"
#include "qnv/codecs/values/decode/values_part.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>
#include <tuple>
#include <utility>
#include <vector>

namespace gs::qnv {
namespace {

// Maximum number of chunks that are kept.
constexpr std::size_t kMostChunks = std::size_t{1} << 24;

/// Chunk of a step: its type, its block or first cube, and its index in the block.
using ChunkKey = std::tuple<ChunkType, std::uint64_t, std::uint32_t>;

/// Received steps of a stream. Keeps all chunks, and decodes the chain of steps up to the one that is shown.
class ReceivedSteps final : public VolumeSeries, public std::enable_shared_from_this<ReceivedSteps> {
 public:
  ReceivedSteps(StreamHeader header, std::size_t most_vectors)
      : header_(std::move(header)),
        components_(header_.grid.components),
        most_vectors_(std::max<std::size_t>(1, most_vectors / components_)),
        counts_(values::component_counts(header_.grid)),
        chunks_(header_.steps.times.size() * components_),
        received_(components_, 0),
        geometry_(header_.grid, most_vectors_) {
    prepare(0);
  }
  // Later steps refer to earlier ones.
  ~ReceivedSteps() override { shorten(0); }

  void add(ChunkType type, std::span<const std::byte> payload) {
    const std::lock_guard lock(mutex_);
    const auto split = values::without_component(payload, type == ChunkType::values ? counts_.blocks : counts_.cubes);
    const std::optional<ChunkKey> key =
        split && split->component < chunks_.size() ? key_of(type, *split) : std::nullopt;
    if (!key || count_.taken >= kMostChunks) {
      ++count_.refused;
      in_order_ = false;
      return;
    }
    const auto [place, added] = chunks_[split->component].emplace(*key, split->payload);
    if (!added) return;  // repeated
    ++count_.taken;
    ++received_[split->component % components_];
    ++revision_;
    const std::size_t step = split->component / components_;
    if (step < first_ || step >= first_ + chain_.size()) return;
    if (type == ChunkType::values || step + 1 == first_ + chain_.size())
      part_of(split->component).add(type, place->second, {});
    geometry_.change();
  }
  void leave_order() {
    const std::lock_guard lock(mutex_);
    in_order_ = false;
  }
  [[nodiscard]] DecodeCount count() const {
    const std::lock_guard lock(mutex_);
    DecodeCount all = count_;
    for (const auto& step : chain_)
      for (const auto& part : step) all.full = all.full || part->count().full;
    return all;
  }
  [[nodiscard]] std::size_t vectors() const {
    const std::lock_guard lock(mutex_);
    std::size_t most = 0;
    for (const auto& part : chain_.back()) most = std::max(most, part->vectors());
    return most;
  }

  [[nodiscard]] std::span<const double> times() const override { return header_.steps.times; }
  [[nodiscard]] std::uint64_t revision() const override { return revision_; }
  [[nodiscard]] Geometry step(const ShownComponent& shown) override {
    return geometry({header_.description, header_.color}, shown);
  }
  [[nodiscard]] Geometry geometry(GeometryBase base, const ShownComponent& shown) {
    const std::lock_guard lock(mutex_);
    const std::uint32_t step = step_number(shown.step, times());
    prepare(step);
    for (std::size_t c = 0; c < components_; ++c) chain_.back()[c]->set_state(state_of(step, c));
    Geometry geometry = geometry_.geometry(std::move(base), chain_.back(), shown);
    auto& volume = *geometry.as<Volume>();
    if (volume.values) {
      auto values = std::make_shared<VolumeValues>(*volume.values);
      values->step = step;
      values->times = header_.steps.times;
      volume.values = std::move(values);
    }
    volume.series = shared_from_this();
    return geometry;
  }

 private:
  // Returns nullopt for invalid chunks.
  [[nodiscard]] std::optional<ChunkKey> key_of(ChunkType type, const values::ComponentPayload& split) const {
    if (type == ChunkType::values) {
      const bool later = split.component / components_ % kChainSteps != 0;
      const auto cluster = values::parse_cluster(split.payload, later);
      return cluster ? std::optional(ChunkKey{type, cluster->block, cluster->index}) : std::nullopt;
    }
    const auto run = values::parse_run(split.payload);
    return run ? std::optional(ChunkKey{type, run->first, run->count}) : std::nullopt;
  }

  [[nodiscard]] values::ValuesPart& part_of(std::size_t number) {
    return *chain_[number / components_ - first_][number % components_];
  }

  void add_chunks(std::size_t step, bool clusters) {
    for (std::size_t c = 0; c < components_; ++c)
      for (const auto& [key, payload] : chunks_[step * components_ + c])
        if ((std::get<ChunkType>(key) == ChunkType::values) == clusters)
          part_of(step * components_ + c).add(std::get<ChunkType>(key), payload, {});
  }

  // Drops the last steps of the chain.
  void shorten(std::size_t steps) {
    while (chain_.size() > steps) chain_.pop_back();
  }

  // Makes the chain end with a step.
  void prepare(std::uint32_t step) {
    const std::size_t first = step / kChainSteps * kChainSteps, steps = step - first + 1;
    if (first == first_ && chain_.size() == steps) return;
    if (first != first_) shorten(0);
    shorten(steps);
    first_ = first;
    while (chain_.size() < steps) {
      const std::size_t next = first_ + chain_.size();
      std::vector<std::unique_ptr<values::ValuesPart>> parts;
      for (std::size_t c = 0; c < components_; ++c) {
        StreamHeader one = values::header_of_component(header_, c);
        if (!one.grid.errors.empty()) one.grid.errors = {one.grid.errors.back()};
        parts.push_back(values::make_values_part(one, most_vectors_));
        if (!chain_.empty()) chain_.back()[c]->rest();
        parts.back()->join_series(chain_.empty() ? nullptr : chain_.back()[c].get());
      }
      chain_.push_back(std::move(parts));
      add_chunks(next, true);
    }
    for (const auto& part : chain_.back()) part->rest();  // it may have remainders
    add_chunks(step, false);
    geometry_.change();
  }

  [[nodiscard]] values::StepState state_of(std::size_t step, std::size_t c) const {
    values::StepState state;
    state.complete = true;
    for (std::size_t s = first_; s <= step; ++s) {
      const std::size_t number = s * components_ + c;
      state.complete = state.complete && chunks_[number].size() >= header_.steps.chunks[number];
    }
    const ValueGrid& grid = c == 0 ? header_.grid : header_.more_grids[c - 1];
    if (!in_order_) return state;
    for (const ValueError& error : grid.errors)
      if (error.chunks <= received_[c]) state.error = error;
    return state;
  }

  const StreamHeader header_;
  const std::size_t components_, most_vectors_;
  const values::ComponentCounts counts_;
  mutable std::mutex mutex_;
  std::vector<std::map<ChunkKey, std::vector<std::byte>>> chunks_;  // by step, then by component
  std::vector<std::uint32_t> received_;                             // number of chunks of all steps, by component
  bool in_order_ = true;                                            // no chunk was lost or refused so far
  DecodeCount count_;
  std::atomic<std::uint64_t> revision_{0};
  std::size_t first_ = 0;                                                // step of the chain
  std::vector<std::vector<std::unique_ptr<values::ValuesPart>>> chain_;  // by step, then by component; not empty
  values::ComponentsGeometry geometry_;
};

}  // namespace

std::unique_ptr<Decoder> make_series_decoder(const StreamHeader& header, std::size_t most_vectors) {
  return std::make_unique<StepsDecoder<ReceivedSteps>>(header, most_vectors);
}

}  // namespace gs::qnv
