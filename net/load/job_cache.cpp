#include "net/load/job_cache.h"

#include "net/base/url_signature.h"

#include <utility>

namespace gs::net {

std::string JobCache::key() const { return without_signature(location_.url()) + "\n" + request_.accept; }

bool JobCache::is_allowed() const {
  return cache_ && location_.scheme() && location_.scheme()->cached && request_.cache != CacheUse::never_store &&
         parse_url(location_.url()).authority.find('@') == std::string::npos;
}

std::optional<JobCache::Found> JobCache::look_up(const RangeSet& needed, bool needs_all) {
  trusted_ = false;
  if (!searching_ || !is_allowed() || request_.cache != CacheUse::normal) return std::nullopt;
  const std::int64_t now = unix_seconds_();
  auto found = cache_->find(key(), now);
  if (!found || (!request_.validator.empty() && !request_.validator.agrees(found->head().validator)) ||
      !reaches(location_.reach(), found->head().space))
    return std::nullopt;
  const CachedHead& head = found->head();
  const bool continuable = !head.encoded && !head.validator.strong().empty();
  const RangeSet wanted = head.total ? needed.within(ByteRange{0, *head.total}) : needed;
  const bool all = wanted.without(found->present()).empty() && (head.total || !needs_all);
  part_ = {};
  if (needs_all && !all) {
    // The whole resource is delivered in order, so use only the cached bytes at its start.
    const RangeSet front = found->present().within(ByteRange{});
    part_ = front.empty() || front.ranges().front().begin > 0 ? ByteRange{0, 0} : front.ranges().front();
  }
  Found result{{head.validator, head.total, head.encoded, head.accepts_ranges, head.space},
               wanted.without(found->present().within(part_)),
               all};
  const bool fresh = found->fresh(now);
  const bool useless = !all && (!continuable || result.missing == wanted);
  // A stale version without a validator is useless, because the server cannot confirm it.
  const bool unconfirmable = !fresh && head.validator.empty();
  if (useless || unconfirmable) return std::nullopt;
  entry_ = std::move(found);
  trusted_ = fresh;
  return result;
}

void JobCache::close() {
  entry_.reset();
  writer_.reset();
}

void JobCache::drop() {
  if (is_allowed()) cache_->drop(key());
}

void JobCache::confirm(const Validator& version, std::int64_t fresh_for) {
  cache_->confirm(key(), version, fresh_for, unix_seconds_());
  trusted_ = true;
}

RangeSet JobCache::held(const RangeSet& needed) const {
  return entry_ ? needed.within(entry_->present().within(part_)) : RangeSet();
}

RangeSet JobCache::pending(const RangeSet& needed) const {
  RangeSet result;
  const RangeSet all = held(needed);
  auto held_range = all.ranges().begin();
  for (const ByteRange& range : needed.ranges()) {
    while (held_range != all.ranges().end() && held_range->begin < range.begin) ++held_range;
    if (held_range != all.ranges().end() && held_range->begin == range.begin) result.add(*held_range);
  }
  return result;
}

std::optional<std::vector<std::byte>> JobCache::read(std::uint64_t offset, std::size_t most) const {
  return entry_->read(offset, most);
}

void JobCache::open_writer(const ResponseHead& head, const LoadVersion& version) {
  if (writer_ || !is_allowed()) return;
  if (head.cache_control.no_store || head.other_answers) return drop();
  const std::int64_t fresh_for = freshness(head);
  if (version.validator.empty() && fresh_for == 0) return;
  writer_ = cache_->write(key(), {without_signature(location_.url()), head.content_type, version.validator, version.total,
                                  version.accepts_ranges, version.encoded, unix_seconds_(), fresh_for, version.space});
}

void JobCache::append(std::uint64_t offset, std::span<const std::byte> bytes) {
  if (writer_) writer_->append(offset, bytes);
}

void JobCache::commit(std::optional<std::uint64_t> total) {
  if (writer_) writer_->commit(total, unix_seconds_());
  writer_.reset();
}

}  // namespace gs::net
