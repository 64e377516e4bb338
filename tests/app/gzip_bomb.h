#pragma once

#include "tests/gzip.h"

#include <zlib.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

namespace gs::app {

/// Returns one gzip member that decompresses to `head` and then repeats `unit` for `bytes`, rounded up. Compresses as
/// well as zlib, since one piece is compressed once and repeated.
inline std::string gzip_bomb(std::string_view head, std::string_view unit, std::size_t bytes) {
  constexpr std::size_t kPiece = std::size_t{4} << 20;
  std::string piece;
  while (piece.size() < std::min(kPiece, bytes)) piece += unit;
  const std::size_t pieces = bytes / piece.size();
  std::string rest;
  while (rest.size() < bytes - pieces * piece.size()) rest += unit;

  // Makes blocks that end at a whole byte and refer to nothing before.
  const auto blocks = [](std::string_view text, int flush) { return test::deflated(std::string(text), -15, flush); };
  const auto crc_of = [](std::string_view text) {
    return crc32_z(0, reinterpret_cast<const Bytef*>(text.data()), text.size());
  };
  std::string packed("\x1f\x8b\x08\0\0\0\0\0\0\x03", 10);  // RFC 1952 2.3
  packed += blocks(head, Z_FULL_FLUSH);
  const std::string packed_piece = blocks(piece, Z_FULL_FLUSH);
  const uLong piece_crc = crc_of(piece);
  uLong crc = crc_of(head);
  for (std::size_t i = 0; i < pieces; ++i) {
    packed += packed_piece;
    crc = crc32_combine(crc, piece_crc, static_cast<z_off_t>(piece.size()));
  }
  packed += blocks(rest, Z_FINISH);
  crc = crc32_combine(crc, crc_of(rest), static_cast<z_off_t>(rest.size()));
  for (const std::size_t number : {static_cast<std::size_t>(crc), head.size() + pieces * piece.size() + rest.size()})
    for (int i = 0; i < 4; ++i) packed += static_cast<char>(number >> (8 * i) & 255);
  return packed;
}

}  // namespace gs::app
