#pragma once

#include "qnv/codecs/shared/chunk_requests.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace gs::qnv {

/// Stream from which each view decodes what it needs, while it is received. One thread at a time.
class ViewedStream : public ChunkRequests {
 public:
  /// Adds the bytes after those of the begin and of earlier calls. Returns false if further bytes are useless.
  virtual bool push(std::span<const std::byte> bytes) = 0;
  /// Ends the input. Call it after the last push().
  virtual void finish() = 0;
  /// Adds a whole chunk at its offset in the stream, in any order. Returns false if the chunk is rejected.
  virtual bool add(std::uint64_t offset, std::span<const std::byte> chunk) = 0;
};

}  // namespace gs::qnv
