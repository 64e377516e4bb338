#pragma once

#include "net/files/atomic_file.h"
#include "qnv/codecs/shared/stream_sink.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Output of an encoder to a file. `file` must outlive it.
class FileSink final : public qnv::StreamSink {
 public:
  explicit FileSink(net::AtomicFile& file) : file_(file) {}
  bool write(std::span<const std::byte> bytes) override { return file_.write(bytes); }
  bool rewrite_front(std::span<const std::byte> bytes) override { return file_.rewrite_front(bytes); }

 private:
  net::AtomicFile& file_;
};

}  // namespace gs::app
