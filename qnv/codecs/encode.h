#pragma once

#include "qnv/codecs/payloads.h"

#include <cstddef>
#include <string>
#include <variant>

namespace gs::qnv {

/// Encoded stream, with its payload and the reason for that.
struct Encoding {
  EncodedStream stream;
  const PayloadRow* payload = nullptr;
  std::string why;  // completes "chosen because"
};

/// Encodes a source with the requested payload, else with the payload that suits it best (PayloadRow::choose). If that
/// payload's encoder finds the source unsuited, tries the next best. Only a displaced stream, and an octree that
/// replaces it, gets an exact mesh. Blocks; safe from any thread.
[[nodiscard]] std::variant<Encoding, EncodeError> encode(const EncodeSource& source, EncodeRequest request,
                                                         Progress* progress = nullptr);

/// Reports whether encode() would use EncodeOptions::textured for a surface of `triangles` triangles. Textures need an
/// exact mesh.
[[nodiscard]] bool uses_texture(const EncodeRequest& request, std::size_t triangles);

}  // namespace gs::qnv
