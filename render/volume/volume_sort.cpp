#include "render/volume/volume_sort.h"

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

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
void far_first_order(std::span<const VolumeSortPart> parts, std::vector<std::uint64_t>& entries,
                     std::vector<std::uint64_t>& other, std::vector<std::uint32_t>& order) {
  std::size_t base = 0;
  for (const VolumeSortPart& part : parts) base += part.count;
  entries.clear();
  entries.reserve(base);
  // Start with the last vector: at equal depth, later vectors count as farther.
  for (std::size_t i = parts.size(); i-- > 0;) {
    const VolumeSortPart& part = parts[i];
    const std::vector<glm::vec3>& positions = part.volume->positions;
    base -= part.count;
    for (std::size_t k = std::min(part.count, positions.size()); k-- > 0;) {
      const glm::vec3& p = positions[k];
      const float depth = part.row.x * p.x + part.row.y * p.y + part.row.z * p.z + part.row.w;
      entries.push_back(std::uint64_t{far_first_key(depth)} << 32 | (base + k));
    }
  }
  sort_by_key(entries, other);
  order.resize(entries.size());
  std::transform(entries.begin(), entries.end(), order.begin(),
                 [](std::uint64_t entry) { return static_cast<std::uint32_t>(entry); });
}

}  // namespace

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

VolumeSorter::~VolumeSorter() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

std::vector<VolumeSorter::Seen> VolumeSorter::seen_of(std::span<const VolumeSortPart> parts) {
  std::vector<Seen> seen;
  for (const VolumeSortPart& part : parts) seen.push_back({part.volume, part.count, part.row});
  return seen;
}

VolumeSorter::Likeness VolumeSorter::likeness(std::span<const Seen> seen, std::span<const VolumeSortPart> parts) {
  if (seen.size() != parts.size()) return Likeness::far;
  bool same = true;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const VolumeSortPart& part = parts[i];
    // Compare owners, not addresses: another volume may have the same address.
    if (seen[i].count != part.count || seen[i].volume.owner_before(part.volume) ||
        part.volume.owner_before(seen[i].volume))
      return Likeness::far;
    if (seen[i].row == part.row) continue;
    same = false;
    const glm::vec3 a(seen[i].row), b(part.row);
    const float lengths = std::sqrt(glm::dot(a, a) * glm::dot(b, b));
    if (!(lengths > 0 && glm::dot(a, b) >= std::cos(kMaxTurn) * lengths)) return Likeness::far;
  }
  return same ? Likeness::same : Likeness::near;
}

VolumeSorter::Order VolumeSorter::order(std::span<const VolumeSortPart> parts) {
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

void VolumeSorter::run(const std::stop_token& stop) {
  std::vector<std::uint64_t> entries, other;
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [&] { return waiting_; })) {
    waiting_ = false;
    std::vector<VolumeSortPart> parts = std::move(wanted_);
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
    parts.clear();  // release the volumes
    lock.lock();
    newest_ = std::move(result);
    changed_.notify_all();
  }
}

}  // namespace gs::render
