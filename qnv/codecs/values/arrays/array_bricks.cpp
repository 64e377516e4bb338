#include "qnv/codecs/values/arrays/array_bricks.h"

#include "base/parallel.h"
#include "qnv/codecs/values/bricks/brick_choice.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <tuple>
#include <utility>

namespace gs::qnv::values {

namespace {

// Central differences need one sample around a brick.
constexpr std::uint32_t kArrayMargin = 1;
// Vectors that a brick keeps, relative to its own share; as in BrickCache.
constexpr double kKeptOfArray = 1.5;

std::uint64_t joined(std::uint64_t key, std::uint64_t with) {
  key = (key ^ with) * 0x9e3779b97f4a7c15u;
  return key ^ key >> 32;
}

float value_in(const Brick& brick, const Extent& at) {
  const SampleBox& box = brick.samples->box;
  const std::size_t place = ((at[2] - box.first[2]) * std::size_t{box.size[1]} + (at[1] - box.first[1])) * box.size[0] +
                            (at[0] - box.first[0]);
  return std::bit_cast<float>(brick.samples->samples[place]);
}

/// Copies values of a box to the samples of a brick, which must have them.
void put(const SampleBox& box, const SampleBox& part, std::span<const float> values, BrickSamples& to) {
  for (std::uint32_t z = 0; z < part.size[2]; ++z)
    for (std::uint32_t y = 0; y < part.size[1]; ++y) {
      const std::size_t row = ((part.first[2] + z - to.box.first[2]) * std::size_t{to.box.size[1]} +
                               (part.first[1] + y - to.box.first[1])) * to.box.size[0] +
                              (part.first[0] - to.box.first[0]);
      const float* const from = values.data() + ((part.first[2] + z - box.first[2]) * std::size_t{box.size[1]} +
                                                 (part.first[1] + y - box.first[1])) * box.size[0] +
                                (part.first[0] - box.first[0]);
      for (std::uint32_t x = 0; x < part.size[0]; ++x)
        to.samples[row + x] = std::bit_cast<std::int32_t>(from[x]);
    }
}

}  // namespace

SampleBox ArrayBricks::extended(const BrickName& name) const {
  SampleBox box = layout_.core(name);
  for (std::size_t a = 0; a < 3; ++a) {
    const std::uint32_t end = std::min(layout_.extent(name.level)[a], box.first[a] + box.size[a] + kArrayMargin);
    box.first[a] -= std::min(box.first[a], kArrayMargin);
    box.size[a] = end - box.first[a];
  }
  return box;
}

const Brick* ArrayBricks::find(const BrickName& name) const {
  const auto found = bricks_.find(name);
  return found != bricks_.end() ? &found->second.brick : nullptr;
}

const Brick* ArrayBricks::shown(const BrickName& name) const { return shown_.contains(name) ? find(name) : nullptr; }

void ArrayBricks::choose(std::vector<BrickName> chosen, const VectorShares& shares, std::size_t most_bytes) {
  ++time_;
  chosen_ = std::move(chosen);
  std::size_t coming = 0;
  for (const BrickName& name : chosen_) {
    const auto known = bricks_.find(name);
    if (known != bricks_.end())
      known->second.used = time_;
    else
      coming += brick_bytes(layout_, name, shares.of(name));
  }
  std::vector<std::tuple<std::uint64_t, BrickName>> order;
  for (const auto& [name, state] : bricks_)
    if (state.used != time_) order.emplace_back(state.used, name);
  std::ranges::sort(order);
  for (const auto& [used, name] : order) {
    if (bytes_ + coming <= most_bytes) break;
    const auto found = bricks_.find(name);
    bytes_ -= found->second.brick.bytes();
    bricks_.erase(found);
  }
}

ArrayBricks::Group ArrayBricks::next(std::size_t most) const {
  const auto waits = [this](const BrickName& name) { return !bricks_.contains(name) && !failed_.contains(name); };
  const auto first = std::ranges::find_if(chosen_, waits);
  if (first == chosen_.end()) return {};
  Group group;
  for (auto one = first; one != chosen_.end() && group.size() < most; ++one)
    if (one->parent() == first->parent() && waits(*one)) group.push_back(*one);
  return group;
}

// Reads samples from memory, or from the file.
bool ArrayBricks::read_box(int level, const SampleBox& box, const KnownLevel& known, std::vector<float>& values) const {
  if (!known.samples || known.level != level) return levels_.read(level, box, values);
  const Extent& extent = layout_.extent(level);
  values.clear();
  values.reserve(sample_count(box.size));
  for (std::uint32_t z = 0; z < box.size[2]; ++z)
    for (std::uint32_t y = 0; y < box.size[1]; ++y) {
      const float* const from = known.samples->data() + box.first[0] +
                                ((box.first[2] + z) * std::size_t{extent[1]} + box.first[1] + y) * extent[0];
      values.insert(values.end(), from, from + box.size[0]);
    }
  return true;
}

void ArrayBricks::read(const Group& group, const KnownLevel& known) {
  SampleBox box = layout_.core(group.front());
  for (const BrickName& name : group) {
    const SampleBox core = layout_.core(name);
    for (std::size_t a = 0; a < 3; ++a) {
      const std::uint32_t end = std::max(box.first[a] + box.size[a], core.first[a] + core.size[a]);
      box.first[a] = std::min(box.first[a], core.first[a]);
      box.size[a] = end - box.first[a];
    }
  }
  std::vector<float> values;
  // Bricks at opposite corners are read one by one.
  std::size_t wanted = 0;
  for (const BrickName& name : group) wanted += sample_count(layout_.core(name).size);
  const bool together = 2 * wanted >= sample_count(box.size);
  const bool read = together && read_box(group.front().level, box, known, values);
  for (const BrickName& name : group) {
    const SampleBox core = layout_.core(name);
    SampleBox from = box;
    if (!together) from = core;
    if (together ? !read : !read_box(name.level, from, known, values)) {
      failed_.insert(name);
      continue;
    }
    auto samples = std::make_shared<BrickSamples>();
    samples->level = name.level;
    samples->box = extended(name);
    samples->samples.resize(sample_count(samples->box.size));
    put(from, core, values, *samples);
    State& state = bricks_[name];
    state.brick.name = name;
    state.brick.samples = std::move(samples);
    state.used = time_;
    bytes_ += state.brick.bytes();
  }
}

std::uint64_t ArrayBricks::key_of(const BrickName& name, std::uint64_t base_version) const {
  constexpr std::uint64_t kSeed = 0x243f6a8885a308d3u;
  std::uint64_t key = joined(kSeed, base_version);
  const Extent count = layout_.bricks(name.level);
  for (int side = 0; side < 27; ++side) {
    const std::array<int, 3> step{side % 3 - 1, side / 3 % 3 - 1, side / 9 - 1};
    BrickName other = name;
    bool inside = true;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::int64_t at = std::int64_t{name.at[a]} + step[a];
      inside = inside && at >= 0 && at < count[a];
      other.at[a] = static_cast<std::uint32_t>(at);
    }
    if (!inside) continue;
    while (other.level < layout_.base() && !shown_.contains(other)) other = other.parent();
    key = joined(key, static_cast<std::uint64_t>(other.level) + 1);
  }
  return key | 1;  // 0 means none
}

