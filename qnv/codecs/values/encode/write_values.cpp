#include "qnv/codecs/values/encode/write_values.h"

#include <string>
#include <utility>

namespace gs::qnv {
namespace {

/// Sink that counts the bytes of a stream.
class CountingSink final : public StreamSink {
 public:
  explicit CountingSink(StreamSink& to) : to_(to) {}
  bool write(std::span<const std::byte> bytes) override {
    count_ += bytes.size();
    return to_.write(bytes);
  }
  bool rewrite_front(std::span<const std::byte> bytes) override { return to_.rewrite_front(bytes); }
  [[nodiscard]] std::uint64_t count() const { return count_; }

 private:
  StreamSink& to_;
  std::uint64_t count_ = 0;
};

}  // namespace

Protection values_protection(const EncodeOptions& options) {
  return options.parity ? equal_protection(options) : Protection{Protection::Kind::unequal};
}

std::variant<EncodedStream, EncodeError> write_values(StreamHeader header, const ChunkList& chunks,
                                                      const EncodeOptions& options, std::string_view what) {
  EncodedStream stream;
  MemorySink memory_sink(stream.bytes);
  CountingSink sink(options.sink ? *options.sink : memory_sink);
  auto written = write_stream(std::move(header), chunks, options.max_bytes, sink, values_protection(options));
  if (auto* problem = std::get_if<EncodeError>(&written)) return std::move(*problem);
  stream.header = std::move(std::get<StreamHeader>(written));
  if (options.sink) stream.written = sink.count();
  if (options.max_bytes != 0 && stream.size() > options.max_bytes)
    return EncodeError{"a stream of the coarsest " + std::string(what) + " has " + std::to_string(stream.size()) +
                       " bytes; expected at most " + std::to_string(options.max_bytes)};
  return stream;
}

}  // namespace gs::qnv
