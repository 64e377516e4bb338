#include "render/sorting/depth_sort.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <new>
#include <utility>

namespace gs::render {
namespace {

constexpr unsigned kKeyDigitBits = 11, kKeyDigits = 1u << kKeyDigitBits, kKeyPasses = 3;

unsigned digit(std::uint64_t entry, unsigned pass) {
  return static_cast<unsigned>(entry >> (32 + pass * kKeyDigitBits)) & (kKeyDigits - 1);
}

/// Returns in `order` the indexes of all vectors, farthest first. `entries` and `other` are working memory.
void far_first_order(std::span<const SortPart> parts, std::vector<std::uint64_t>& entries,
                     std::vector<std::uint64_t>& other, std::vector<std::uint32_t>& order) {
  std::size_t base = 0;
  for (const SortPart& part : parts) base += part.count;
  entries.clear();
  entries.reserve(base);
  // Start with the last vector: at equal depth, later vectors count as farther.
  for (std::size_t i = parts.size(); i-- > 0;) {
    const SortPart& part = parts[i];
    const std::vector<glm::vec3>& positions = part.vectors->positions;
    base -= part.count;
    const std::size_t first = std::min(part.first, positions.size());
    for (std::size_t k = std::min(part.count, positions.size() - first); k-- > 0;) {
      const float depth = part.depth_of(positions[first + k]);
      entries.push_back(std::uint64_t{far_first_key(depth)} << 32 | (base + k));
    }
  }
  sort_by_key(entries, other);
  order.resize(entries.size());
  std::transform(entries.begin(), entries.end(), order.begin(),
                 [](std::uint64_t entry) { return static_cast<std::uint32_t>(entry); });
}

DepthSorter::Likeness rows_likeness(const SortPart& old, const SortPart& part) {
  if (old.row == part.row) return DepthSorter::Likeness::same;
  const glm::vec3 a(old.row), b(part.row);
  const float lengths = std::sqrt(glm::dot(a, a) * glm::dot(b, b));
  return lengths > 0 && glm::dot(a, b) >= std::cos(DepthSorter::kMaxTurn) * lengths ? DepthSorter::Likeness::near
                                                                                    : DepthSorter::Likeness::far;
}

float largest(const glm::mat3& m) {
  float most = 0;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) most = std::max(most, std::abs(m[i][k]));
  return most;
}

DepthSorter::Likeness distances_likeness(const SortPart& old, const SortPart& part) {
  if (old.eye == part.eye && old.metric == part.metric) return DepthSorter::Likeness::same;
  constexpr float kRounding = 4e-6f;  // differences of an eye that only turns
  const Box& box = part.vectors->description.box;
  const glm::vec3 middle = !box.empty()                      ? (box.lower + box.upper) * 0.5f
                           : part.vectors->positions.empty() ? part.eye
                                                             : part.vectors->positions.front();
  const float moved = glm::length(part.eye - old.eye), away = glm::length(part.eye - middle),
              changed = largest(part.metric - old.metric), metric = largest(part.metric);
  if (moved <= kRounding * away && changed <= kRounding * metric) return DepthSorter::Likeness::same;
  return moved <= DepthSorter::kMaxTurn * away && changed <= DepthSorter::kMaxTurn * metric
             ? DepthSorter::Likeness::near
             : DepthSorter::Likeness::far;
}

}  // namespace

float SortPart::depth_of(const glm::vec3& position) const {
  if (!by_distance) return row.x * position.x + row.y * position.y + row.z * position.z + row.w;
  const glm::vec3 away = position - eye;
  return glm::dot(away, metric * away);
}

std::uint32_t far_first_key(float depth) {
  if (std::isnan(depth)) return std::numeric_limits<std::uint32_t>::max();
  // The bits of a positive float, as an integer, have the order of the floats.
  const auto bits = std::bit_cast<std::uint32_t>(depth + 0.0f);
  const std::uint32_t ascending = bits >> 31 ? ~bits : bits | 0x80000000u;
  return ~ascending;
}

