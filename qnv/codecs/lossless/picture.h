#pragma once

#include "qnv/base/geometry.h"
#include "qnv/codecs/lossless/tail_pieces.h"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace gs::qnv::exact {

/// Texture of a tail with texture coordinates. FORMAT.md, "Picture".
inline constexpr std::size_t kMaxPictureFiles = 8;
struct TailPicture {
  std::vector<PictureFile> files;  // coarse to fine; 1 to kMaxPictureFiles
  bool repeat_s = true, repeat_t = true;
};

/// Returns the bytes that are cut into chunk payloads.
[[nodiscard]] std::vector<std::byte> encode_picture(const TailPicture& picture);
/// Returns the length of the prefix needed to show a file.
[[nodiscard]] std::size_t bytes_until_shown(const TailPicture& picture, std::size_t file);

/// Picture received in pieces, in any order. Safe for untrusted bytes; holds at most twice what was received.
class PictureReader {
 public:
  /// Adds the payload of a chunk. Returns false if it is invalid.
  bool add(std::span<const std::byte> payload);
  /// Reports whether enough was received to show a file.
  [[nodiscard]] bool enough() const { return !finest().empty(); }
  [[nodiscard]] bool whole() const { return pieces_.length() != 0 && front_.size() == pieces_.length(); }
  /// Returns the picture received so far, or nullptr. Returns a new object only after a third more was received, or all
  /// of it, because decoding a picture takes time.
  [[nodiscard]] std::shared_ptr<const SurfacePicture> picture() const;
  /// Returns the bytes received; length() returns the total, or 0 if unknown.
  [[nodiscard]] std::size_t come() const { return pieces_.come(); }
  [[nodiscard]] std::size_t length() const { return pieces_.length(); }

 private:
  /// Received range of the finest file that can be shown; empty if none can.
  struct Range {
    std::size_t begin = 0, end = 0;
    [[nodiscard]] bool empty() const { return end == begin; }
  };
  [[nodiscard]] Range finest() const;

  TailPieces pieces_;
  std::vector<std::byte> front_;
  mutable std::shared_ptr<const SurfacePicture> shown_;
  mutable Range shown_range_;  // range held by shown_
};

}  // namespace gs::qnv::exact