// Returns a value from the finest shown brick, or mixed from the coarser samples around.
float ArrayBricks::sample(int level, const Extent& at, std::span<const float> base) const {
  if (level >= layout_.base()) {
    const Extent& extent = layout_.extent(level);
    return base[(std::size_t{at[2]} * extent[1] + at[1]) * extent[0] + at[0]];
  }
  if (const Brick* const brick = shown({level, {at[0] / kBrickEdge, at[1] / kBrickEdge, at[2] / kBrickEdge}}))
    return value_in(*brick, at);
  const Extent &extent = layout_.extent(level), &coarse = layout_.extent(level + 1);
  std::array<std::array<std::uint32_t, 2>, 3> ends{};
  for (std::size_t a = 0; a < 3; ++a) {
    const bool halved = extent[a] > 1;
    ends[a] = {halved ? at[a] / 2 : 0, halved ? std::min((at[a] + 1) / 2, coarse[a] - 1) : 0};
  }
  const float nearest = sample(level + 1, {ends[0][0], ends[1][0], ends[2][0]}, base);
  if (nearest != nearest) return nearest;
  double sum = 0;
  int count = 0;
  for (std::size_t z = 0; z <= (ends[2][0] != ends[2][1] ? 1 : 0); ++z)
    for (std::size_t y = 0; y <= (ends[1][0] != ends[1][1] ? 1 : 0); ++y)
      for (std::size_t x = 0; x <= (ends[0][0] != ends[0][1] ? 1 : 0); ++x) {
        const float one = x + y + z == 0 ? nearest : sample(level + 1, {ends[0][x], ends[1][y], ends[2][z]}, base);
        if (one == one) sum += static_cast<double>(one), ++count;
      }
  return static_cast<float>(sum / count);
}

