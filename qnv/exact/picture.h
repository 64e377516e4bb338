#pragma once

#include "qnv/base/cloud.h"
#include "qnv/exact/tail_pieces.h"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace gs::qnv::exact {

/// The picture that a tail's texture coordinates mean. FORMAT.md, "Picture".
inline constexpr std::size_t kMostPictureFiles = 8;
struct TailPicture {
  std::vector<PictureFile> files;  // from coarse to fine: 1 to kMostPictureFiles
  bool repeat_s = true, repeat_t = true;
};

/// As it is cut into the payloads of chunks.
[[nodiscard]] std::vector<std::byte> encode_picture(const TailPicture& picture);
/// So many of its bytes from the front on show a file.
[[nodiscard]] std::size_t bytes_until_shown(const TailPicture& picture, std::size_t file);

/// A picture as its pieces come, in any order. Safe for untrusted bytes; holds no more than what came, twice.
class PictureReader {
 public:
  /// The payload of a chunk. False where it is none.
  bool add(std::span<const std::byte> payload);
  /// Whether there is enough of it to show something.
  [[nodiscard]] bool enough() const { return !finest().empty(); }
  [[nodiscard]] bool whole() const { return pieces_.length() != 0 && front_.size() == pieces_.length(); }
  /// What there is of it from the front on; null: nothing. It is another one than before only where a third more has
  /// come, or all: pictures take time to unpack.
  [[nodiscard]] std::shared_ptr<const SurfacePicture> picture() const;
  /// How many bytes of it have come, and how many there are; 0: none have.
  [[nodiscard]] std::size_t come() const { return pieces_.come(); }
  [[nodiscard]] std::size_t length() const { return pieces_.length(); }

 private:
  /// From where to where the finest file of which there is enough has come; empty: there is none.
  struct Range {
    std::size_t begin = 0, end = 0;
    [[nodiscard]] bool empty() const { return end == begin; }
  };
  [[nodiscard]] Range finest() const;

  TailPieces pieces_;
  std::vector<std::byte> front_;
  mutable std::shared_ptr<const SurfacePicture> shown_;
  mutable Range shown_range_;  // that it shows
};

}  // namespace gs::qnv::exact
