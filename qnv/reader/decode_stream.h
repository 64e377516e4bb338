#pragma once

#include "qnv/base/geometry.h"
#include "qnv/codecs/outlines/outline_stream.h"
#include "qnv/container/container.h"

#include <cstddef>
#include <optional>
#include <span>
#include <variant>
#include <vector>

namespace gs::qnv {

/// Content of a complete stream.
struct DecodedStream {
  std::optional<StreamHeader> header;  // nullopt if the bytes are not a stream
  std::variant<Geometry, std::vector<OutlineBatch>> content;
  std::vector<StreamProblem> problems;
  std::size_t refused_chunks = 0;
};

/// Decodes a whole stream of any payload, or a prefix of one. Returns at most `most` vectors or polygons. Safe for
/// untrusted bytes.
[[nodiscard]] DecodedStream decode_stream(std::span<const std::byte> stream, std::size_t most);

}  // namespace gs::qnv
