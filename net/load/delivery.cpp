#include "net/load/delivery.h"

#include <algorithm>
#include <array>
#include <string>

namespace gs::net {

void Delivery::begin() {
  needed_ = whole() ? RangeSet(std::array{ByteRange{}}) : RangeSet(request_.ranges);
  received_ = 0;
}

std::optional<LoadError> Delivery::limit_to(std::uint64_t total) {
  for (const ByteRange& range : request_.ranges)
    if (range.begin > 0 && range.begin >= total)
      return LoadError{
          LoadErrorKind::bad_request,
          "byte " + std::to_string(range.begin) + " was requested; it has " + std::to_string(total) + " bytes", 0};
  needed_ = needed_.within(ByteRange{0, total});
  if (needed_.size() + received_ > request_.max_bytes)
    return LoadError{LoadErrorKind::too_large,
                     "it has " + std::to_string(needed_.size() + received_) + " bytes; expected at most " +
                         std::to_string(request_.max_bytes),
                     0};
  return std::nullopt;
}

bool Delivery::exceeds_limit(ByteRange range) const {
  return needed_.within(range).size() > request_.max_bytes - std::min(request_.max_bytes, received_);
}

bool Delivery::is_next(std::uint64_t position) const {
  return std::ranges::none_of(needed_.ranges(), [position](const ByteRange& range) {
    return range.begin < position && position < range.end;
  });
}

bool Delivery::push(std::uint64_t begin, std::span<const std::byte> bytes) {
  const ByteRange range{begin, begin + bytes.size()};
  const RangeSet pieces = needed_.within(range);
  for (const ByteRange& piece : pieces.ranges()) {
    received_ += piece.size();
    queue_.push_data(
        id_, piece.begin,
        bytes.subspan(static_cast<std::size_t>(piece.begin - begin), static_cast<std::size_t>(piece.size())));
  }
  needed_.subtract(range);
  return !pieces.empty();
}

}  // namespace gs::net
