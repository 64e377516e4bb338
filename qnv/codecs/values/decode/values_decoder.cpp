#include "qnv/codecs/values/decode/values_decoder.h"

#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gs::qnv::values {

namespace {

// Maximum number of clusters that wait for earlier ones, in one block and in all.
constexpr std::size_t kMostWaiting = 256, kMostWaitingInAll = std::size_t{1} << 16;
// Memory of clusters that wait to be decoded together; and that for which threads are worth their start.
constexpr std::size_t kMostReady = std::size_t{1} << 22, kThreadBytes = std::size_t{1} << 15;
// A level is shown when one of this many blocks has data, or when it costs little time: it has at most this many
// samples, or this many for each received byte. Levels finer than the data interpolate, which gives better pictures of
// most volumes. The first pictures, of a few bytes, must take less time.
constexpr std::uint32_t kShownPart = 16;
constexpr std::uint64_t kQuickSamples = std::uint64_t{1} << 21, kSamplesPerByte = 600, kSamplesPerFirstByte = 400;
constexpr std::uint64_t kFirstBytes = 16'000;

}  // namespace

bool valid(Extent extent) {
  std::uint64_t samples = 1;
  for (const std::uint32_t n : extent) {
    if (n == 0 || n > kMostSamples) return false;
    samples *= n;
    if (samples > kMostSamples) return false;
  }
  return true;
}

int level_for(Extent extent, std::size_t most_vectors) {
  constexpr std::uint64_t kFewest = 4096;
  const std::uint64_t most = std::max<std::uint64_t>(kSamplesPerVector * most_vectors, kFewest);
  int level = 0;
  while (level < 31 && sample_count(low_extent(extent, level)) > most) ++level;
  return level;
}

double level_gain(Extent extent, int level) {
  constexpr double kLowGain = 1.230174104914001;  // of one step along one axis
  int steps = 0;
  for (int i = 0; i < level; ++i)
    for (const std::uint32_t n : low_extent(extent, i)) steps += n > 1 ? 1 : 0;
  return std::pow(kLowGain, steps);
}

ValuesDecoder::ValuesDecoder(Extent extent, int finest, std::size_t most_blocks)
    : extent_(extent),
      levels_(level_count(extent)),
      finest_(std::clamp(finest, 0, levels_)),
      layout_(extent, levels_),
      most_blocks_(most_blocks),
      restored_(extent, levels_) {
  begun_.assign(static_cast<std::size_t>(std::max(levels_, 1)) + 1, 0);
}

ValuesDecoder::~ValuesDecoder() {
  if (before_) before_->after_ = nullptr;
}

void ValuesDecoder::refer(ValuesDecoder& before) {
  before_ = &before;
  before.after_ = this;
}

BlockChain ValuesDecoder::blocks_of(std::uint64_t number) const {
  const auto found = states_.find(static_cast<std::uint32_t>(number));
  const Block* const own = found != states_.end() ? found->second.block.get() : nullptr;
  BlockChain chain;
  // A block that was not received is that of the step before.
  if (before_ && (!own || found->second.differs)) chain = before_->blocks_of(number);
  if (own) chain.push(own);
  return chain;
}

// Notes changed coefficients for this step and those after it.
void ValuesDecoder::note(const Block& block, std::size_t first, std::size_t steps) {
  for (ValuesDecoder* step = this; step; step = step->after_) step->restored_.note(block, first, steps);
}

void ValuesDecoder::take(State& state, const Cluster& cluster, const BlockPlace& place) {
  if (state.next == 0) ++begun_[static_cast<std::size_t>(place.level)];
  if (cluster.index == 0) state.differs = cluster.differs;
  if (state.ready.empty()) ready_.push_back(cluster.block);
  state.ready.push_back(cluster);
  bytes_ += cluster.bytes.size();
  ready_bytes_ += cluster.bytes.size() + sizeof(Cluster);  // clusters may be empty
  ++state.next;
}

