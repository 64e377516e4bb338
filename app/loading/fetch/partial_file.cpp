#include "app/loading/fetch/partial_file.h"

#include "net/base/reference_policy.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

namespace gs::app {
PartialFile::PartialFile(const std::string& name, PartsOffer offer, std::span<const std::byte> front)
    : place_(std::move(offer.place)),
      served_(std::move(offer.served)),
      counter_(std::move(offer.received)),
      file_(name, front),
      problem_(file_.problem()) {
  if (!problem_.empty()) return;
  descriptor_ = net::Descriptor(::open(file_.path().c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW));
  if (!descriptor_ || ::ftruncate(descriptor_.get(), static_cast<off_t>(place_.total)) != 0)
    problem_ = file_.path() + ": " + std::strerror(errno);
  there_.add({0, std::min<std::uint64_t>(front.size(), place_.total)});
}

void PartialFile::fail(std::string problem, bool for_good) {
  if (trouble_.empty()) trouble_ = std::move(problem);
  failed_ = failed_ || for_good;
}

std::string PartialFile::trouble() const {
  const std::lock_guard lock(mutex_);
  return trouble_;
}

std::uint64_t PartialFile::received() const {
  const std::lock_guard lock(mutex_);
  return received_;
}

// Returns the range to receive for a single read. Consecutive reads get larger blocks.
net::ByteRange PartialFile::block_of(const ByteSpan& part) {
  const std::uint64_t end = part.offset + part.bytes;
  const bool follows = part.offset >= next_ && part.offset - next_ < kLeastBlock;
  ahead_ = follows ? std::min(2 * ahead_, kMostBlock) : kLeastBlock;
  next_ = end;
  const std::uint64_t first = part.offset / kLeastBlock * kLeastBlock;
  const std::uint64_t wanted = std::max(end, first + ahead_);
  return {first, std::min((wanted + kLeastBlock - 1) / kLeastBlock * kLeastBlock, place_.total)};
}

bool PartialFile::write(std::uint64_t offset, std::span<const std::byte> bytes) {
  const std::uint64_t begin = offset;
  while (!bytes.empty()) {
    const ssize_t done = ::pwrite(descriptor_.get(), bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) {
      const char* const advice = errno == ENOSPC ? "; free space there, or set TMPDIR to another folder" : "";
      fail(net::url_for_messages(place_.url.text()) + ": cannot write to " + file_.path() + ": " +
               std::strerror(errno) + advice,
           true);
      return false;
    }
    bytes = bytes.subspan(static_cast<std::size_t>(done));
    offset += static_cast<std::uint64_t>(done);
  }
  there_.add({begin, offset});
  received_ += offset - begin;
  if (counter_) *counter_ += offset - begin;
  return true;
}

void PartialFile::measure(std::size_t ranges, std::uint64_t bytes, std::chrono::steady_clock::duration time) {
  constexpr std::uint64_t kLeastGap = 4096, kMostGap = std::uint64_t{1} << 20;
  constexpr double kConnections = 6;  // net::LoaderOptions::max_transfers_per_host
  const double seconds = std::chrono::duration<double>(time).count();
  if (bytes == 0 || seconds <= 0) return;
  bytes_per_second_ = std::max(bytes_per_second_, static_cast<double>(bytes) / seconds);
  // Batches of few ranges are no good measure, because their time is that of the slowest range.
  const bool is_many = static_cast<double>(ranges) >= 2 * kConnections;
  if (ranges > 1 && !is_many) return;
  double alone = std::max(seconds - static_cast<double>(bytes) / bytes_per_second_, 0.0);
  if (is_many) alone *= kConnections / static_cast<double>(ranges);
  seconds_ = seconds_ == 0 ? alone : (seconds_ + alone) / 2;
  const double gap = std::min(bytes_per_second_ * seconds_ / kConnections, static_cast<double>(kMostGap));
  gap_ = std::max(static_cast<std::uint64_t>(gap), kLeastGap);
}

bool PartialFile::need(std::span<const ByteSpan> parts) {
  const std::lock_guard lock(mutex_);
  net::RangeSet wanted;
  for (const ByteSpan& part : parts) {
    if (part.offset > place_.total || part.bytes > place_.total - part.offset) return false;
    wanted.add({part.offset, part.offset + part.bytes});
  }
  net::RangeSet missing = wanted.without(there_);
  if (missing.empty()) {
    if (parts.size() == 1) next_ = parts[0].offset + parts[0].bytes;
    return true;
  }
  if (failed_ || !problem_.empty()) return false;
  if (parts.size() == 1) {
    net::RangeSet block;
    block.add(block_of(parts[0]));
    missing = block.without(there_);
  }
  WantedRanges request{place_.url, place_.validator, place_.total, missing.joined(gap_), place_.cache};
  const std::size_t ranges = request.ranges.size();
  const std::uint64_t before = received_;
  const auto begin = std::chrono::steady_clock::now();
  const auto problem = served_->read_ranges(request, place_.from,
                                            [this](std::uint64_t offset, auto bytes) { return write(offset, bytes); });
  measure(ranges, received_ - before, std::chrono::steady_clock::now() - begin);
  if (problem) fail(problem->message, problem->changed);
  return wanted.without(there_).empty();
}

}  // namespace gs::app
