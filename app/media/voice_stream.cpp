#include "app/media/voice_stream.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace gs::app {
namespace {

constexpr std::int64_t kFarAhead = 1 << 16;  // sample pairs; to skip more than this, seek instead of reading
constexpr std::size_t kPiece = 1024;  // sample pairs per read
constexpr std::int64_t kShort = 1 << 16;  // sample pairs; max length of a loop that is kept in memory as a whole

}  // namespace

VoiceStream::VoiceStream(std::shared_ptr<const MediaFile> file, std::unique_ptr<render::SampleReader> reader,
                         double duration, bool loop)
    : file_(std::move(file)), reader_(std::move(reader)), rate_(reader_->rate()), loop_(loop) {
  constexpr double kLongest = 1e12;
  if (duration > 0 && duration * rate_ < kLongest) length_ = std::max<std::int64_t>(std::llround(duration * rate_), 1);
  loop_ = loop_ && length_ > 0;
}

void VoiceStream::read_turn() {
  reader_->seek(0);
  turn_.assign(static_cast<std::size_t>(length_) * 2, 0.0f);
  for (std::size_t at = 0; at < turn_.size();) {
    const std::size_t count = reader_->read(std::span(turn_).subspan(at, std::min(2 * kPiece, turn_.size() - at)));
    if (count == 0) break;
    at += 2 * count;
  }
}

const float* VoiceStream::window(std::int64_t first, std::size_t count) {
  const auto end = first + static_cast<std::int64_t>(count);
  if (first < first_ || first > next_ + kFarAhead) {
    const std::int64_t from = std::max<std::int64_t>(first, 0), place = loop_ ? from % length_ : from;
    if (!loop_ || length_ > kShort) reader_->seek(static_cast<double>(place) / rate_);
    held_.clear();
    over_ = false;
    first_ = next_ = from;
    if (first < 0) {
      held_.assign(static_cast<std::size_t>(-first) * 2, 0.0f);
      first_ = first;
    }
  }
  if (next_ < end) fill(static_cast<std::size_t>(end - next_));
  // Remove the pairs before the requested window.
  const auto before = static_cast<std::size_t>(first - first_);
  if (before > 4 * kPiece) {
    held_.erase(held_.begin(), held_.begin() + static_cast<std::ptrdiff_t>(2 * before));
    first_ = first;
  }
  return held_.data() + 2 * static_cast<std::size_t>(first - first_);
}

void VoiceStream::fill(std::size_t pairs) {
  if (loop_ && length_ <= kShort) {
    if (turn_.empty()) read_turn();
    for (; pairs > 0; --pairs, ++next_) {
      const float* pair = turn_.data() + 2 * (next_ % length_);
      held_.insert(held_.end(), pair, pair + 2);
    }
    return;
  }
  float piece[2 * kPiece];
  for (std::size_t done = 0; done < pairs;) {
    std::size_t wanted = kPiece;
    if (length_ > 0) {
      const std::int64_t place = loop_ ? next_ % length_ : next_;
      if (loop_ && place == 0 && next_ > 0) {
        reader_->seek(0);
        over_ = false;
      }
      if (!loop_ && place >= length_) over_ = true;
      if (place < length_) wanted = static_cast<std::size_t>(std::min<std::int64_t>(kPiece, length_ - place));
    }
    const std::size_t count = over_ ? 0 : reader_->read(std::span<float>(piece, 2 * wanted));
    over_ = over_ || count < wanted;
    std::fill(piece + 2 * count, piece + 2 * wanted, 0.0f);
    held_.insert(held_.end(), piece, piece + 2 * wanted);
    next_ += static_cast<std::int64_t>(wanted);
    done += wanted;
  }
}

}  // namespace gs::app