void sort_by_key(std::vector<std::uint64_t>& entries, std::vector<std::uint64_t>& other) {
  std::vector<std::array<std::size_t, kKeyDigits>> counts(kKeyPasses);  // number of entries, by pass and digit
  for (const std::uint64_t entry : entries)
    for (unsigned pass = 0; pass < kKeyPasses; ++pass) ++counts[pass][digit(entry, pass)];
  if (other.size() < entries.size()) other.resize(entries.size());
  const std::size_t count = entries.size();
  for (unsigned pass = 0; pass < kKeyPasses; ++pass) {
    auto& places = counts[pass];
    if (std::find(places.begin(), places.end(), count) != places.end()) continue;  // all entries have the same digit
    std::size_t next = 0;
    for (std::size_t& place : places) next += std::exchange(place, next);
    for (std::size_t i = 0; i < count; ++i) other[places[digit(entries[i], pass)]++] = entries[i];
    entries.swap(other);
    entries.resize(count);
    other.resize(std::max(other.size(), count));
  }
}

DepthSorter::~DepthSorter() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

std::vector<DepthSorter::Seen> DepthSorter::seen_of(std::span<const SortPart> parts) {
  std::vector<Seen> seen;
  for (const SortPart& part : parts) {
    seen.push_back({part.vectors, part});
    seen.back().part.vectors = nullptr;
  }
  return seen;
}

DepthSorter::Likeness DepthSorter::likeness(std::span<const Seen> seen, std::span<const SortPart> parts) {
  if (seen.size() != parts.size()) return Likeness::far;
  bool same = true;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const SortPart& part = parts[i];
    // Compare owners, not addresses: other vectors may have the same address.
    if (seen[i].part.count != part.count || seen[i].part.first != part.first ||
        seen[i].part.by_distance != part.by_distance || seen[i].vectors.owner_before(part.vectors) ||
        part.vectors.owner_before(seen[i].vectors))
      return Likeness::far;
    const Likeness own = part.by_distance ? distances_likeness(seen[i].part, part) : rows_likeness(seen[i].part, part);
    if (own == Likeness::far) return own;
    same = same && own == Likeness::same;
  }
  return same ? Likeness::same : Likeness::near;
}

DepthSorter::Order DepthSorter::order(std::span<const SortPart> parts) {
  std::unique_lock lock(mutex_);
  if (!newest_ || likeness(newest_->of, parts) != Likeness::same) {
    // For a new view, the order of the previous request is sufficient. A repeated request needs its own order.
    std::uint64_t oldest = asked_;
    if (asked_ == 0 || likeness(asked_for_, parts) != Likeness::same) {
      wanted_.assign(parts.begin(), parts.end());
      asked_for_ = seen_of(parts);
      ++asked_;
      waiting_ = true;
      if (!thread_.joinable()) thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
      changed_.notify_all();
    }
    changed_.wait(lock, [&] {
      return newest_ && (newest_->number == asked_ ||
                         (newest_->number >= oldest && likeness(newest_->of, parts) != Likeness::far));
    });
  }
  if (in_use_ != newest_) {
    if (in_use_) spare_ = std::move(in_use_);
    in_use_ = newest_;
  }
  return {in_use_->far_first, likeness(in_use_->of, parts) == Likeness::same, in_use_->number};
}

void DepthSorter::run(const std::stop_token& stop) {
  std::vector<std::uint64_t> entries, other;
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [&] { return waiting_; })) {
    waiting_ = false;
    std::vector<SortPart> parts = std::move(wanted_);
    wanted_.clear();
    std::shared_ptr<Sorted> result = std::move(spare_);
    const std::uint64_t number = asked_;
    lock.unlock();
    if (!result) result = std::make_shared<Sorted>();
    result->number = number;
    result->of = seen_of(parts);
    result->far_first.clear();
    try {
      far_first_order(parts, entries, other, result->far_first);
    } catch (const std::bad_alloc&) {
      result->far_first.clear();
    }
    parts.clear();  // release the vectors
    lock.lock();
    newest_ = std::move(result);
    changed_.notify_all();
  }
}

}  // namespace gs::render
