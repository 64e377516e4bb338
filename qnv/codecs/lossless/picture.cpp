#include "qnv/codecs/lossless/picture.h"

#include "base/bytes.h"

#include <algorithm>
#include <cstdint>

namespace gs::qnv::exact {
namespace {

constexpr std::size_t kFixedBytes = 2, kFileBytes = 8;
constexpr unsigned kRepeatS = 1, kRepeatT = 2;

}  // namespace

std::vector<std::byte> encode_picture(const TailPicture& picture) {
  std::vector<std::byte> bytes;
  ByteWriter out(bytes);
  out.integer(static_cast<std::uint8_t>((picture.repeat_s ? kRepeatS : 0) + (picture.repeat_t ? kRepeatT : 0)));
  out.integer(static_cast<std::uint8_t>(picture.files.size()));
  for (const PictureFile& file : picture.files) {
    out.integer(static_cast<std::uint32_t>(file.bytes.size()));
    out.integer(static_cast<std::uint32_t>(file.enough));
  }
  for (const PictureFile& file : picture.files) bytes.insert(bytes.end(), file.bytes.begin(), file.bytes.end());
  return bytes;
}

std::size_t bytes_until_shown(const TailPicture& picture, std::size_t file) {
  std::size_t bytes = kFixedBytes + kFileBytes * picture.files.size() + picture.files[file].enough;
  for (std::size_t i = 0; i < file; ++i) bytes += picture.files[i].bytes.size();
  return bytes;
}

bool PictureReader::add(std::span<const std::byte> payload) {
  if (whole()) return true;
  if (!pieces_.add(payload)) return false;
  const std::vector<std::byte> more = pieces_.next();
  front_.insert(front_.end(), more.begin(), more.end());
  if (whole()) (void)pieces_.take();
  return true;
}

PictureReader::Range PictureReader::finest() const {
  ByteReader in(front_);
  (void)in.integer<std::uint8_t>();
  const std::size_t count = in.integer<std::uint8_t>();
  Range range;
  std::size_t begin = kFixedBytes + kFileBytes * count;
  if (count > kMaxPictureFiles) return range;
  for (std::size_t i = 0; i < count && begin < front_.size(); ++i) {
    const std::size_t length = in.integer<std::uint32_t>(), enough = in.integer<std::uint32_t>();
    const std::size_t end = begin + std::min(length, front_.size() - begin);
    if (end - begin >= std::clamp<std::size_t>(enough, 1, std::max<std::size_t>(length, 1))) range = {begin, end};
    begin = end;
  }
  return range;
}

std::shared_ptr<const SurfacePicture> PictureReader::picture() const {
  const Range range = finest();
  if (range.empty()) return nullptr;
  const std::size_t size = range.end - range.begin, before = shown_range_.end - shown_range_.begin;
  const bool same = shown_ && shown_range_.begin == range.begin;
  if (same && (shown_->whole == whole()) && (size == before || (!whole() && size < before + before / 3))) return shown_;
  SurfacePicture picture;
  const auto flags = std::to_integer<unsigned>(front_[0]);
  picture.repeat_s = (flags & kRepeatS) != 0;
  picture.repeat_t = (flags & kRepeatT) != 0;
  picture.whole = whole();
  const auto file = std::span<const std::byte>(front_).subspan(range.begin, size);
  picture.bytes.assign(file.begin(), file.end());
  shown_range_ = range;
  return shown_ = std::make_shared<const SurfacePicture>(std::move(picture));
}

}  // namespace gs::qnv::exact