// Makes the samples of a brick again with its margin, and its vectors. Only reads what other threads may read.
void ArrayBricks::complete(State& state, std::span<const float> base, const VectorShares& shares, Brick& made) const {
  const BrickName& name = state.brick.name;
  const SampleBox core = layout_.core(name), &box = state.brick.samples->box;
  auto samples = std::make_shared<BrickSamples>(*state.brick.samples);
  for (std::uint32_t z = 0; z < box.size[2]; ++z)
    for (std::uint32_t y = 0; y < box.size[1]; ++y) {
      const bool row_inside = box.first[2] + z - core.first[2] < core.size[2] && box.first[1] + y - core.first[1] < core.size[1];
      for (std::uint32_t x = 0; x < box.size[0]; ++x) {
        const Extent at{box.first[0] + x, box.first[1] + y, box.first[2] + z};
        if (row_inside && at[0] - core.first[0] < core.size[0]) {
          x = core.first[0] + core.size[0] - box.first[0] - 1;  // skip the core
          continue;
        }
        samples->samples[(std::size_t{z} * box.size[1] + y) * box.size[0] + x] =
            std::bit_cast<std::int32_t>(sample(name.level, at, base));
      }
    }
  made.name = name;
  made.wanted = shares.of(name) * static_cast<double>(sample_count(core.size));
  made.vectors = longest_vectors(*samples, core, levels_.layouts()[static_cast<std::size_t>(name.level)],
                                 static_cast<std::size_t>(std::ceil(kKeptOfArray * made.wanted)));
  made.samples = std::move(samples);
}

std::vector<BrickName> ArrayBricks::finish(std::span<const float> base, std::uint64_t base_version,
                                           const VectorShares& shares) {
  std::vector<BrickName> ready;
  shown_.clear();
  for (const BrickName& name : chosen_) {
    const bool has_parent = name.level + 1 >= layout_.base() || shown_.contains(name.parent());
    if (!has_parent || !bricks_.contains(name)) continue;
    shown_.insert(name);
    ready.push_back(name);
  }
  std::vector<std::pair<State*, std::uint64_t>> works;
  for (const BrickName& name : ready) {
    State& state = bricks_[name];
    if (const std::uint64_t key = key_of(name, base_version); key != state.key) works.emplace_back(&state, key);
  }
  // Each brick reads only the cores of others.
  std::vector<Brick> made(works.size());
  (void)parallel_for(works.size(), [&](std::size_t i) { complete(*works[i].first, base, shares, made[i]); });
  for (std::size_t i = 0; i < works.size(); ++i) {
    State& state = *works[i].first;
    bytes_ -= state.brick.bytes();
    state.brick = std::move(made[i]);
    state.key = works[i].second;
    bytes_ += state.brick.bytes();
  }
  return ready;
}

}  // namespace gs::qnv::values