void ValuesDecoder::decode_ready() {
  if (before_) before_->decode_ready();
  struct Decoded {
    const Block* block = nullptr;
    std::size_t first = 0, steps = 0;
  };
  std::vector<Decoded> decoded(ready_.size());
  std::vector<State*> states;
  for (const std::uint32_t number : ready_) {
    State& state = states_[number];
    states.push_back(&state);
    // A block that replaces that of the step before changes all coefficients.
    if (before_ && !state.block && !state.differs)
      for (const Block* const replaced : before_->blocks_of(number)) note(*replaced, 0, replaced->cubes());
  }
  parallel_for(
      ready_.size(),
      [&](std::size_t i) {
        thread_local BlockScratch scratch;
        State& state = *states[i];
        if (!state.block) state.block = std::make_unique<Block>(layout_.place(ready_[i]));
        decoded[i] = {state.block.get(), state.block->cube(), 0};
        decoded[i].steps = values::decode(state.ready, *state.block, scratch);
        state.ready = {};
      },
      ready_bytes_ < kThreadBytes ? 1 : 0);
  for (const Decoded& one : decoded) note(*one.block, one.first, one.steps);
  ready_.clear();
  ready_bytes_ = 0;
}

Added ValuesDecoder::add(const Cluster& cluster) {
  if (cluster.block >= layout_.count() || cluster.plane > kHighestPlane || (cluster.differs && !before_))
    return Added::refused;
  const BlockPlace place = layout_.place(cluster.block);
  if (place.band_count == 0) return Added::refused;
  // The coarsest level has the low band, too.
  if (place.level <= finest_ && place.level < levels_) return Added::dropped;
  if (states_.size() >= most_blocks_ && !states_.contains(cluster.block)) return Added::dropped;
  State& state = states_[cluster.block];
  if (cluster.index < state.next || state.waiting.contains(cluster.index)) return Added::repeated;
  if (cluster.index > state.next) {
    if (state.waiting.size() >= kMostWaiting || waiting_ >= kMostWaitingInAll) return Added::refused;
    state.waiting.emplace(cluster.index, cluster);
    ++waiting_;
    return Added::waits;
  }
  take(state, cluster, place);
  while (!state.waiting.empty() && state.waiting.begin()->first == state.next) {
    const auto node = state.waiting.extract(state.waiting.begin());
    --waiting_;
    take(state, node.mapped(), place);
  }
  if (ready_bytes_ > kMostReady) decode_ready();
  return Added::taken;
}

int ValuesDecoder::level() const {
  if (before_) return std::min(own_level(), before_->level());
  return own_level();
}

int ValuesDecoder::own_level() const {
  const std::uint64_t quick =
      std::max(kQuickSamples, (bytes_ < kFirstBytes ? kSamplesPerFirstByte : kSamplesPerByte) * bytes_);
  for (int level = finest_; level < levels_; ++level) {
    const Extent part = low_extent(extent_, level);
    const std::uint64_t samples = std::uint64_t{part[0]} * part[1] * part[2];
    const std::uint64_t begun = begun_[static_cast<std::size_t>(level) + 1];
    if (samples <= quick) return level;
    if (begun > 0 && begun * kShownPart >= layout_.count_of(level + 1)) return level;
  }
  return levels_;
}

std::vector<std::int32_t> ValuesDecoder::samples(int level) {
  decode_ready();
  level = std::clamp(level, 0, levels_);
  // The bands of a level lie at the strides of the whole volume; coarser levels need only their own part of it.
  const Extent part = low_extent(extent_, level);
  std::vector<std::int32_t> volume(sample_count(part), 0);
  for (std::uint64_t number = 0; number < layout_.count(); ++number)
    for (const Block* const block : blocks_of(number)) {
      const int of = block->level();
      if (of > level)
        block->write(volume, part);
      else if (of == levels_)
        block->write_low(volume, part);  // the coarsest level has the low band, too
    }
  restore(volume, part, levels_ - level);
  return volume;
}

SampleBricks ValuesDecoder::bricks(int level, std::vector<SampleBox>& changed) {
  decode_ready();
  level = std::clamp(level, 0, levels_);
  restored_.update(level, layout_, [this](std::uint64_t number) { return blocks_of(number); });
  changed = restored_.take(level);
  return restored_.copy(level);
}

}  // namespace gs::qnv::values
