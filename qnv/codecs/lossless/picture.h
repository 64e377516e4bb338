#pragma once

#include "qnv/base/geometry.h"
#include "qnv/codecs/lossless/tail_pieces.h"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace gs::qnv::exact {

/// Maximum number of files of a texture. FORMAT.md, "Picture".
inline constexpr std::size_t kMaxPictureFiles = 8;
struct TailPicture {
  std::vector<PictureFile> files;  // coarse to fine; 1 to kMaxPictureFiles
  bool repeat_s = true, repeat_t = true;
};

/// Encodes a texture as one byte string, which pieces_of() cuts into chunk payloads.
[[nodiscard]] std::vector<std::byte> encode_picture(const TailPicture& picture);
/// Returns the number of leading bytes that a decoder needs before it can draw the file with index `file`.
[[nodiscard]] std::size_t bytes_until_shown(const TailPicture& picture, std::size_t file);

/// Texture that is received in pieces, in any order. Safe for untrusted bytes; holds at most twice the received bytes.
class PictureReader {
 public:
  /// Adds the payload of a picture chunk. Returns false if it is invalid.
  bool add(std::span<const std::byte> payload);
  /// Reports whether enough bytes are received to draw a file.
  [[nodiscard]] bool enough() const { return !finest().empty(); }
  [[nodiscard]] bool whole() const { return pieces_.length() != 0 && front_.size() == pieces_.length(); }
  /// Returns the texture received so far; nullptr if no file can be drawn. Decoding a texture takes time, so a new
  /// object is returned only after a third more bytes were received, or all.
  [[nodiscard]] std::shared_ptr<const SurfacePicture> picture() const;
  /// Returns the number of bytes received. length() returns the total, or 0 until a piece is received.
  [[nodiscard]] std::size_t come() const { return pieces_.come(); }
  [[nodiscard]] std::size_t length() const { return pieces_.length(); }

 private:
  /// Received byte range of the finest file that can be drawn; empty if no file can.
  struct Range {
    std::size_t begin = 0, end = 0;
    [[nodiscard]] bool empty() const { return end == begin; }
  };
  [[nodiscard]] Range finest() const;

  TailPieces pieces_;
  std::vector<std::byte> front_;
  mutable std::shared_ptr<const SurfacePicture> shown_;
  mutable Range shown_range_;  // byte range that shown_ contains
};

}  // namespace gs::qnv::exact
