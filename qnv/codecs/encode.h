#pragma once

#include "qnv/codecs/payloads.h"

#include <cstddef>
#include <string>
#include <variant>

namespace gs::qnv {

/// Encoded stream, its payload, and the reason for the choice of that payload.
struct Encoding {
  EncodedStream stream;
  const PayloadRow* payload = nullptr;
  std::string why;  // completes "chosen because"
};

/// Encodes a source with the requested payload. Without a request, uses the payload that suits the source best
/// (PayloadRow::choose). If that payload's encoder rejects the source, tries the next best payload. Only a displaced
/// stream, or an octree stream that replaces it, gets an exact mesh. Blocks. Any thread.
[[nodiscard]] std::variant<Encoding, EncodeError> encode(const EncodeSource& source, EncodeRequest request,
                                                         Progress* progress = nullptr);

/// Reports whether encode() would use EncodeOptions::textured for a surface with `triangles` triangles. Textures
/// require an exact mesh.
[[nodiscard]] bool uses_texture(const EncodeRequest& request, std::size_t triangles);

}  // namespace gs::qnv
