#include "qnv/reader/decode_stream.h"

#include "qnv/codecs/payloads.h"
#include "qnv/reader/stream_decoder.h"

namespace gs::qnv {
namespace {

template <class Decoder>
DecodedStream read(Decoder& decoder, std::span<const std::byte> stream) {
  (void)decoder.push(stream);
  decoder.finish();
  DecodedStream decoded;
  if (decoder.header()) decoded.header = *decoder.header();
  decoded.problems = decoder.problems();
  decoded.refused_chunks = decoder.refused_chunks();
  return decoded;
}

}  // namespace

DecodedStream decode_stream(std::span<const std::byte> stream, std::size_t most) {
  const PayloadRow* row = payload_of(stream);
  if (row && row->reader == PayloadReader::polygons) {
    OutlineDecoder decoder(most);
    DecodedStream decoded = read(decoder, stream);
    decoded.content = decoder.take();
    return decoded;
  }
  StreamDecoder decoder(most);
  DecodedStream decoded = read(decoder, stream);
  decoded.content = decoder.geometry();
  return decoded;
}

}  // namespace gs::qnv
