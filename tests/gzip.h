#pragma once

#include <zlib.h>
#include <catch2/catch.hpp>

#include <string>

namespace gs::test {

/// Compresses text or bytes with zlib. `window` 31 means gzip, 15 zlib, -15 deflate without a header.
template <class Data>
Data deflated(const Data& data, int window = 31, int flush = Z_FINISH) {
  z_stream stream{};
  REQUIRE(deflateInit2(&stream, 9, Z_DEFLATED, window, 8, Z_DEFAULT_STRATEGY) == Z_OK);
  Data out(deflateBound(&stream, static_cast<uLong>(data.size())) + 64, typename Data::value_type{});
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<typename Data::value_type*>(data.data()));
  stream.avail_in = static_cast<uInt>(data.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const int status = deflate(&stream, flush);
  REQUIRE(status == (flush == Z_FINISH ? Z_STREAM_END : Z_OK));
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

}  // namespace gs::test
